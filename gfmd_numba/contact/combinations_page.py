"""The documentation's page of combinations, printed from the tables that refuse them."""

from collections.abc import Iterator

from gfmd_numba.contact.combinations import REFUSALS, Refusal
from gfmd_numba.interface.table import LAWS
from gfmd_numba.solvers.table import ABILITIES, SOLVERS

_INTRODUCTION = """\
# What can be combined

This page tells you which parts of a scene go together. Read it before you write a scene file that combines several
effects, or when `gfmd` has refused one. The command `gfmd schema combinations` prints the page from the tables that
`gfmd` itself reads: `gfmd_numba/contact/combinations.py` and `gfmd_numba/solvers/table.py`.

Every pair that is not listed here works. A scene of three effects works if each two of them do and if one solver can do
all three. `gfmd check FILE` tells you within a second, and names the line and the column of each refused value.
"""
_REASONS = {
    "physics": """\
## Pairs that make no physical sense

No version of `gfmd` will accept these pairs.
""",
    "not built yet": """\
## Pairs that are not built yet

These pairs make sense, but nobody has built them. The error message ends in "(not built yet)".
""",
    "without effect": """\
## Options without effect

The option in the second column would change nothing in such a scene. `gfmd` refuses it, so that you do not take it for
the cause of anything.
""",
}
_SOLVERS = """\
## What each solver can do

`auto` takes the first solver of this table that can do all that a scene asks for. If you name a solver that cannot,
`gfmd` refuses it and names those that can. The options `time_step` and `damping` are refused beside a solver
without them.
"""
PHRASES = {
    "accuracy": "`gfmd accuracy`",
    "anisotropy": "`anisotropy`",
    "campaign": "a campaign",
    "contact without drag": "no friction and no cohesive law",
    "contact without reach": "no exponential and no cohesive law",
    "counter_body": "two elastic bodies (`counter_body`)",
    "dimension 1": "a profile (`dimension: 1`)",
    "dimension 2": "a map (`dimension: 2`)",
    "displacement": "a prescribed displacement of the punch",
    "fields inside": "`gfmd fields`",
    "fit": "`limits`, a `fit` or a `target`",
    "flat punch": "a flat punch",
    "force": "a load `force`",
    "half-space": "a half-space",
    "higher topography_order": "a `topography_order` above 0",
    "layers": "`layers`",
    "layers on a half-space": "`layers` on a half-space",
    "line_load": "a load `line_load`",
    "loaded body": "a body loaded without a punch",
    "measured punch": "a measured punch",
    "model of maps": "a model of two directions (like `length_anisotropy`)",
    "negative displacement": "a negative displacement of the punch",
    "path": "a loading path",
    "plane stress": "plane stress",
    "prescribed": "a body loaded without a punch",
    "prescribed displacement": "a prescribed displacement of the surface",
    "prescribed tractions": "prescribed tractions (`boundary`)",
    "punch": "a punch",
    "rigid mean": "a prescribed displacement of incompressible bodies",
    "rough body": "a rough elastic body",
    "single": "single precision",
    "sliding": "sliding",
    "sliding_y": "sliding along y (`sliding_y`)",
    "smooth bodies": "a rigid punch on a smooth body",
    "sticking": "an infinite coefficient of friction",
    "stiffness_scale": "`stiffness_scale`",
    "topography": "a rough body or two elastic bodies",
    "topography_order": "`topography_order`",
    "hard wall": "a hard wall",
    "hardness": "a hard wall with a `hardness`",
    "normal law": "a law of the gap alone",
    "cohesive law": "a law of gap and slip",
    **{name: law.title for name, law in LAWS.items()},
}


def combinations_page() -> str:
    """Return the page as Markdown."""
    return "\n".join((_INTRODUCTION, *map(_section, _REASONS), _SOLVERS, *_solvers(), ""))


def _section(reason: str) -> str:
    rows = (row for row in REFUSALS if row.because == reason)
    return "\n".join((_REASONS[reason], "| With | refused | allowed |", "|---|---|---|", *map(_row, rows), ""))


def _row(row: Refusal) -> str:
    return f"| {_phrase(row.beside)} | {_phrase(row.refused)} | {row.allowed} |"


def _solvers() -> Iterator[str]:
    """Rows of abilities, columns of solvers."""
    yield "| | " + " | ".join(f"`{name}`" for name in SOLVERS) + " |"
    yield "|---" * (len(SOLVERS) + 1) + "|"
    for ability in ABILITIES:
        marks = ("yes" if ability in solver.can else "" for solver in SOLVERS.values())
        yield f"| {_phrase(ability)} | " + " | ".join(marks) + " |"
    for option in ("time_step", "damping"):
        marks = ("yes" if option in solver.options else "" for solver in SOLVERS.values())
        yield f"| option `{option}` | " + " | ".join(marks) + " |"


def _phrase(feature: str) -> str:
    return PHRASES.get(feature, feature)
