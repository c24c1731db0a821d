"""The documentation's page of combinations, printed from the tables that refuse them."""

from collections.abc import Iterable, Iterator
from textwrap import fill

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

No version of `gfmd` will accept these pairs. Each entry names two things that do not go together, and what is
allowed in place of the first.
""",
    "solver": """\
## Pairs that no solver can do

These pairs make sense, but no solver does both.
""",
    "without effect": """\
## Options without effect

The refused option would change nothing in such a scene. `gfmd` refuses it, so that you do not take it for the cause of
anything.
""",
}
_SOLVERS = """\
## What each solver can do

`auto` takes the first solver of the first line that can do all that a scene asks for. If you name a solver that cannot,
`gfmd` refuses it and names those that can. The options `time_step` and `damping` are refused with a solver without
them.
"""
PHRASES = {
    "accuracy": "`gfmd accuracy`",
    "anisotropy": "`anisotropy`",
    "boundary along y": "a traction or displacement along y (like `tangential_traction_y`)",
    "hardness on inclined surfaces": "a hardness under a rough punch or between two elastic bodies",
    "contact without drag": "no friction and no cohesive law",
    "contact without reach": "no exponential and no cohesive law",
    "dimension 1": "a profile (`dimension: 1`)",
    "dimension 2": "a map (`dimension: 2`)",
    "displacement": "a prescribed displacement of the punch",
    "force": "a load `force`",
    "half-space": "a half-space",
    "higher topography_order": "a `topography_order` above 0",
    "layers on a half-space": "`layers` on a half-space",
    "line_load": "a load `line_load`",
    "loaded by tractions alone": "a body loaded without a punch by tractions alone",
    "measured surface": "a measured surface",
    "model of maps": "a model of two directions (like `length_anisotropy`)",
    "negative displacement": "a negative displacement of the punch",
    "plane stress": "plane stress",
    "prescribed": "a body loaded without a punch",
    "prescribed displacement": "a prescribed displacement of the surface",
    "punch": "a punch",
    "rigid mean": "a prescribed displacement of incompressible bodies",
    "single": "single precision",
    "sliding": "sliding",
    "sliding_y": "sliding along y (`sliding_y`)",
    "smooth bodies": "a rigid punch on a smooth body",
    "sticking": "an infinite coefficient of friction",
    "topography_order": "`topography_order`",
    "tractions of a file": "tractions from a file",
    "hard wall": "a hard wall",
    "hardness": "a hard wall of finite `hardness`",
    "normal law": "a law of the gap alone",
    "cohesive law": "a law of gap and slip",
    **{name: law.title for name, law in LAWS.items()},
}


def combinations_page() -> str:
    """Return the page as Markdown."""
    reasons = [reason for reason in _REASONS if any(row.because == reason for row in REFUSALS)]
    return "\n".join((_INTRODUCTION, *map(_section, reasons), _SOLVERS, *_solvers(), ""))


def _section(reason: str) -> str:
    rows = (row for row in REFUSALS if row.because == reason)
    return "\n".join((_REASONS[reason], *map(_row, rows), ""))


def _row(row: Refusal) -> str:
    allowed = row.allowed.replace("*", r"\*")
    return _item(f"**{_capital(_phrase(row.refused))} with {_phrase(row.present)}.** Allowed: {allowed}.")


def _solvers() -> Iterator[str]:
    """A line for each ability and option, with the solvers that have it."""
    yield _item(f"All solvers: {_named(SOLVERS)}.")
    for ability in ABILITIES:
        can = [name for name, solver in SOLVERS.items() if ability in solver.can]
        yield _item(f"{_capital(_phrase(ability))}: {'all' if len(can) == len(SOLVERS) else _named(can)}.")
    for option in ("time_step", "damping"):
        yield _item(
            f"Option `{option}`: {_named(name for name, solver in SOLVERS.items() if option in solver.options)}."
        )


def _named(solvers: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in solvers)


def _item(text: str) -> str:
    """An entry of a list, wrapped."""
    return fill(text, 120, initial_indent="- ", subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)


def _capital(phrase: str) -> str:
    return phrase[:1].upper() + phrase[1:]


def _phrase(feature: str) -> str:
    return PHRASES.get(feature, feature)
