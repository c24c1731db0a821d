"""The SI prefix that suits numbers with units, chosen here alone for tables, figures and sentences."""

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
_PREFIXED = {"m": "m", "Pa": "Pa", "N": "N"} | dict.fromkeys(("N m-1", "N/m"), "N/m")  # as engineers write them
_PREFIXED |= dict.fromkeys(("J m-2", "J/m^2"), "J/m²")
_OTHERS = {"Pa m-1": (1e-12, "MPa/µm")}
_LEAST = 1e-15  # below which a number of the smallest prefix would be no shorter than one without
_NEARLY = 1.0 - 1e-9  # what rounding leaves just below a prefix has it: 1 GPa, not 1000 MPa


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
