"""What does not go together: one table, which refuses scenes and prints the documentation's page of combinations.

Importing it compiles nothing.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations
from textwrap import fill
from typing import Literal

from gfmd_numba.scene.interface_records import LAWS
from gfmd_numba.solvers.table import ABILITIES, SOLVERS

LEAST_POISSONS_RATIO = 0.05  # of half-spaces without a period under tangential tractions
TALLEST = 1.0  # slab without a period under tangential tractions, over the length of the window
SAMPLED = 1.0  # height up to which the kernel of a body is sampled and not cut, as in elasticity/free_body.py
LOWEST = 0.2  # incompressible slab without a period, over that
SOFTEST = 0.1  # material without a period, over the stiffest above it: softer ones give way far beyond the window
_NO_REFERENCE = "as a half-space has no reference for displacement"
_SLAB = ("a finite aspect_ratio", "slab")  # ways, as in Refusal
_RELAXATION = ("a relaxation of the body", "relaxation")
_DRAG = ("friction", "friction"), ("a cohesive law", "cohesive", "cohesive law"), ("wear", "wear")
_JUNCTIONS_GROW = (
    "as a plastic spot that is also sheared yields at a lower pressure and grows (McFarlane and Tabor, 1950)"
)
_INTRODUCTION = """\
# What can be combined

What can act together in a scene; `gfmd schema combinations` prints it. Every pair that is not listed works. Three
effects work if each two of them do and one solver can do all. `gfmd check FILE` names line and column of each refused
value, and what is allowed in its place. A window is a contact with `periodic: false`, `x` or `y`.
"""
_REASONS = {
    "physics": """\
## Pairs that make no physical sense

No version of `gfmd` will accept these pairs. Entries say what is allowed in place of the last.
""",
    "solver": """\
## Pairs that no solver can do

These pairs make sense, but no solver does both.
""",
    "not built yet": """\
## Pairs that are not built yet

These pairs make sense, and a later version may accept them.
""",
    "without effect": """\
## Options without effect

The refused option would change nothing in such a scene.
""",
}
_SOLVERS = """\
## What each solver can do

`auto` takes the first solver of the first line that can do all that a scene asks for. If you name one that cannot,
`gfmd` names those that can.
"""

Because = Literal["physics", "solver", "not built yet", "without effect"]


@dataclass(frozen=True)
class Refusal:
    """Two features that do not go together: one that is `refused` where the other is `present`.

    `allowed` is what may take the place of the refused one. They are refused `because` of the `solver` where the one of
    the file cannot do both, or none can. Of `ways` to add a feature that makes the pair go, each has its words and its
    names in this table; they stand where the text has `{ways}`.
    """

    present: str
    refused: str
    allowed: str
    because: Because
    ways: tuple[tuple[str, ...], ...] = ()

    def told(self, found: Collection[str] = ()) -> str:
        """Return what is allowed in a scene of the features found, without the ways that these refuse themselves."""
        if not self.ways:
            return self.allowed
        refused = {row.refused for row in REFUSALS if row.present in found}
        refused |= {row.present for row in REFUSALS if row.refused in found}
        *ways, last = ["", *(words for words, *names in self.ways if not refused.intersection(names))]
        if not last:
            return self.allowed.format(ways="")
        if not self.allowed.startswith("nothing"):
            return self.allowed.format(ways=f"{', '.join([*ways[1:], last])}, or ")
        either = ", ".join(ways[1:])
        return self.allowed.format(ways=f" without {either} or {last}" if either else f" without {last}")


_BEYOND_HARD_WALL = tuple(law for law in LAWS if law != "hard_wall")


def _laws_with_each_other() -> Iterator[Refusal]:
    """At most one law of the gap acts; a law of gap and slip acts alone, as it is both; a hard wall goes with all."""
    for first, second in combinations(_BEYOND_HARD_WALL, 2):
        whole = next((law for law in (first, second) if LAWS[law].normal and LAWS[law].tangential), None)
        if whole is not None:
            other = second if whole == first else first
            allowed = f"one law of normal and tangential tractions: {whole} does both itself"
            yield Refusal(whole, other, allowed, "physics")
        elif LAWS[first].ability == LAWS[second].ability:
            yield Refusal(first, second, f"one {LAWS[first].ability} in place of several", "solver")


def _each(present: str, because: Because, told: str, features: Mapping[str, str]) -> Iterator[Refusal]:
    """Refusals of several features by one reason, which stands behind what is allowed in place of each."""
    return (Refusal(present, feature, f"{allowed}{told}", because) for feature, allowed in features.items())


def _not_built(present: str, where: str, features: Mapping[str, str]) -> Iterator[Refusal]:
    return _each(present, "not built yet", f"{where}: this is not built yet", features)


_SMOOTH, _ALONE = "a rigid punch on one smooth body", "a hard_wall alone"
_SOFT, _ONE_LAW = {"hardness": "a hard_wall without hardness"}, {"normal law": _ALONE, "cohesive law": _ALONE}
_NO_ACCURACY, _NEEDS_PUNCH = {"accuracy": "no `gfmd accuracy`"}, {"prescribed": "a contact"}
_AROUND_A_WINDOW = {
    "layers that are rubbed": "a rigid base, or a body of one material, under tangential tractions",
    "tall slab": f"at most {TALLEST:g} times the length, or a half-space, under tangential tractions",
    "incompressible slab": f"a number below 0.5, a half-space, or a height of at least {LOWEST:g} times the length "
    "and no tangential tractions",
    "soft below stiff": f"at least {SOFTEST:g} times the modulus of the stiffest layer above it",
    "higher topography_order": "0, or nothing",
}
_OF_CREEP = {
    **_SOFT,
    **_NO_ACCURACY,
    **_NEEDS_PUNCH,
    "boundary": "no boundary",
    "higher topography_order": "0, or nothing,",
    "unlike bodies": "a counter_body that gives way as the body does (two half-spaces of one material each, or the "
    "same heights, Poisson's ratios and ratios of moduli; neither friction nor a cohesive law)",
}
_OF_FLOW = {
    "rough bodies": _SMOOTH,
    "slab": "a half-space of one material",
    "relaxation": "no relaxation",
    **_ONE_LAW,
    "friction": "no friction",
    "wear": "no wear",
    "no period": "true",
    "boundary": "no boundary",
    **_NEEDS_PUNCH,
    "plane stress": "'plane_strain'",
    "limits": "no limits",
    **_NO_ACCURACY,
}
_OF_PROCESSES = {
    "dimension 1": "dimension 2",
    **_NEEDS_PUNCH,
    "rough bodies": _SMOOTH,
    "no period": "true",
    "surface made as a whole": "a self-affine surface, method psd, with an rms_gradient of each surface",
    "measured surface": "a random surface",
    "form": "no form",
    **_SOFT,
    **_ONE_LAW,
    "friction": "no friction",
    "wear": "no wear",
    "relaxation": "no relaxation",
    "plasticity": "no plasticity",
    "boundary": "no boundary",
    "displacement": "a reduced_pressure, pressure or force",
    "path": "no path",
}
_OF_SPEED = {"wear": "no wear", "rough bodies": _SMOOTH, "friction": "no friction", **_ONE_LAW}
_STEADY = "nothing with a sliding speed, which means steady sliding"
_ONE_THREAD = "1 but for maps under a punch without a hardness, as others are solved by one thread"


def _without_a_period() -> Iterator[Refusal]:
    """What a contact without a period cannot be yet, and what it does not need."""
    told = "without a period only {}: the rest is not built yet"
    not_yet = {feature: told.format(allowed) for feature, allowed in _AROUND_A_WINDOW.items()}
    yield from _each("no period", "not built yet", "", not_yet)
    yield Refusal("prescribed", "no period", "true without a punch: the rest is not built yet", "not built yet")
    told = "true or false with dimension 1; x and y need dimension 2"
    yield Refusal("dimension 1", "period along one axis", told, "physics")
    least = f"at least {LEAST_POISSONS_RATIO:g} under tangential tractions where periodic is false: below it the"
    yield Refusal("no period", "stiff sideways", f"{least} kernel as it is cut here would not be positive", "solver")
    size = "a reference, and limits of eps_c and eps_f alone, without a period: a window has a size, so that another"
    yield Refusal("no period", "thermodynamic limit", f"{size} eps_t is another contact", "physics")
    no_ends = "none where the scene has periodic false; with x or y also window"
    yield Refusal("no period", "treated ends", no_ends, "without effect")


def _in_time() -> Iterator[Refusal]:
    """What bodies that creep and surfaces that wear do not go with yet, and what only they need."""
    yield from _not_built("wear", " with wear", {"rough bodies": _SMOOTH, **_SOFT, **_NO_ACCURACY, **_ONE_LAW})
    yield from _not_built("relaxation", " with a viscoelastic body", _OF_CREEP)
    told = "true with a sliding speed, whose wake may be longer than any window: give steps of a path a sliding and a "
    yield Refusal("speed", "no period", f"{told}duration in place of the speed", "not built yet")
    yield from _not_built("speed", " with a sliding speed", _OF_SPEED)
    for feature, allowed in (("normal law", _ALONE), ("rough bodies", _SMOOTH)):
        told = f"no sliding over a viscoelastic body, or {allowed}"
        yield from _not_built(feature, "", {"sliding over creep": told})
    told = "nothing where the surface ends, but under a form alone: nobody knows what of a roughness would slide in"
    yield Refusal("no period", "roughness over an end", told, "physics")
    steady = dict.fromkeys(("duration", "sliding over creep", "time_tolerance"), _STEADY)
    yield from _each("speed", "without effect", "", steady)
    nothing, rates = "nothing{ways}, as nothing here takes time", "friction that depends on the slip rate"
    yield Refusal("timeless", "duration", nothing, "without effect", (_RELAXATION, (rates, "slip rate")))
    yield Refusal("elastic bodies", "speed", nothing, "without effect", (_RELAXATION,))
    told = "a duration here, too, where friction depends on the slip rate"
    yield Refusal("slip rate", "at once", told, "physics")
    yield from _not_built("slip rate", " where friction depends on the slip rate", _NO_ACCURACY)
    told = "no function in a campaign, whose workers and files do not know it: a limit or slip_rates"
    yield Refusal("campaign", "function", told, "physics")
    told = "a finite coefficient where friction depends on the slip rate, as nodes that stick do not slip"
    yield Refusal("slip rate", "sticking", told, "physics")
    nothing = "nothing{ways}, as nothing here divides steps"
    yield Refusal("undivided steps", "time_tolerance", nothing, "without effect", (_RELAXATION, _DRAG[2]))
    told = "nothing with an infinite coefficient of friction, under which touching nodes stick and do not wear"
    yield Refusal("sticking", "wear", told, "without effect")
    yield Refusal("no sliding", "wear", "nothing where no step of the path is a sliding", "without effect")


def _of_processes() -> Iterator[Refusal]:
    """What several processes and threads do not share yet, or do without, and where a file of nodes has no grid."""
    yield from _each("processes", "not built yet", " with `--mpi`: the rest is not built yet", _OF_PROCESSES)
    yield Refusal("processes", "named solver", "auto with `--mpi`, which has a solver of its own", "without effect")
    yield Refusal("processes", "threads", "1 with `--mpi`: start more processes instead", "without effect")
    told = "no pattern for `gfmd accuracy`, as a file fits one grid alone"
    yield Refusal("accuracy", "pattern", told, "physics")
    yield from _not_built("hardness", "", {"pattern": "no pattern with a hardness"})


_PHYSICS = {  # what is allowed in place of a feature, by the one that it makes no sense with
    "dimension 2": {
        "plane stress": "'plane_strain' with dimension 2, as a contact over x and y is not plane",
        "line_load": "a force with dimension 2",
    },
    "dimension 1": {
        "force": "a line_load with dimension 1, or pressure: the force over its area",
        "anisotropy": "nothing with dimension 1; anisotropy needs dimension 2",
        "sliding_y": "nothing with dimension 1; sliding_y needs dimension 2",
        "radius_y": "nothing with dimension 1; radius_y needs dimension 2",
        "boundary along y": "nothing with dimension 1; this needs dimension 2",
        "model of maps": "another model with dimension 1",
    },
    "hardness": {
        **{law: f"a hard_wall without hardness, {_JUNCTIONS_GROW}" for law in LAWS if LAWS[law].tangential},
        "lennard_jones": "a hard_wall without hardness for lennard_jones, which keeps the surfaces apart",
    },
    "contact without reach": {
        "negative displacement": "a finite number of at least 0, as nothing acts across an open gap"
    },
    "punch": {
        "prescribed displacement": "only tractions with a punch, as the punch prescribes displacements (to make it "
        "stick: friction with coefficient .inf); in a scene without roughness, interface and loading also displacements"
    },
    "accuracy": {
        "tractions of a file": "numbers for `gfmd accuracy`, as a file fits one grid alone",
        "measured surface": "a random surface for `gfmd accuracy`",
    },
    "plasticity": {
        "hardness": "a hard_wall without hardness with plasticity of the body, which bounds the pressure by itself"
    },
    "hardness on inclined surfaces": {
        "higher topography_order": "0, or nothing, with a hardness under a rough punch or between two elastic bodies, "
        "as it does not say which of the two surfaces yields"
    },
    "form between elastic bodies": {
        "higher topography_order": "0, or nothing, with a form between two elastic bodies, as it does not say which of "
        "the two has it"
    },
}
_A_PRESSURE = f"{{ways}}a pressure or another load in place of loading.displacement, {_NO_REFERENCE}"
_OF_A_ROUGHNESS = "{ways}a pressure with a form alone: a reduced_pressure counts in the rms gradient of a roughness"


def _with_ways() -> Iterator[Refusal]:
    """What makes no sense until a feature is added, of which each way is told."""
    window, base = ("periodic false", "no period"), ("base rigid", "slab")
    yield Refusal("displacement", "half-space", _A_PRESSURE, "physics", (_SLAB, window))
    yield Refusal("displacement", "layers on a half-space", _A_PRESSURE, "physics", (("rigid", "slab"), window))
    yield Refusal("contact without drag", "sliding", "nothing{ways}", "physics", _DRAG)
    for feature, way in (("half-space", _SLAB), ("layers on a half-space", base)):
        yield Refusal(feature, "sliding", f"nothing{{ways}}, {_NO_REFERENCE}", "physics", (way,))
    loads = tuple((f"a {load}", load) for load in ("line_load", "force", "displacement"))
    yield Refusal("form alone", "reduced_pressure", _OF_A_ROUGHNESS, "physics", loads)


REFUSALS = (
    *(row for present, features in _PHYSICS.items() for row in _each(present, "physics", "", features)),
    *_laws_with_each_other(),
    *_with_ways(),
    *_without_a_period(),
    *_in_time(),
    *_not_built("plasticity", " with plasticity of the body", _OF_FLOW),
    *(Refusal(each, "threads", _ONE_THREAD, "without effect") for each in ("dimension 1", "prescribed", "hardness")),
    Refusal(
        "campaign",
        "threads",
        "1 in a campaign: `--workers` says how many contacts are solved side by side",
        "without effect",
    ),
    *_of_processes(),
    Refusal(
        "smooth bodies",
        "topography_order",
        "nothing where no deformable body is rough and only one deforms: there is no topography to follow",
        "without effect",
    ),
)
PHRASES = {
    "accuracy": "`gfmd accuracy`",
    "anisotropy": "`anisotropy`",
    "boundary": "prescribed tractions under a punch",
    "boundary along y": "a traction or displacement along y (like `tangential_traction_y`)",
    "hardness on inclined surfaces": "a hardness under a rough punch or between two elastic bodies",
    "campaign": "a campaign",
    "contact without drag": "no friction, no cohesive law and no wear",
    "contact without reach": "no law of the gap and no cohesive law",
    "duration": "the `duration` of a load or a step",
    "form": "a `form`",
    "named solver": "a `solver` by name",
    "path": "a `path`",
    "processes": "`gfmd solve --mpi`",
    "surface made as a whole": "a random surface that is not self-affine (`psd`) with an `rms_gradient` of `each`",
    "at once": "a load or a step without a `duration`",
    "function": "a friction that is a `function`",
    "slip rate": "rate-dependent friction",
    "timeless": "bodies without `relaxation`, and no rate-dependent friction",
    "elastic bodies": "bodies without `relaxation`",
    "no sliding": "a path without `sliding`",
    "roughness over an end": "`sliding` of a rough punch over a viscoelastic body along an axis without a period",
    "sliding over creep": "`sliding` over a viscoelastic body",
    "speed": "a sliding `speed`",
    "relaxation": "`relaxation` of a body",
    "threads": "more than one of the `threads`",
    "undivided steps": "bodies without `relaxation`, and no wear",
    "unlike bodies": "two bodies that give way differently, or that rub",
    "time_tolerance": "`time_tolerance`",
    "wear": "`wear` of the punch",
    "dimension 1": "a profile",
    "dimension 2": "a map",
    "displacement": "a prescribed displacement of the punch",
    "force": "a load `force`",
    "form alone": "a `form` without roughness",
    "form between elastic bodies": "a `form` between two elastic bodies",
    "half-space": "a periodic half-space",
    "higher topography_order": "a `topography_order` above 0",
    "layers on a half-space": "`layers` on a periodic half-space",
    "layers that are rubbed": "tangential tractions on `layers` on a half-space",
    "limits": "`limits` of a campaign",
    "thermodynamic limit": "`eps_t` among the `limits` of a campaign",
    "line_load": "a load `line_load`",
    "measured surface": "a measured surface",
    "model of maps": "a model of two directions (like `length_anisotropy`)",
    "negative displacement": "a negative displacement of the punch",
    "no period": "a window",
    "period along one axis": "`periodic: x` or `y`",
    "plane stress": "plane stress",
    "plasticity": "`plasticity` of a body",
    "slab": "a slab, or layers",
    "pattern": "a `pattern` of the work of adhesion",
    "prescribed": "a body loaded without a punch",
    "prescribed displacement": "a prescribed displacement of the surface",
    "punch": "a punch",
    "radius_y": "a second radius (`radius_y`)",
    "reduced_pressure": "a `reduced_pressure`",
    "rough bodies": "rough deformable bodies",
    "rigid mean": "a prescribed displacement of incompressible bodies",
    "sliding": "sliding",
    "sliding_y": "sliding along y (`sliding_y`)",
    "smooth bodies": "a rigid punch on a smooth body",
    "stiff sideways": "a small or negative `poissons_ratio` under tangential tractions, prescribed or of a law",
    "sticking": "an infinite coefficient of friction",
    "topography_order": "`topography_order`",
    "treated ends": "`periodic: mirror` or `window` of a measured surface",
    "tractions of a file": "tractions from a file",
    "hard wall": "a hard wall",
    "hardness": "a finite `hardness`",
    "normal law": "a law of the gap alone",
    "incompressible slab": f"an incompressible slab lower than {LOWEST:g} times the window, or under such tractions",
    "tall slab": "such tractions on a slab, or layers, higher than the window is wide",
    "soft below stiff": f"a layer or a base with less than {SOFTEST:g} times the modulus of one above it, on a "
    "half-space or higher than the window",
    "cohesive law": "a law of gap and slip",
    **{name: law.title for name, law in LAWS.items()},
}


def combinations_page() -> str:
    """Return the page as Markdown."""
    reasons = [reason for reason in _REASONS if any(row.because == reason for row in REFUSALS)]
    return "\n".join((_INTRODUCTION, *map(_section, reasons), _SOLVERS, *_solvers(), ""))


def has_substitute(row: Refusal) -> bool:
    """Return whether a refusal says what a reader may write instead: not where a later version may accept the pair."""
    return row.because != "not built yet" and not row.allowed.startswith("nothing")


def _section(reason: str) -> str:
    pairs: dict[str, list[tuple[str, str]]] = {}
    for row in REFUSALS:
        if row.because == reason:
            allowed = f" Allowed: {row.told()}.".replace("*", r"\*") if has_substitute(row) else ""
            pairs.setdefault(allowed, []).append((row.present, row.refused))
    entries = (_item(f"{entry}.{allowed}") for allowed, features in pairs.items() for entry in _entries(features))
    return "\n".join((_REASONS[reason], *entries, ""))


def _entries(pairs: list[tuple[str, str]]) -> Iterator[str]:
    """Features that are refused in place of the same: all with each other, or each with those it does not go with."""
    every = dict.fromkeys(feature for pair in pairs for feature in pair)
    if len(every) > 2 and len(pairs) == len(every) * (len(every) - 1) / 2:
        yield f"**{_capital('; '.join(map(_phrase, every)))}** with each other"
        return
    refused: dict[str, list[str]] = {}
    for present, other in pairs:
        refused.setdefault(present, []).append(_phrase(other))
    alike: dict[str, list[str]] = {}
    for present, others in refused.items():
        alike.setdefault("; ".join(others), []).append(_phrase(present))
    for unwanted, features in alike.items():
        yield f"**{_capital('; '.join(features))}** with {unwanted}"


def _solvers() -> Iterator[str]:
    """A line for each ability and option, with the solvers that have it."""
    yield _item(f"All solvers: {_named(SOLVERS)}.")
    for ability in ABILITIES:
        can = [name for name, solver in SOLVERS.items() if ability in solver.can]
        if len(can) < len(SOLVERS):
            yield _item(f"{_capital(_phrase(ability))}: {_named(can)}.")
    yield _item(f"Option `threads`, on maps: {_named(name for name, each in SOLVERS.items() if each.shares_threads)}.")
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
