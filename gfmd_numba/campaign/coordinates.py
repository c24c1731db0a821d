"""What tells one case of a campaign from another: its coordinates in the dataset, and what each of them is."""

import json
from collections.abc import Sequence
from typing import Any

from gfmd_numba.campaign.axes import AXES, present
from gfmd_numba.campaign.cases import Case
from gfmd_numba.contact.dataset import PRESCRIBED, Units, cf_attributes, load_attributes
from gfmd_numba.contact.prescribed_load import SLIDING, reduced_pressure, steps_of
from gfmd_numba.scene import Scene
from gfmd_numba.scene.loading import Step
from gfmd_numba.scene.quantities import REDUCED_PRESSURE

Described = tuple[str | tuple[str, ...], list[Any], dict[str, Any]]  # dims, values, attributes

_REDUCED, _GRADIENT = "reduced_pressure", "rms_gradient_target"
_OTHERS = {
    "case_id": "identity of the dimensionless problem, which equal cases share",
    "limit": "discretisation in which the case differs from its reference",
    "realisations": "realisations that the case was asked of",
    "is_reference": "whether the case is at the reference discretisation",
    "nx": "grid points over the period",
    "dimension": "1: profiles, 2: maps",
}


def coordinates(cases: list[Case]) -> dict[str, list[Any]]:
    """Values by name and case; an axis that they have no value on is left out.

    Where several surfaces are pressed together, g is that of all.
    """
    axes = present(cases[0].scene, cases[0].discretisation)
    reduced = _follows(cases[0].scene)
    columns: dict[str, list[Any]] = {axis.coordinate: [] for axis in axes} | ({_REDUCED: []} if reduced else {})
    summed = {_GRADIENT: [case.rms_gradient for case in cases]} if cases[0].scene.follows_topography else {}
    dimensions = []
    for case in cases:
        scene = case.scene
        for axis in axes:
            columns[axis.coordinate].append(axis.value(scene, case.discretisation))
        if reduced:
            columns[_REDUCED].append(reduced_pressure(scene, case.rms_gradient))
        dimensions.append(scene.dimension)
    return {
        "case_id": [case.problem.identity for case in cases],
        "limit": [case.limit for case in cases],
        "realisations": [case.realisations for case in cases],
        "is_reference": [case.limit == "reference" for case in cases],
        **columns,
        **summed,
        "nx": [case.problem.surface.nx for case in cases],
        "dimension": dimensions,
    }


def _follows(scene: Scene) -> bool:
    """Whether the load p/(g E*) follows from one in Pa or N."""
    return scene.loading.displacement is None and scene.loading.reduced_pressure is None


def steps_of_paths(cases: list[Case], path: Sequence[Step]) -> dict[str, Described]:
    """What each step of a path prescribes, in units of the file: `step_load`, and `step_sliding` if anything drags."""
    if not path:
        return {}
    scene = cases[0].scene
    name, dims = scene.loading.control, ("case", "step")
    steps = [list(steps_of(case.scene, path)) for case in cases]
    attributes = load_attributes(scene)
    loads = [[float(getattr(changed.loading, name)) for changed, _ in each] for each in steps]
    found: dict[str, Described] = {"step_load": (dims, loads, attributes[PRESCRIBED.get(name, name)])}
    if scene.interface.couples:
        for i, way in enumerate(SLIDING[: scene.dimension]):
            slid = [[float(sliding[i]) for _, sliding in each] for each in steps]
            found[f"step_{way}"] = dims, slid, attributes[way]
    return found


def described_coordinates(scene: Scene, cases: list[Case]) -> dict[str, Described]:
    """Coordinates with CF attributes; of an axis also its symbols, its kind and its rank.

    An axis of names has these, and numbers that stand for them: an index whose attribute `names` is a list in JSON.
    """
    unit = Units.of(scene).names
    attributes: dict[str, dict[str, Any]] = {name: cf_attributes(long_name) for name, long_name in _OTHERS.items()}
    for rank, axis in enumerate(AXES):
        attributes[axis.coordinate] = cf_attributes(axis.long_name, unit[axis.unit]) | {
            "symbol": axis.symbol,
            "label": axis.label,
            "axis": "physics" if axis.forms_groups else "discretisation",
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
