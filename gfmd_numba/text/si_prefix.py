"""Numbers with units in the SI prefix that suits them, for tables and figures."""

_PREFIXES = (
    (1e9, "G"),
    (1e6, "M"),
    (1e3, "k"),
    (1.0, ""),
    (1e-3, "m"),
    (1e-6, "µ"),
    (1e-9, "n"),
    (1e-12, "p"),
)
_AREAS = ((1.0, "m²"), (1e-6, "mm²"), (1e-12, "µm²"), (1e-18, "nm²"))
_PREFIXED = {"m": "m", "Pa": "Pa", "N": "N", "N m-1": "N/m"}  # as engineers write them
_OTHERS = {"Pa m-1": (1e-12, "MPa/µm"), "J m-2": (1.0, "J/m²")}


def si_prefix(largest: float, unit: str) -> tuple[float, str]:
    """Return the factor on values of up to `largest` in a unit of the files, and the unit that they then have."""
    if unit == "m2":
        scale, name = next(((s, n) for s, n in _AREAS if largest >= s), _AREAS[-1])
        return 1 / scale, name
    if unit not in _PREFIXED:
        return _OTHERS.get(unit, (1.0, unit))
    scale, letter = next(((s, p) for s, p in _PREFIXES if largest >= s), _PREFIXES[-1] if largest else (1.0, ""))
    return 1 / scale, letter + _PREFIXED[unit]
