"""Every pair of a dimension, law, loading, body, solver and place is either solved or refused by the table."""

from collections import Counter, defaultdict
from functools import cache
from itertools import combinations, product

import pytest

import gfmd_numba
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.campaign.plan import plan
from gfmd_numba.contact.load_path import measured
from gfmd_numba.contact.refusal import check_combination, refusals
from gfmd_numba.scene import InputError, load_scene
from gfmd_numba.scene.records import Numerics, Scene, Step
from gfmd_numba.solvers.table import SOLVERS

pytestmark = pytest.mark.long  # there are some 30,000 choices

PSD = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}
EPS = {"eps_c": 1 / 4, "eps_f": 1 / 4, "eps_t": 1 / 2}  # 64 nodes
WALL, FRICTION = {"hard_wall": {}}, {"friction": {"coefficient": 0.3}}
ATTRACTION = {"exponential": {"work_of_adhesion": 1e-5, "range": 0.02}}
COHESIVE = {"cohesive": {"work_of_adhesion": 1e-4, "normal_length": 0.02, "tangential_length": 0.02}}
FACTORS = {
    "dimension": {"profile": {"dimension": 1}, "map": {"dimension": 2}},
    "law": {
        "hard wall": {"interface": WALL},
        "hardness": {"interface": {"hard_wall": {"hardness": 0.02}}},
        "exponential repulsion": {"interface": {"exponential": {"work_of_adhesion": -1e-4, "range": 0.02}}},
        "exponential attraction": {"interface": WALL | ATTRACTION},
        "squared exponential": {"interface": WALL | {"squared_exponential": {"work_of_adhesion": 1e-5, "range": 0.02}}},
        "lennard-jones": {"interface": {"lennard_jones": {"work_of_adhesion": 1e-6, "range": 0.02}}},
        "cohesive": {"interface": COHESIVE},
        "hard wall and cohesive": {"interface": WALL | COHESIVE},
        "wear": {"interface": WALL | {"wear": {"rate": 1.0}}},
        "friction": {"interface": WALL | FRICTION},
        "sticking": {"interface": WALL | {"friction": {"coefficient": float("inf")}}},
        "friction and exponential": {"interface": WALL | ATTRACTION | FRICTION},
        "friction and cohesive": {"interface": WALL | COHESIVE | FRICTION},
        "exponential and cohesive": {"interface": ATTRACTION | COHESIVE},
    },
    "loading": {
        "pressure": {"loading": {"reduced_pressure": 0.05}},
        "displacement": {"loading": {"displacement": 1e-4}},
        "path of pressures": {"path": [{"reduced_pressure": 0.1}, {"reduced_pressure": 0.05}]},
        "path of displacements": {"loading": {"displacement": 1e-4}, "path": [{"displacement": 2e-4}]},
        "retraction": {"loading": {"displacement": 1e-4}, "path": [{"displacement": -1e-4}]},
        "sliding": {"path": [{"sliding": 1e-5}]},
        "dwell": {"path": [{"duration": 1.0}]},
        "steady sliding": {"loading": {"reduced_pressure": 0.05, "speed": 1e-3}},
        "prescribed tractions": {"boundary": {"normal_traction": 0.0, "tangential_traction": 0.0}},
    },
    "body": {
        "half-space": {"body": {"poissons_ratio": 0.3}},
        "half-space around a window": {"body": {"poissons_ratio": 0.3}, "periodic": False},
        "slab around a window": {"body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5}, "periodic": False},
        "slab": {"body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5}},
        "relaxing half-space": {"body": {"poissons_ratio": 0.3, "relaxation": [{"modulus": 2.0, "time": 1.0}]}},
        "flowing half-space": {"body": {"poissons_ratio": 0.3, "plasticity": {"yield_stress": 1e-3, "increments": 1}}},
        "incompressible half-space": {"body": {"poissons_ratio": 0.5}},
        "incompressible slab": {"body": {"poissons_ratio": 0.5, "aspect_ratio": 0.5}},
        "plane stress": {"body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5, "state": "plane_stress"}},
        "rough body": {"body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5, "roughness": PSD}, "roughness": None},
        "layers": {
            "body": {
                "layers": [
                    {"height": 0.05, "youngs_modulus": 10.0, "poissons_ratio": 0.3},
                    {"height": 0.2, "youngs_modulus": 1.0, "poissons_ratio": 0.45},
                ],
                "base": "rigid",
            }
        },
        "layers on a half-space": {
            "body": {
                "layers": [{"height": 0.05, "youngs_modulus": 1.0, "poissons_ratio": 0.5}],
                "base": {"youngs_modulus": 10.0, "poissons_ratio": 0.3},
            }
        },
        "two bodies": {
            "body": {"youngs_modulus": 1.0, "poissons_ratio": 0.3, "aspect_ratio": 0.5, "roughness": PSD},
            "counter_body": {"youngs_modulus": 2.0, "poissons_ratio": 0.3, "aspect_ratio": 0.5},
            "roughness": None,
        },
    },
    "solver": {name: {"solver": name} for name in ("auto", *SOLVERS)},
    "where": {"one contact": {}, "campaign": {"campaign": True}},
}
FILE_KEYS = ("path", "solver", "campaign")


def file_of(choice):
    """The mapping of a scene or campaign file that a choice of one value for each factor comes to."""
    parts = [FACTORS[factor][value] for factor, value in zip(FACTORS, choice, strict=True)]
    scene = {"roughness": PSD, "loading": {"reduced_pressure": 0.05}}
    file = {"numerics": {"residual": 1e-4}}
    for part in parts:
        scene |= {key: value for key, value in part.items() if key not in FILE_KEYS}
        if "path" in part:
            file["path"] = part["path"]
        if "solver" in part:
            file["numerics"]["solver"] = part["solver"]
    scene = {key: value for key, value in scene.items() if value is not None}
    if any("campaign" in part for part in parts):
        return file | {"name": "pairs", "seed": 1, "realisations": 1, "scene": scene, "reference": EPS}
    eps = EPS | {"eps_c": 1 / 2} if scene["dimension"] == 2 else EPS
    return file | {"scene": scene, "discretisation": eps}


def choices():
    """Every contact, every campaign that names no solver, and every solver in a campaign of a half-space."""
    for choice in product(*FACTORS.values()):
        named = dict(zip(FACTORS, choice, strict=True))
        usual = named["loading"] == "pressure" and named["body"] == "half-space"
        if named["where"] == "one contact" or named["solver"] == "auto" or usual:
            yield choice


def refusal(choice):
    """What is said of a choice, None if nothing is."""
    file = file_of(choice)
    try:
        if "reference" in file:
            load_campaign(file)
        else:
            loaded, document = load_scene(file)
            check_combination(document, loaded.scene, loaded.numerics, loaded.path)
    except InputError as error:
        return str(error)
    return None


@cache
def described(*parts):
    """The records of a choice, whose scene is that of many: solver and place are no part of it."""
    file = file_of((*parts, "auto", "one contact"))
    return Scene.model_validate(file["scene"]), tuple(Step(**step) for step in file.get("path", ()))


def reasons(choice):
    """Why the table refuses a choice."""
    *parts, solver, where = choice
    scene, path = described(*parts)
    numerics = Numerics(residual=1e-4, solver=solver)
    return {row.because for _, row in refusals(scene, numerics, path, {} if where == "campaign" else None)}


def pairs_of(choice):
    return combinations(zip(FACTORS, choice, strict=True), 2)


def covering(choices):
    """A few of the choices that hold every pair that any of them holds."""
    held = {choice: set(pairs_of(choice)) for choice in choices}
    holding = defaultdict(list)
    for choice, pairs in held.items():
        for pair in pairs:
            holding[pair].append(choice)
    left = set(holding)
    for pair in sorted(holding, key=lambda pair: len(holding[pair])):  # what few hold first
        if pair in left:
            best = max(holding[pair][:300], key=lambda choice: len(held[choice] & left))
            left -= held[best]
            yield best


@pytest.mark.filterwarnings("ignore:.*of the energy that the path seems to lose")
@pytest.mark.filterwarnings("ignore:.*the grid has too few nodes")
@pytest.mark.filterwarnings("ignore:.*contacts are")  # a few nodes are enough here
@pytest.mark.filterwarnings("ignore:.*the contact reaches the edge")
@pytest.mark.filterwarnings("ignore:.*pressures or residual displacements")
@pytest.mark.filterwarnings("ignore:.*the surfaces come as close as")
@pytest.mark.filterwarnings("ignore:.*what has flowed is at most")
def test_every_choice_is_refused_by_the_table_or_allowed_and_every_allowed_pair_solved():
    """One test, as most of its time goes into sorting out what is allowed.

    The table is asked about every choice, but for solvers of what physics refuses: that does not depend on them. Every
    nineteenth choice is loaded from a file, too: at least one of those with the same law, loading and body, and other
    solvers from one of these to the next.
    """
    because = {}
    for choice in choices():
        *parts, _, where = choice
        of_physics = because.get((*parts, "auto", where), ())
        because[choice] = of_physics if "physics" in of_physics else reasons(choice)
    for choice in [*because][::19]:
        said = refusal(choice)
        assert (said is not None) == bool(because[choice]), choice
        for line in said.splitlines() if said else ():
            assert line.startswith(("scene.", "numerics.", "path")), line
            assert "; gfmd allows " in line or "; gfmd needs " in line
    allowed = [choice for choice, reason in because.items() if not reason]
    kinds = defaultdict(set)
    for choice, reason in because.items():
        kind = "physics" if "physics" in reason else "solver" if reason else "solved"
        for pair in pairs_of(choice):
            kinds[pair].add(kind)
    counted = Counter(next(kind for kind in ("solved", "solver", "physics") if kind in each) for each in kinds.values())
    assert counted == {"solved": 721, "solver": 120, "physics": 92}  # of 933; change with the tables
    failed = [(choice, status) for choice in covering(allowed) if (status := solved(choice)) != "ok"]
    assert not failed, failed


def solved(choice):
    """How a choice ends; of a campaign, its only block."""
    file = file_of(choice)
    if "reference" in file:
        (block,) = plan(file).blocks
        status = measured(block.problem, range(block.first, block.stop))["status"]
    else:
        status = gfmd_numba.solve(file)["status"].values
    return "ok" if (status == 0).all() else str(status.tolist())
