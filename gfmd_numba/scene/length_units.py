"""Units of length that a file of a surface may be in: the only place where they are named."""

from unicodedata import normalize

METRES = {
    "m": 1.0,
    "km": 1e3,
    "dm": 1e-1,
    "cm": 1e-2,
    "mm": 1e-3,
    "um": 1e-6,
    "nm": 1e-9,
    "pm": 1e-12,
    "angstrom": 1e-10,
    "in": 0.0254,
    "mil": 0.0254e-3,
}
PERIOD = "L_x"  # the unit of lengths that count in periods of the result
ALLOWED = "a unit of length: " + ", ".join([*METRES, f"or {PERIOD}"])
_SPELLINGS = {
    "\u03bcm": "um",  # Greek mu, which the micro sign is normalised to
    "micron": "um",
    "microns": "um",
    "\u00c5": "angstrom",  # A with ring, which the sign of the unit is normalised to
    "angstroms": "angstrom",
    "inch": "in",
    "inches": "in",
    "mils": "mil",
}
_PREFIXES = {"": "", "kilo": "k", "deci": "d", "centi": "c", "milli": "m", "micro": "u", "nano": "n", "pico": "p"}
_SPELLINGS |= {
    f"{prefix}{metre}": f"{letter}m"
    for prefix, letter in _PREFIXES.items()
    for metre in ("meter", "meters", "metre", "metres")
}


def length_unit(text: str) -> str | None:
    """Return the name of a unit of length, a key of `METRES` or `PERIOD`, however it is spelt; None if it is none."""
    text = normalize("NFKC", text).strip()
    name = _SPELLINGS.get(text) or _SPELLINGS.get(text.lower(), text)
    return name if name in METRES or name == PERIOD else None
