"""Numbers as text, chosen here alone for tables, figures and sentences: with an SI prefix, with a standard error."""

from collections.abc import Iterable, Sequence
from math import floor, isfinite, isnan, log10
from statistics import median

_PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"), (1e-12, "p"))
_AREAS = ((1.0, "m²"), (1e-6, "mm²"), (1e-12, "µm²"), (1e-18, "nm²"))
_PREFIXED = {"m": "m", "Pa": "Pa", "N": "N"} | dict.fromkeys(("N m-1", "N/m"), "N/m")  # as engineers write them
_PREFIXED |= {"ohm": "ohm", "ohm m2": "ohm m²", "K W-1": "K/W", "K m2 W-1": "K m²/W", "Pa s": "Pa s"}
_PREFIXED |= dict.fromkeys(("J m-2", "J/m^2"), "J/m²") | {"m s-1": "m/s"}
_OTHERS = {"Pa m-1": (1e-12, "MPa/µm")}
_LEAST = 1e-15  # below which a number of the smallest prefix would be no shorter than one without
_NEARLY = 1.0 - 1e-9  # what rounding leaves just below a prefix has it: 1 GPa, not 1000 MPa
_ROUNDING = 1e-12  # of the largest number: what is smaller stands for 0
_FAR = 100.0
_MOST_RANGES = 3  # of steps that a sentence names one by one
_FIXED = (1e-4, 1e5)  # sizes that are written without a power of ten
_MOST_DIGITS = 7  # of a value, however small its error


def si_prefix(largest: float, unit: str) -> tuple[float, str]:
    """Return the factor on values of up to `largest` in a unit of files or records, and the unit they then have."""
    if unit == "m2":
        scale, name = next(((s, n) for s, n in _AREAS if largest >= s), _AREAS[-1])
        return 1 / scale, name
    if unit not in _PREFIXED:
        return _OTHERS.get(unit, (1.0, unit))
    smallest = _PREFIXES[-1] if largest > _LEAST else (1.0, "")
    scale, letter = next(((s, p) for s, p in _PREFIXES if largest >= s * _NEARLY), smallest)
    return 1 / scale, letter + _PREFIXED[unit]


def with_prefix(value: float, unit: str, digits: int = 4) -> str:
    """Return a value to so many digits, with the prefix of its unit that suits it."""
    factor, name = si_prefix(abs(value), unit) if isfinite(value) else (1.0, unit)
    return f"{factor * value:.{digits}g} {name}".rstrip()


def typical(values: Iterable[float]) -> float:
    """Return the size that tables and pictures choose the prefix of many numbers by.

    It is the largest if all others are within a hundredth of it. Else it is their median, as 1 to 1000 MPa read better
    than 0.001 to 1 GPa, but no less than this hundredth: few small numbers make no large one long.
    """
    known = [abs(value) for value in values if isfinite(value)]
    sizes = [size for size in known if size > _ROUNDING * max(known)]
    if not sizes:
        return 0.0
    least, most = min(sizes), max(sizes)
    return most if most <= _FAR * least else max(median(sizes), most / _FAR)


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
    if power and float(shown[0]) == 0.0:
        return f"0±{error * scale:.1e}"  # a power of ten common to both would be that of the error alone
    both = "±".join(shown)
    return f"({both})e{power:+03d}" if power else both


def counted(number: int, thing: str) -> str:
    """Return a number of things, of which there may be one."""
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


def steps_told(affected: Sequence[bool], last: int) -> str:
    """Name the steps of a path that have something, of those up to the last one; nothing where all or none are."""
    steps = [i for i, has_it in enumerate(affected) if has_it]
    if len(steps) in (0, len(affected)):
        return ""
    ends = [i for i in steps if i - 1 not in steps], [i for i in steps if i + 1 not in steps]
    if len(ends[0]) > _MOST_RANGES:
        return f"{len(steps)} of the steps {steps[0]} to {steps[-1]} of {last}"
    ranges = [f"{first}" if first == end else f"{first} to {end}" for first, end in zip(*ends, strict=True)]
    return f"step{'s' * (len(steps) > 1)} {', '.join(ranges)} of {last}"
