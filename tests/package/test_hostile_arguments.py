"""Every public function, given anything for each of its arguments: a result or a reason."""

import inspect
import warnings
from functools import partial

import pytest

import gfmd_numba
from gfmd_numba import analysis
from gfmd_numba.scene import InputError
from support.forked_trial import tried_in_a_fork  # noqa: F401
from support.hostile import calls, deadline
from support.things import EXPONENTS, MANY, SCENE, SECONDS, SURFACE, TINY, Things, fuzzed

CREEP = SCENE | {"body": SCENE["body"] | {"relaxation": [{"modulus": 70e9, "time": 1.0}]}}
FUNCTIONS = {
    "gfmd_numba.solve": lambda things: {"scene": SCENE, "heights": None},
    "gfmd_numba.load_curve": lambda things: {
        "scene": CREEP,
        "loads": None,
        "realisations": 1,
        "heights": None,
        "times": [0.1, 1.0],
        "speeds": None,
    },
    "gfmd_numba.body_fields": lambda things: {
        "contact": things.contact(),
        "z": [-1e-5, 0.0],
        "body": "body",
        "x": None,
        "y": None,
        "planes": None,
    },
    "gfmd_numba.make_surface": lambda things: {"surface": SURFACE},
    "gfmd_numba.run": lambda things: {
        "campaign": TINY,
        "output": things.folder / "run" / "out",
        "workers": 0,
        "until": None,
        "budget": None,
    },
    "gfmd_numba.rounds": lambda things: {
        "campaign": TINY | {"limits": {"eps_f": [1 / 8, 1 / 16]}, "fit": {"fixed": {"eps_f": [0.5, 1.0]}}},
        "output": things.folder / "rounds" / "out",
        "workers": 0,
        "until": {"kappa": 0.1},
        "budget": None,
    },
    "gfmd_numba.open_campaign": lambda things: {"path": things.file("results.nc", things.results())},
    "gfmd_numba.fit_tfc": lambda things: {
        "dataset": things.results(),
        "variable": "kappa",
        "exponents": "shared",
        "fixed": EXPONENTS,
        "omit_nyquist": True,
        "step": None,
    },
    "gfmd_numba.contact_statistics": lambda things: {"dataset": things.contact()},
    "gfmd_numba.gap_percolation": lambda things: {"dataset": things.map()},
    "gfmd_numba.leakage": lambda things: {
        "dataset": things.map(),
        "viscosity": "1 mPa s",
        "pressure": 2e5,
        "seal": ["1 mm", 0.3],
    },
    "gfmd_numba.contact_conductance": lambda things: {"contact": things.map(), "conductivity": "60 MS/m"},
    "gfmd_numba.analysis.secant_stiffness": lambda things: {"dataset": things.results()},
    "gfmd_numba.analysis.ensemble_mean": lambda things: {"cases": things.results(), "variable": "kappa"},
    "gfmd_numba.analysis.plot_accuracy": lambda things: {"dataset": things.accuracy(), "width": "single"},
    "gfmd_numba.analysis.plot_body": lambda things: {
        "dataset": gfmd_numba.body_fields(things.contact(), [-1e-5, 0.0]),
        "width": "single",
    },
    "gfmd_numba.analysis.plot_campaign": lambda things: {
        "dataset": things.results(),
        "fit": things.fit(),
        "variable": "kappa",
        "width": "double",
    },
    "gfmd_numba.analysis.plot_contact": lambda things: {"dataset": things.contact(), "width": "single"},
    "gfmd_numba.analysis.plot_curve": lambda things: {"dataset": things.curve(), "width": "single"},
    "gfmd_numba.analysis.plot_fit": lambda things: {"fit": things.fit(), "width": "double"},
    "gfmd_numba.analysis.plot_leakage": lambda things: {"dataset": analysis.leakage(things.map()), "width": "single"},
    "gfmd_numba.analysis.plot_conductance": lambda things: {
        "dataset": gfmd_numba.contact_conductance(things.map()),
        "width": "single",
    },
    "gfmd_numba.analysis.plot_rounds": lambda things: {"dataset": things.rounds(), "width": "single"},
    "gfmd_numba.analysis.plot_statistics": lambda things: {
        "statistics": gfmd_numba.contact_statistics(things.contact()),
        "width": "single",
    },
    "gfmd_numba.analysis.plot_surface": lambda things: {"dataset": gfmd_numba.make_surface(SURFACE), "width": "single"},
    "gfmd_numba.analysis.select_limit": lambda things: {"dataset": things.results(), "limit": "eps_c"},
    "gfmd_numba.analysis.smooth_function": lambda things: {"fit": things.fit_of_loads()},
}


AGAIN = {  # the same functions, seen from another room
    f"gfmd_numba.analysis.{name}": FUNCTIONS[f"gfmd_numba.{name}"]
    for name in sorted(set(analysis.__all__) & set(gfmd_numba.__all__))
} | {"gfmd_numba.analysis.leakage": lambda things: {"dataset": things.map()}}  # without a fluid


@pytest.fixture(scope="module")
def things(tmp_path_factory):
    return Things(tmp_path_factory.mktemp("things"))


def public_functions():
    rooms = (gfmd_numba, analysis)
    return {
        f"{room.__name__}.{name}": getattr(room, name)
        for room in rooms
        for name in room.__all__
        if inspect.isroutine(getattr(room, name))
    }


@pytest.mark.long
def test_every_public_function_and_each_of_its_arguments_has_a_good_call(things):
    public = public_functions()
    calls_of = FUNCTIONS | AGAIN
    assert public.keys() == calls_of.keys()
    for name, function in public.items():
        arguments = calls_of[name](things)
        assert arguments.keys() == inspect.signature(function).parameters.keys(), name
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            function(**arguments)


def result_or_reason(function, arguments):
    """The result of a function, None if it raises InputError; any other error or no end in time is a failure."""
    with warnings.catch_warnings(), deadline(SECONDS):
        warnings.simplefilter("ignore")  # numbers like 1e308 may overflow
        try:
            return function(**arguments)
        except InputError as error:
            said = str(error)
    assert said
    return None


@pytest.mark.parametrize(
    ("hardness", "loads", "said"),
    [
        (1e8, [0.05, 100.0], r"loads\[1\]: you gave 100.0; gfmd allows below .*hardness"),
        (1e6, ["0.5 MPa", "5 MPa"], r"loads\[1\]: .*hardness"),
        (None, [1e-30, 1e30], r"loads\[0\]: you gave 1e-30; gfmd allows a reduced pressure from 1e-30"),
    ],
)
def test_each_load_of_a_curve_and_the_step_to_it_are_checked(hardness, loads, said):
    wall = {} if hardness is None else {"hardness": hardness}
    with pytest.raises(InputError, match=said):
        gfmd_numba.load_curve(SCENE | {"interface": {"hard_wall": wall}}, loads)


@pytest.mark.long
@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_given_anything_returns_or_says_why(things, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    function = public_functions()[name]
    fuzzed(calls(FUNCTIONS[name](things)), partial(result_or_reason, function), MANY, derandomize=True)
