"""The coordinates of cases in the dataset, their attributes, and the cases that meet conditions on them."""

import json
from collections.abc import Mapping, Sequence
from math import inf, isclose
from typing import Any

from pydantic_core import PydanticCustomError

from gfmd_numba.campaign.axes import AXES, Grid, present
from gfmd_numba.campaign.cases import Case
from gfmd_numba.contact.contact_dataset import Units, cf_attributes, load_attributes
from gfmd_numba.contact.observables import PRESCRIBED
from gfmd_numba.contact.reduced_loads import SLIDING, steps_of, times_of
from gfmd_numba.scene import InputError, Scene
from gfmd_numba.scene.document import nearest, plain_scalar
from gfmd_numba.scene.loading import Step
from gfmd_numba.scene.quantities import REDUCED_PRESSURE
from gfmd_numba.scene.surfaces import SelfAffine
from gfmd_numba.scene.units import WithUnit, quantities
from gfmd_numba.text.numbers import si_prefix

Described = tuple[str | tuple[str, ...], list[Any], dict[str, Any]]  # dims, values, attributes
_REDUCED, _GRADIENT = "reduced_pressure", "rms_gradient_target"
_OTHERS = {
    "case_id": "identity of the dimensionless problem, which equal cases share",
    "limit": "discretisation in which the case differs from its reference",
    "realisations": "realisations that the case was asked of",
    "is_reference": "whether the case is at the reference discretisation",
    "nx": "grid points over the period",
    "dimension": "1: profiles, 2: maps",
    "thinnest_layer": "height of the body or of its thinnest layer over the period",
    "has_measured_slope_law": "whether the law of the unseen slope was measured for contacts of this kind",
}
_ROUNDING = 5e-6  # relative, of a number that was read off a table
_MOST_VALUES = 10


def coordinates(cases: list[Case]) -> dict[str, list[Any]]:
    """Return the values by name and case, without axes on which the cases have no value.

    Where several surfaces are pressed together, the rms gradient is that of their sum.
    """
    axes = present(cases[0].scene, cases[0].discretisation)
    loading = cases[0].scene.loading
    reduced = loading.displacement is None and loading.reduced_pressure is None  # p/(g E*) follows from Pa or N
    columns: dict[str, list[Any]] = {axis.coordinate: [] for axis in axes} | ({_REDUCED: []} if reduced else {})
    summed = {_GRADIENT: [case.rms_gradient for case in cases]} if cases[0].scene.follows_topography else {}
    thinnest = [case.scene.thinnest_layer for case in cases]
    dimensions, measured = [], []
    for case in cases:
        scene = case.scene
        for axis in axes:
            columns[axis.coordinate].append(axis.value(scene, case.discretisation))
        if reduced:
            columns[_REDUCED].append(case.problem.load)
        dimensions.append(scene.dimension)
        measured.append(has_measured_slope_law(scene))
    return {
        "case_id": [case.problem.identity for case in cases],
        "limit": [case.limit for case in cases],
        "realisations": [case.realisations for case in cases],
        "is_reference": [case.limit == "reference" for case in cases],
        **columns,
        **summed,
        "nx": [case.problem.surface.nx for case in cases],
        "dimension": dimensions,
        **({"thinnest_layer": thinnest} if min(thinnest) < inf else {}),
        "has_measured_slope_law": measured,
    }


def has_measured_slope_law(scene: Scene) -> bool:
    """Return whether a contact is of the kind on which the constants of the law of the unseen slope were measured.

    That is a hard wall alone under a rigid profile that is self-affine up to a plateau, with a period, on elastic
    bodies.
    """
    surface = scene.roughness
    self_affine = isinstance(surface, SelfAffine) and surface.plateau and scene.dimension == 1
    alone = len(scene.surfaces) == 1 and scene.form is None and scene.boundary is None
    hard = set(scene.interface.laws) == {"hard_wall"} and scene.interface.hardness is None
    remembers = scene.creeps or scene.interface.wear is not None
    return self_affine and alone and hard and scene.periodic is True and not remembers


def described_coordinates(scene: Scene, cases: list[Case]) -> dict[str, Described]:
    """Return the coordinates with CF attributes; those of an axis also have its symbols, its kind and its rank.

    An axis of names also has an index of numbers, whose attribute `names` is a JSON list of the names.
    """
    unit = Units.of(scene).names
    attributes: dict[str, dict[str, Any]] = {name: cf_attributes(long_name) for name, long_name in _OTHERS.items()}
    for rank, axis in enumerate(AXES):
        attributes[axis.coordinate] = cf_attributes(axis.long_name, unit[axis.unit]) | {
            "symbol": axis.symbol,
            "label": axis.label,
            "axis": "physics" if axis.record else "discretisation",
            "rank": rank,
        }
    if cases[0].scene.loading.reduced_pressure is None:  # it follows from another load, and is no axis
        attributes[_REDUCED] = cf_attributes(REDUCED_PRESSURE)
    columns = coordinates(cases)
    described: dict[str, Described] = {name: ("case", column, attributes[name]) for name, column in columns.items()}
    for axis in (axis for axis in AXES if axis.has_names and axis.coordinate in columns):
        known = list(dict.fromkeys(columns[axis.coordinate]))
        numbers = {name: i for i, name in enumerate(known)}
        counted = attributes[axis.coordinate] | {
            "long_name": f"{axis.long_name}, counted in the order of the campaign",
            "names": json.dumps(known, ensure_ascii=False),
        }
        described[f"{axis.coordinate}_index"] = "case", [numbers[name] for name in columns[axis.coordinate]], counted
        described[axis.coordinate] = "case", columns[axis.coordinate], cf_attributes(axis.long_name)
    return described


def steps_of_paths(cases: list[Case], path: Sequence[Step]) -> dict[str, Described]:
    """Return what each step of a path prescribes, in file units: `step_load`, `step_sliding` and `step_time`."""
    if not path:
        return {}
    scene = cases[0].scene
    name, dims = scene.loading.control, ("case", "step")
    steps = [list(steps_of(case.scene, path)) for case in cases]
    attributes = load_attributes(scene)
    loads = [[float(getattr(changed.loading, name)) for changed, _ in each] for each in steps]
    found: dict[str, Described] = {"step_load": (dims, loads, attributes[PRESCRIBED.get(name, name)])}
    if scene.creeps:
        found["step_time"] = dims, [times_of(changed for changed, _ in each) for each in steps], attributes["time"]
    if scene.interface.couples or scene.interface.wear is not None:
        for i, way in enumerate(SLIDING[: scene.dimension]):
            slid = [[float(sliding[i]) for _, sliding in each] for each in steps]
            found[f"step_{way}"] = dims, slid, attributes[way]
    return found


def meeting(cases: list[Case], conditions: Mapping[str, str]) -> list[Case]:
    """Return the cases that meet all conditions, name -> value; raises InputError.

    A name is a key of the grid or a coordinate of the results. A number may have a unit where the scene has units.
    """
    columns = coordinates(cases)
    keys = {axis.name: axis for axis in AXES if axis.coordinate in columns}
    chosen = list(range(len(cases)))
    for name, given in conditions.items():
        column = columns.get(keys[name].coordinate if name in keys else name)
        if column is None:
            named = {axis.coordinate: key for key, axis in keys.items()}
            names = [named.get(coordinate, coordinate) for coordinate in columns]
            hint = nearest(name, names)
            raise InputError.of("--only", name, f"{', '.join(names)}{f'; {hint}' if hint else ''}")
        axis = next((axis for axis in keys.values() if name in (axis.name, axis.coordinate)), None)
        unit = "1" if axis is None else Units.of(cases[0].scene).names[axis.unit]
        value = given if isinstance(column[0], str) else _number(name, given, axis.name if axis else "", unit)
        found = {i for i, held in enumerate(column) if held == value}
        if not found and isinstance(value, float):
            found = {i for i, held in enumerate(column) if isclose(held, value, rel_tol=_ROUNDING)}
        if not found:
            known, (factor, symbol) = list(dict.fromkeys(column))[:_MOST_VALUES], (1.0, "")
            if unit != "1":
                factor, symbol = si_prefix(max(map(abs, known)), unit)
            numbers = (f"{factor * each:.6g}" if isinstance(each, float) else str(each) for each in known)
            there = ", ".join(f"{number} {symbol}".strip() for number in numbers)
            raise InputError.of("--only", f"{name}={given}", f"a value of the campaign, like {there}")
        chosen = [i for i in chosen if i in found]
    if not chosen:
        given = " ".join(f"--only {name}={value}" for name, value in conditions.items())
        allowed = "conditions that at least one case meets"
        raise InputError.of("--only", f"{given}, and no case meets all of these", allowed)
    return [cases[i] for i in chosen]


def _number(name: str, given: str, key: str, unit: str) -> Any:
    """Return the number in a text, in the unit of the results; if there is none, the value or the text itself."""
    quantity = quantities(Grid).get(key)
    value: Any = plain_scalar(given.strip())
    try:
        value = value if quantity is None else quantity.read(value)
    except PydanticCustomError as error:
        said = {"allowed": "", "suggestion": "", **(error.context or {})}
        hint = f"; {said['suggestion']}" if said["suggestion"] else ""
        raise InputError.of("--only", f"{name}={given}", f"{said['allowed']}{hint}") from None
    if isinstance(value, WithUnit) and unit == "1":
        raise InputError.of("--only", f"{name}={given}", "a number without a unit, as the scene has none")
    try:
        return value if isinstance(value, bool) or value is None else float(value)
    except ValueError:
        return value
