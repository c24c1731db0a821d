"""What tells one case of a campaign from another: its coordinates in the dataset, and what each of them is."""

from typing import Any

from gfmd_numba.campaign.axes import AXES, present
from gfmd_numba.campaign.cases import Case
from gfmd_numba.contact.dataset import cf_attributes, units
from gfmd_numba.scene import Scene

Described = tuple[str, list[Any], dict[str, Any]]  # dim, values, attributes

_OTHERS = {
    "case_id": "identity of the dimensionless problem, which equal cases share",
    "limit": "discretisation in which the case differs from its reference",
    "realisations": "realisations that the case was asked of",
    "is_reference": "whether the case is at the reference discretisation",
    "nx": "grid points over the period",
    "dimension": "1: profiles, 2: maps",
}


def coordinates(cases: list[Case]) -> dict[str, list[Any]]:
    """Values by name and case; an axis that they have no value on is left out."""
    columns: dict[str, list[Any]] = {
        "case_id": [case.problem.identity for case in cases],
        "limit": [case.limit for case in cases],
        "realisations": [case.realisations for case in cases],
        "is_reference": [case.limit == "reference" for case in cases],
    }
    for axis in present(cases[0].scene, cases[0].discretisation):
        columns[axis.coordinate] = [axis.value(case.scene, case.discretisation) for case in cases]
    return columns | {
        "nx": [case.problem.surface.nx for case in cases],
        "dimension": [case.scene.dimension for case in cases],
    }


def described_coordinates(scene: Scene, cases: list[Case]) -> dict[str, Described]:
    """Coordinates with CF attributes; of an axis also its symbols, its kind and its rank."""
    unit = units(scene)
    attributes: dict[str, dict[str, Any]] = {name: cf_attributes(long_name) for name, long_name in _OTHERS.items()}
    for rank, axis in enumerate(AXES):
        attributes[axis.coordinate] = cf_attributes(axis.long_name, unit[axis.unit]) | {
            "symbol": axis.symbol,
            "label": axis.label,
            "axis": "physics" if axis.forms_groups else "discretisation",
            "rank": rank,
        }
    return {name: ("case", column, attributes[name]) for name, column in coordinates(cases).items()}
