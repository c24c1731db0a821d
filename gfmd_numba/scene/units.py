"""The kinds of quantities that a file gives, numbers with units of them, and records in reduced units.

A number without a unit is in SI units, or in L_x and E* where a scene has no length or no moduli. A file whose numbers
have no units does not import the library of units.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from difflib import get_close_matches
from functools import lru_cache
from typing import Any, TypeVar, get_args
from unicodedata import normalize

from pydantic import BaseModel, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import PydanticCustomError, core_schema

_DIGITS = r"[-+]?(?:\d+\.?\d*|\.\d+)"
_FORTRAN = re.compile(rf"\s*({_DIGITS})[dD]([-+]?\d+)(?!\d)")
_GROUPED = re.compile(r"\s*([-+]?\d{1,3}(?:([,'_ \u00a0\u202f])\d{3})(?:\2\d{3})*(?:\.\d*)?)(?![\d,'_])")
_DECIMAL_COMMA = re.compile(r"\s*([-+]?\d*),(\d+)(?!\d|,)")
_FACTOR = r"[^\W\d_]+(?:(?:\^|\*\*)?-?[1-9]|⁻?[¹²³])?"
_UNIT = rf"{_FACTOR}(?:(?:\s*[*/·]\s*|\s+){_FACTOR}){{0,4}}"
_NUMBER = r"[-+]?(?:[0-9]+/[0-9]+|(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?)"
_NO_NUMBER = r"[-+]?\.?(?:inf|nan)(?![^\W\d_])"
NUMBER_WITH_UNIT = rf"^\s*{_NUMBER}\s*[^\s\d].*$"
_SPLIT = re.compile(rf"\s*({_NUMBER}|{_NO_NUMBER})\s*([^\s\d.].*?)\s*", re.IGNORECASE)
_LONGEST = 100  # of a text that is looked at
_OVER_NM = re.compile(r"/\s*N\s*[*·]?\s*m\b$")  # as wear rates are mostly written
_OVER_BOTH = re.compile(r"/\s*\(\s*([^\W\d_]+)\s*[*·\s]\s*([^\W\d_]+)\s*\)")
_SAID = {  # of what is written in place of a unit of the quantity that has this SI unit
    ("Pa", r"H[VBK]W?[\s\d./]*"): "HV, HB and HK are in kgf/mm^2: write that unit",
    ("Pa", r"HR.*"): "a Rockwell hardness is no pressure: look up the HV that it is worth",
    ("Pa", r"Msi"): "1 Msi is 1000 ksi",
    ("Pa", r"tsi"): "a ton is 2240 lbf, or in America 2000 lbf: write psi",
    ("Pa s", r"c?St|[mc]?m(?:\^?2|²)/s"): (
        "a kinematic viscosity: write it times the density, as 46 cSt of oil are about 40 mPa s"
    ),
}
_FORCES = {"kg": "kgf", "kp": "kgf", "lb": "lbf", "lbs": "lbf", "t": "tf"}  # that are written as masses
_MASS = re.compile(rf"\b(?:{'|'.join(_FORCES)})\b")
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
    "uin": 0.0254e-6,
}
PERIOD = "L_x"  # the unit of lengths that count in periods of the result
COUNTS = ("points", "point", "pixels", "pixel", "px")  # in place of a unit, of positions that are numbers of points
LENGTHS_ALLOWED = "a unit of length: " + ", ".join([*METRES, f"or {PERIOD}, or a number of one, as 0.5 nm"])
_OF_A_UNIT = re.compile(rf"\s*({_DIGITS}(?:[eE][-+]?\d+)?)\s*([^\d\s].*)")
_PREFIXES = {"": "", "kilo": "k", "deci": "d", "centi": "c", "milli": "m", "micro": "u", "nano": "n", "pico": "p"}


def respelt(text: str) -> str:
    """How to write the number that a text begins with; nothing if it is written like that, or is no number."""
    if found := _FORTRAN.match(text):
        return f"exponents have an e: {found[1]}e{found[2]}"
    if found := _GROUPED.match(text):
        whole = re.sub("[^-+0-9.]", "", found[1])
        both = re.fullmatch(r"[-+]?\d+,\d{3}", found[1])
        other = f", or {found[1].replace(',', '.')} with a decimal point" if both else ""
        return f"thousands have no separator: {whole}{other}"
    if found := _DECIMAL_COMMA.match(text):
        return f"decimals have a point: {found[1] or 0}.{found[2]}"
    return ""


@dataclass(frozen=True)
class Quantity:
    """A kind of quantity: its name, units to name for it, the SI unit first, and what it is counted in without units.

    That is L_x to the power `length` times E* to the power `modulus` and a time to the power `time`. As an annotation
    of a float it lets the field take text like `0.2 mm`, which becomes a number in SI units.
    """

    name: str
    units: tuple[str, ...]
    length: int = 0
    modulus: int = 0
    time: int = 0

    @property
    def si(self) -> str:
        """Its SI unit."""
        return self.units[0]

    @property
    def allowed(self) -> str:
        """What a number with a unit of it may look like, in words."""
        return f"{'an' if self.name[0] in 'aeiou' else 'a'} {self.name} in {', '.join(self.units)} or the like"

    def scale(self, length: float, modulus: float, time: float = 1.0) -> float:
        """What it is counted in where the period is `length` and the contact modulus `modulus`."""
        return length**self.length * modulus**self.modulus * time**self.time

    def si_value(self, text: str) -> float | None:
        """Value in SI units of a text like `0.2 mm`, None if it is no number with a unit; nan if it is not finite.

        The conversion is in decimals: the result is the very float that the number in SI units is read as. Raises
        PydanticCustomError for an unknown unit, and for a unit of another quantity.
        """
        parts = _SPLIT.fullmatch(text) if len(text) <= _LONGEST else None
        if parts is None:
            return None
        if hint := respelt(text):
            raise self._fault(hint)
        number, unit = parts.groups()
        factor = self._in_si(unit)
        if number[-1].isalpha():  # inf, nan
            return float("nan")
        above, _, below = number.partition("/")
        try:
            return float(Decimal(above) / Decimal(below or 1) * factor)
        except ArithmeticError:  # a fraction over 0, a power beyond decimals
            return float("nan")

    def _in_si(self, unit: str) -> Decimal:
        if self.si == "m" and (name := length_unit(unit)) in METRES:  # pint has no mil
            return Decimal(repr(METRES[name]))
        registry, unit = _registry(), _OVER_NM.sub("/N/m", _OVER_BOTH.sub(r"/\1/\2", unit))
        try:
            if _dimensions(unit) != _dimensions(self.si):
                raise self._fault(_meant(self, unit))
            found: Decimal = registry.Quantity(Decimal(1), registry.parse_units(_spelt(unit))).to(self.si).magnitude
            return found
        except (AttributeError, TypeError, ValueError, ArithmeticError) as error:  # those of pint are among them
            if isinstance(error, PydanticCustomError):
                raise
            raise self._fault(_meant(self, unit)) from None

    def _fault(self, suggestion: str) -> PydanticCustomError:
        return PydanticCustomError("unit", "gfmd allows {allowed}", {"allowed": self.allowed, "suggestion": suggestion})

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        return core_schema.no_info_wrap_validator_function(self._validated, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        both = {"type": ["number", "string"], "pattern": NUMBER_WITH_UNIT}
        return {**handler(schema), **both, "quantity": self.name, "unit": self.si, "in_units": self.allowed}

    def read(self, given: Any) -> Any:
        """Number in SI units of a text with a unit; whatever else is given as it is."""
        value = self.si_value(given) if isinstance(given, str) else None
        parts = None if value is None else _SPLIT.fullmatch(given)
        return given if value is None or parts is None else WithUnit(value, self, parts[2])

    def in_unit(self, value: float, unit: str) -> float:
        """Value in a unit of a value in SI units."""
        return value / float(self._in_si(unit))

    def _validated(self, given: Any, check: core_schema.ValidatorFunctionWrapHandler) -> Any:
        value = self.read(given)
        return WithUnit(check(float(value)), self, value.unit) if isinstance(value, WithUnit) else check(value)


class WithUnit(float):
    """A number in SI units that was given with a unit of a quantity; in all else a float."""

    quantity: Quantity
    unit: str

    def __new__(cls, value: float, quantity: Quantity, unit: str) -> "WithUnit":
        """Number in SI units, the quantity it is of, and the unit it was given in."""
        number = super().__new__(cls, value)
        number.quantity, number.unit = quantity, unit
        return number

    def __reduce__(self) -> tuple[type["WithUnit"], tuple[float, Quantity, str]]:
        return WithUnit, (float(self), self.quantity, self.unit)


def in_unit_of(given: float, value: float, unit: str = "") -> str:
    """Return a value in words: in the unit that a number was given in, like `0.223 um`, or with the SI unit, if any."""
    if isinstance(given, WithUnit):
        return f"{given.quantity.in_unit(value, given.unit):.6g} {given.unit}"
    return f"{value:.6g} {unit}".rstrip()


LENGTH = Quantity("length", ("m", "mm", "um", "nm"), length=1)
PRESSURE = Quantity("pressure", ("Pa", "kPa", "MPa", "GPa"), modulus=1)
ENERGY_PER_AREA = Quantity("energy per area", ("J/m^2", "mJ/m^2"), length=1, modulus=1)
FORCE_PER_LENGTH = Quantity("force per length", ("N/m", "kN/m", "N/mm"), length=1, modulus=1)
FORCE = Quantity("force", ("N", "mN", "kN"), length=2, modulus=1)
TIME = Quantity("time", ("s", "min", "h"), time=1)
SPEED = Quantity("speed", ("m/s", "mm/s", "km/h"), length=1, time=-1)
WEAR_RATE = Quantity("wear rate", ("m^2/N", "mm^2/N", "mm^3/N/m"), modulus=-1)
MEMORY = Quantity("memory", ("B", "MB", "GB"))
VISCOSITY = Quantity("dynamic viscosity", ("Pa s", "mPa s", "cP"))
ELECTRICAL_CONDUCTIVITY = Quantity("electrical conductivity", ("S/m", "MS/m", "S/cm"))
THERMAL_CONDUCTIVITY = Quantity("thermal conductivity", ("W/m/K", "W/(m K)", "kW/m/K"))
QUANTITIES = (
    *(LENGTH, PRESSURE, ENERGY_PER_AREA, FORCE_PER_LENGTH, FORCE, TIME, SPEED, WEAR_RATE, MEMORY),
    *(VISCOSITY, ELECTRICAL_CONDUCTIVITY, THERMAL_CONDUCTIVITY),
)

Keys = tuple[str | int, ...]  # that lead to a place in a record


def numbers_in(
    record: Any, at: Keys = (), quantity: Quantity | None = None
) -> Iterator[tuple[Keys, float, Quantity | None]]:
    """Numbers of a record, their places in it, and the quantities that its fields say they are."""
    if isinstance(record, float):
        yield at, record, quantity
    elif isinstance(record, BaseModel):
        of_fields = quantities(type(record))
        for name, value in record:
            yield from numbers_in(value, (*at, name), of_fields.get(name))
    elif isinstance(record, tuple):
        for i, value in enumerate(record):
            yield from numbers_in(value, (*at, i))


def given_with_units(record: Any, at: Keys = ()) -> Iterator[tuple[Keys, WithUnit]]:
    """Numbers of a record that were given with units, and their places in it."""
    return ((place, value) for place, value, _ in numbers_in(record, at) if isinstance(value, WithUnit))


@lru_cache
def _meant(quantity: Quantity, unit: str) -> str:
    """Question whether a unit of the quantity was meant that is written alike, or what else to write."""
    for (of, pattern), said in _SAID.items():
        if quantity.si == of and re.fullmatch(pattern, unit):
            return said
    as_force = _MASS.sub(lambda mass: _FORCES[mass[0]], unit)
    near = [name for name in quantity.units if _bare(name) == _bare(unit)]
    if as_force != unit and _dimensions(as_force) == _dimensions(quantity.si):
        near = [as_force]
    elif not near and _dimensions(unit) is None and unit[0].isalpha():
        names = get_close_matches(unit, filter(str.isalpha, _registry()), 3, 0.8)
        near = get_close_matches(unit, quantity.units, 1, 0.5)
        near += [name for name in names if _dimensions(name) == _dimensions(quantity.si)]
    return f"did you mean {near[0]!r}?" if near else ""


def _bare(unit: str) -> str:
    return unit.replace(" ", "").casefold()


def _spelt(unit: str) -> str:
    """Unit with its powers as the library of units has them, of J m-2 as CF writes it, and of m2."""
    return re.sub(r"(?<=[^\W\d_])(-?[1-9])", r"^\1", unit)


def _dimensions(unit: str) -> Any:
    """Dimensions of a unit, None if it is none."""
    try:
        return _registry().parse_units(_spelt(unit)).dimensionality if re.fullmatch(_UNIT, unit) else None
    except (AttributeError, TypeError, ValueError, ArithmeticError):  # those of pint are among them
        return None


def has_unit(text: str) -> bool:
    """Whether a text is a number with something behind it."""
    return len(text) <= _LONGEST and _SPLIT.fullmatch(text) is not None


@lru_cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(non_int_type=Decimal)


Record = TypeVar("Record", bound=BaseModel)


def rounded(value: float) -> float:
    """Number to 12 significant digits.

    A division by L_x or E* leaves errors in the last of some 16 digits. The identity of a problem is a hash of exact
    numbers: rounded, a problem is the same in engineering units and in reduced ones.
    """
    return float(f"{value:.11e}")


@lru_cache(maxsize=4096)
def in_reduced_units(record: Record, length: float, modulus: float, time: float = 1.0) -> Record:
    """Record, and those inside it, with all quantities in units of a length, a stress and a time, to 12 digits."""
    of_fields = quantities(type(record))

    def reduced(value: Any, quantity: Quantity | None) -> Any:
        if isinstance(value, BaseModel):
            return in_reduced_units(value, length, modulus, time)
        if isinstance(value, tuple):
            return tuple(reduced(each, quantity) for each in value)
        return value if value is None or quantity is None else rounded(value / quantity.scale(length, modulus, time))

    return record.model_copy(update={name: reduced(value, of_fields.get(name)) for name, value in record})


@lru_cache
def quantities(record: type[BaseModel]) -> dict[str, Quantity]:
    """Fields of a record that are quantities, and which."""
    found = {name: _quantity_of((field.annotation, *field.metadata)) for name, field in record.model_fields.items()}
    return {name: quantity for name, quantity in found.items() if quantity is not None}


def _quantity_of(parts: Any) -> Quantity | None:
    for part in parts:
        found = part if isinstance(part, Quantity) else _quantity_of(get_args(part))
        if found is not None:
            return found
    return None


_SPELLINGS = {
    "\u03bcm": "um",  # Greek mu, which the micro sign is normalised to
    "micron": "um",
    "microns": "um",
    "\u00c5": "angstrom",  # A with ring, which the sign of the unit is normalised to
    "angstroms": "angstrom",
    "inch": "in",
    "inches": "in",
    "mils": "mil",
    "\u03bcin": "uin",
    "microinch": "uin",
    "microinches": "uin",
}
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


def file_unit(text: str) -> str | None:
    """Return a unit of numbers in a file, as `um` or `0.5 nm`, however it is spelt; None if it is none."""
    found = _OF_A_UNIT.fullmatch(text)
    if found is None:
        return length_unit(text)
    name, number = length_unit(found[2]), float(found[1])
    return f"{number!r} {name}" if name in METRES and 0.0 < number < float("inf") else None


def metres(unit: str) -> float:
    """Return how many metres a unit is that `file_unit` returns; 1 for `PERIOD`."""
    *number, name = unit.split()
    return METRES.get(name, 1.0) * float(number[0] if number else 1.0)
