"""What does not go together: one table, which refuses scenes and prints the documentation's page of combinations.

Pure data and records: importing it compiles nothing.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Literal

from gfmd_numba.interface.table import LAWS


@dataclass(frozen=True)
class Refusal:
    """Two features that do not go together: one that is `refused` where the other is `present`.

    `allowed` is what may take the place of the refused one. They are refused `because` of the `solver` where the one of
    the file cannot do both, or none can.
    """

    present: str
    refused: str
    allowed: str
    because: Literal["physics", "solver", "without effect"]


_NO_REFERENCE = "as a half-space has no reference for displacement"
_JUNCTIONS_GROW = (
    "as a plastic spot that is also sheared yields at a lower pressure and grows (McFarlane and Tabor, 1950): bounding "
    "the pressure alone would let it bear both"
)
_BEYOND_HARD_WALL = tuple(law for law in LAWS if law != "hard_wall")


def _laws_with_each_other() -> Iterator[Refusal]:
    """At most one law of the gap acts; a law of gap and slip acts alone, as it is both; a hard wall goes with all."""
    for first, second in combinations(_BEYOND_HARD_WALL, 2):
        whole = next((law for law in (first, second) if LAWS[law].normal and LAWS[law].tangential), None)
        if whole is not None:
            other = second if whole == first else first
            allowed = f"one law of normal and tangential tractions, not {other} with {whole}, which does both itself"
            yield Refusal(whole, other, allowed, "physics")
        elif LAWS[first].ability == LAWS[second].ability:
            yield Refusal(first, second, f"one {LAWS[first].ability}, not {second} with {first}", "solver")


REFUSALS = (
    Refusal(
        "dimension 2",
        "plane stress",
        "'plane_strain' with dimension 2: E* is the same, and a contact over x and y is not plane",
        "physics",
    ),
    Refusal("dimension 1", "force", "a line_load with dimension 1; a force needs dimension 2", "physics"),
    Refusal("dimension 2", "line_load", "a force with dimension 2; a line_load needs dimension 1", "physics"),
    Refusal("dimension 1", "anisotropy", "nothing with dimension 1; anisotropy needs dimension 2", "physics"),
    Refusal("dimension 1", "sliding_y", "nothing with dimension 1; sliding_y needs dimension 2", "physics"),
    Refusal("dimension 1", "boundary along y", "nothing with dimension 1; this needs dimension 2", "physics"),
    Refusal("dimension 1", "model of maps", "another model with dimension 1; this one has two directions", "physics"),
    *_laws_with_each_other(),
    *(
        Refusal("hardness", law, f"a hard_wall without hardness for {law}, {_JUNCTIONS_GROW}", "physics")
        for law in LAWS
        if LAWS[law].tangential
    ),
    Refusal(
        "displacement",
        "half-space",
        f"a finite aspect_ratio, or loading.reduced_pressure in place of loading.displacement, {_NO_REFERENCE}",
        "physics",
    ),
    Refusal(
        "displacement",
        "layers on a half-space",
        f"rigid, or loading.reduced_pressure in place of loading.displacement, {_NO_REFERENCE}",
        "physics",
    ),
    Refusal(
        "contact without reach",
        "negative displacement",
        "a finite number of at least 0, as nothing acts across an open gap",
        "physics",
    ),
    Refusal("contact without drag", "sliding", "nothing without friction or a cohesive law", "physics"),
    Refusal("half-space", "sliding", f"nothing without a finite aspect_ratio, {_NO_REFERENCE}", "physics"),
    Refusal("layers on a half-space", "sliding", f"nothing without base rigid, {_NO_REFERENCE}", "physics"),
    Refusal(
        "punch",
        "prescribed displacement",
        "only tractions with a punch, as the punch prescribes displacements (to make it stick: friction with "
        "coefficient .inf); in a scene without roughness, interface and loading also displacements",
        "physics",
    ),
    Refusal(
        "accuracy",
        "tractions of a file",
        "numbers for `gfmd accuracy`, as a file gives the tractions at its own nodes and nobody knows them between "
        "these, where a finer grid has nodes",
        "physics",
    ),
    Refusal("accuracy", "measured surface", "a random surface for `gfmd accuracy`", "physics"),
    Refusal(
        "loaded by tractions alone",
        "single",
        "nothing where tractions alone are prescribed on a body without a punch: one transform, in double precision, "
        "tells what they do",
        "without effect",
    ),
    Refusal(
        "smooth bodies",
        "topography_order",
        "nothing where no deformable body is rough and only one deforms: there is no topography to follow",
        "without effect",
    ),
    Refusal(
        "hardness on inclined surfaces",
        "higher topography_order",
        "0, or nothing, with a hardness under a rough punch or between two elastic bodies: which of the two surfaces "
        "yields decides the slope along which a plastic spot presses, and a hardness does not say which",
        "physics",
    ),
)
