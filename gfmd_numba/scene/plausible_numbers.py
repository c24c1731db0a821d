"""Numbers of a scene that are implausible for what they are: as a rule a unit was left out, or mistaken."""

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from gfmd_numba.scene import Boundary, Scene
from gfmd_numba.scene.document import Location, dotted
from gfmd_numba.scene.loading import Step
from gfmd_numba.scene.surface_file import SurfaceFile
from gfmd_numba.scene.units import Quantity, WithUnit, numbers_in, quantities
from gfmd_numba.text.numbers import with_prefix

LOADS = {"pressure": ("MPa", "kPa", "GPa"), "line_load": ("N/mm", "kN/m"), "force": ("kN",)}
_LIGHTEST = 1e-7  # E*: less presses so little into contact that no grid resolves it
_WITH_UNIT = 1e5  # times further off, as a unit was written
_ROUNDING = 1e-9  # of the largest of a path: less is a 0 that was computed
_LIKELY_LOADS = (1e-6, 0.3)  # E*


class Common(NamedTuple):
    """Values of a quantity that are common, in SI units, what others are, and the likely units of others."""

    low: float
    high: float
    below: str
    above: str
    units: tuple[str, ...]


class Compared(NamedTuple):
    """What numbers of a file are compared with: its period and a Young's modulus, if it has them, and E* (or 1)."""

    length: float | None
    youngs_modulus: float | None
    modulus: float

    def in_si(self, quantity: Quantity) -> bool:
        """Whether numbers of a quantity are in SI units, not in L_x or E*."""
        return bool((self.length or not quantity.length) and (self.youngs_modulus or not quantity.modulus))


_OF_WAVES = Common(1e-10, 0.1, "shorter than an atom", "longer than 10 cm", ("um", "mm", "nm"))
_OF_LAWS = Common(1e-10, 1e-5, "shorter than an atom", "longer than forces between surfaces reach", ("nm", "um"))
_OF_FORMS = Common(1e-9, 1.0, "sharper than any tip", "more than 1 m", ("mm", "um", "nm"))
_OF_PUNCHES = Common(1e-13, 1e-2, "less than a thousandth of an atom", "more than 1 cm", ("um", "nm"))
_OF_YIELD = Common(1e5, 1e11, "softer than wax", "harder than diamond", ("GPa", "MPa"))
Given = tuple[Location, float, Quantity]
_OF_BODIES = Common(1e5, 2e12, "softer than rubber", "stiffer than diamond", ("GPa", "MPa", "kPa"))
_OF_TIMES = Common(1e-12, 1e10, "shorter than atoms vibrate", "longer than a century", ("min", "h"))
COMMON = {
    "youngs_modulus": _OF_BODIES,
    "modulus": _OF_BODIES._replace(low=1.0, below="softer than any gel"),
    **dict.fromkeys(("time", "duration"), _OF_TIMES),
    **dict.fromkeys(
        ("speed", "reference_velocity", "slip_rates"),
        Common(1e-10, 300.0, "slower than continents drift", "faster than any tyre", ("mm/s", "km/h")),
    ),
    "rate": Common(1e-20, 1e-9, "less than any material wears", "more than chalk wears", ("mm^2/N", "mm^3/N/m")),
    "limit": Common(1e3, 1e11, "less than any solid bears", "more than diamond bears", ("MPa", "GPa")),
    "hardness": Common(1e6, 2e11, "softer than wax", "harder than diamond", ("GPa", "MPa")),
    **dict.fromkeys(("yield_stress", "saturation_stress"), _OF_YIELD),
    "hardening": _OF_YIELD._replace(high=2e12, above="stiffer than diamond"),
    "depth": Common(1e-10, 0.1, "thinner than an atom", "thicker than 10 cm", ("um", "mm", "nm")),
    "work_of_adhesion": Common(1e-4, 10.0, "weaker than van der Waals forces", "stronger than a glue", ("mJ/m^2",)),
    "range": _OF_LAWS,
    "normal_length": _OF_LAWS,
    "tangential_length": _OF_LAWS,
    "length": Common(1e-8, 0.1, "shorter than 10 nm", "longer than 10 cm", ("um", "mm", "nm")),
    "height": Common(1e-10, 0.1, "thinner than an atom", "thicker than 10 cm", ("um", "mm", "nm")),
    "rms_height": Common(1e-11, 1e-3, "less than a tenth of an atom", "more than 1 mm", ("um", "nm")),
    **dict.fromkeys(("cut_on", "roll_off", "cutoff", "spacing", "correlation_length"), _OF_WAVES),
    **dict.fromkeys(("correlation_length_x", "correlation_length_y", "mound_separation"), _OF_WAVES),
    **dict.fromkeys(("radius", "radius_y", "width", "edge_radius"), _OF_FORMS),
    **dict.fromkeys(("displacement", "sliding", "sliding_y"), _OF_PUNCHES),
}
_OF_BOUNDARIES = quantities(Boundary)
_UP_TO_MODULUS = {*LOADS, "hardness", "yield_stress", *(key for key, each in _OF_BOUNDARIES.items() if each.modulus)}
_WITHIN_PERIOD = {"range", "normal_length", "tangential_length", "rms_height", "displacement"}
_WITHIN_PERIOD |= {key for key, each in _OF_BOUNDARIES.items() if each.length}


def implausible(file: Scene | SurfaceFile, path: Sequence[Step] = ()) -> list[str]:
    """Sentences about numbers of a scene and its path, or of a surface, that are implausible for what they are.

    Without a length, or with a length of 1, numbers without units are in units of their own: they only have to fit
    together.
    """
    steps, largest = [*_numbers(path, ("path",))], dict[str, float]()
    for place, value, _ in steps:
        largest[str(place[-1])] = max(abs(value), largest.get(str(place[-1]), 0.0))
    given = [*_numbers(file), *(step for step in steps if abs(step[1]) > _ROUNDING * largest[str(step[0][-1])])]
    scales = _scales(file)
    bare = not any(isinstance(value, WithUnit) for _, value, _ in given)
    of_its_own = bare and file.length in (None, 1.0)
    uncommon = {} if of_its_own else dict(_uncommon(scales, given))
    sentences = []
    if uncommon:
        free = "; to calculate in units of L_x and E*, leave out length and youngs_modulus" if bare else ""
        stated = all(isinstance(value, WithUnit) for place, value, _ in given if place in uncommon)
        remedy = f"A number without a unit is in SI units: write the unit you mean{free}"
        sentences.append(f"{'; '.join(uncommon.values())}. {'Check the unit' if stated else remedy}")
    if any(place[-1] == "youngs_modulus" for place in uncommon):
        return sentences  # whatever is compared with it is in doubt already
    others = [(place, value, quantity) for place, value, quantity in given if place not in uncommon]
    loads = dict(_against_modulus(scales, others, of_its_own))
    lengths = dict(_against_period(scales, others))
    return [*sentences, *loads.values(), *lengths.values()]


def mistaken(scene: Scene) -> tuple[Location, str] | None:
    """Place and implausible value of the first number, but a load, whose unit may have been left out; None if none."""
    bare = [each for each in _numbers(scene) if not isinstance(each[1], WithUnit)]
    found = _uncommon(_scales(scene), bare)
    return next(((place, told) for place, told in found if place[0] != "loading"), None)


def _scales(file: Scene | SurfaceFile) -> Compared:
    if isinstance(file, SurfaceFile):
        return Compared(file.length, None, 1.0)
    # as `Scales` has it but for plane stress: checking a file loads no numpy
    softness = sum(
        (1.0 - body.surface_poissons_ratio**2) / (body.surface_modulus or 1.0) for body in file.deformable.values()
    )
    return Compared(file.length, file.body.surface_modulus if file.has_moduli else None, 1.0 / softness)


def _numbers(record: object, at: Location = ()) -> Iterator[Given]:
    """Numbers of a record that are quantities, and their places in it."""
    return ((place, value, quantity) for place, value, quantity in numbers_in(record, at) if quantity is not None)


def _uncommon(scales: Compared, given: Iterable[Given]) -> Iterator[tuple[Location, str]]:
    """Places of numbers without a unit that are not common in SI units, and what they are."""
    for place, value, quantity in given:
        name = next(part for part in reversed(place) if isinstance(part, str))  # also of a number in a list
        common, size, room = COMMON.get(name), abs(value), _WITH_UNIT if isinstance(value, WithUnit) else 1.0
        if common is None or not scales.in_si(quantity) or size == 0.0:
            continue
        if not common.low / room <= size <= common.high * room:
            what = common.below if size < common.low else common.above
            meant = _meant(value, quantity, common.units, common.low, common.high)
            yield place, f"{_told(place, value, quantity, scales)}, {what}{meant}"


def _against_modulus(scales: Compared, given: Iterable[Given], of_its_own: bool) -> Iterator[tuple[str, str]]:
    """Names of loads, tractions and hardnesses far from what the contact modulus bears, and a sentence about each."""
    whole = f" (E* = {with_prefix(scales.modulus, 'Pa')})" if scales.youngs_modulus else ""
    for place, value, quantity in given:
        name, one = str(place[-1]), quantity.scale(scales.length or 1.0, scales.modulus)
        if name not in _UP_TO_MODULUS or (
            of_its_own and name in ("hardness", "yield_stress")
        ):  # a large one may stand for none
            continue
        ratio, least = abs(value) / one, _LIGHTEST / (_WITH_UNIT if isinstance(value, WithUnit) else 1.0)
        if ratio > 1.0:
            wrong = f"{ratio:.3g} E*{whole}: check the units of both"
        elif name in LOADS and 0.0 < ratio < least and not of_its_own:
            meant = _meant(value, quantity, LOADS[name], *(limit * one for limit in _LIKELY_LOADS))
            wrong = f"{ratio:.2g} E*{whole}{meant}: write the unit you mean"
        else:
            continue
        yield name, f"{_told(place, value, quantity, scales)}, which makes {wrong}"


def _against_period(scales: Compared, given: Iterable[Given]) -> Iterator[tuple[str, str]]:
    """Names of lengths beyond the period that should be far below it, and a sentence about each."""
    for place, value, quantity in given:
        name, periods = str(place[-1]), abs(value) / (scales.length or 1.0)
        if name in _WITHIN_PERIOD and periods > 1.0:
            yield name, f"{_told(place, value, quantity, scales)}, {periods:.3g} periods L_x: check the units of both"


def _told(place: Location, value: float, quantity: Quantity, scales: Compared) -> str:
    """Say what a number is: in SI units, if it has any."""
    if not scales.in_si(quantity):
        return f"{dotted(place)} is {value:.6g}"
    said = with_prefix(value, quantity.si) if isinstance(value, WithUnit) else f"{value:.4g} {quantity.si}"
    return f"{dotted(place)} is {said}"


def _meant(value: float, quantity: Quantity, units: Iterable[str], low: float, high: float) -> str:
    """Return the question which unit is meant: one or two with which the number lies between two others."""
    value = quantity.in_unit(value, value.unit) if isinstance(value, WithUnit) else value
    sizes = {unit: abs(value) * (quantity.si_value(f"1 {unit}") or 0.0) for unit in units}
    likely = [f"{value:.4g} {unit}" for unit, size in sizes.items() if low <= size <= high]
    return f" ({' or '.join(likely[:2])}?)" if likely else ""
