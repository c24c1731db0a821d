"""Numbers with their standard errors, written here alone for tables and sentences."""

from math import floor, isfinite, isnan, log10

_FIXED = (1e-4, 1e5)  # sizes that are written without a power of ten
_MOST_DIGITS = 7  # of a value, however small its error


def with_error(value: float, error: float, digits: int = 4) -> str:
    """Return a value and its error, both to the second digit of the error: 2.41±0.11, 9300±1400, (1.24±0.05)e+06.

    A value of unknown error (nan) has this many `digits`; a value of nan is a dash.
    """
    if isnan(value):
        return "-"
    if not isfinite(value) or not isfinite(error) or error < 1e-300:
        number = f"{float(f'{value:.{digits}g}'):g}"  # 120 of two digits, not 1.2e+02
        return number + ("" if isnan(error) or not isfinite(value) else f"±{error:.2g}")
    largest = max(abs(value), error)
    power = 0 if _FIXED[0] <= largest < _FIXED[1] else floor(log10(largest))
    scale = float(f"1e{power}")
    value, error, largest = value / scale, error / scale, largest / scale
    last = max(floor(log10(float(f"{error:.1e}"))) - 1, floor(log10(largest)) + 1 - _MOST_DIGITS)
    places = max(0, -last)
    shown = [f"{round(each, -last):.{places}f}" for each in (value, error)]
    if float(shown[1]) == 0.0:
        shown[1] = f"{error:.1e}"
    both = "±".join(shown)
    return f"({both})e{power:+03d}" if power else both
