"""Every command, given anything for each of its arguments and options: an end of its own or a reason."""

import re
from unittest.mock import Mock

import click
import pytest
from click.testing import CliRunner
from hypothesis import strategies as st

from gfmd_numba.campaign.work_precision import Study
from gfmd_numba.cli import main
from support.forked_trial import tried_in_a_fork  # noqa: F401
from support.hostile import altered, calls, deadline
from support.things import MANY, SCENE, SECONDS, SURFACE, TINY, Things, fuzzed


@pytest.fixture(scope="module")
def things(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Study, "solvers", lambda study: iter(()))  # the longest study
        patch.setattr(Study, "axes", ("eps_c",))  # one of three alike
        yield Things(tmp_path_factory.mktemp("things"))


COMMANDS = {
    "accuracy": lambda things: {
        "file": things.file("tiny.yaml", TINY),
        "output": things.new("a.nc"),
        "realisations": "2",
    },
    "check": lambda things: {"file": things.file("scene.yaml", SCENE)},
    "collect": lambda things: {"directory": things.finished()},
    "conductance": lambda things: {
        "file": things.file("map.nc", things.map()),
        "output": things.new("c.nc"),
        "as_json": False,
        "conductivity": ["60 MS/m"],
    },
    "curve": lambda things: {
        "file": things.file("scene.yaml", SCENE),
        "loads": "0.1:0.2:2",
        "realisations": "1",
        "threads": "1",
        "times": None,
        "speeds": None,
        "output": things.new("l.nc"),
    },
    "doctor": lambda things: {},
    "fields": lambda things: {
        "file": things.file("map.nc", things.map()),
        "output": things.new("f.nc"),
        "body": "body",
        "x": None,
        "y": "50um",
        "plane": [],
    },
    "fit": lambda things: {
        "results": things.file("results.nc", things.results()),
        "variable": "kappa",
        "exponents": "shared",
        "fixed": ["eps_c=1", "eps_f=0.5:1"],
        "output": things.new("fit.nc"),
        "function": None,
    },
    "init": lambda things: {"file": things.new("new.yaml")},
    "leakage": lambda things: {
        "file": things.file("map.nc", things.map()),
        "output": things.new("k.nc"),
        "as_json": False,
        "viscosity": "1 mPa s",
        "pressure": "2 bar",
        "seal": None,
    },
    "plan": lambda things: {
        "file": things.file("tiny.yaml", TINY),
        "workers": "1",
        "pilot": "0",
        "target": None,
        "budget": None,
    },
    "plot": lambda things: {
        "results": things.file("results.nc", things.results()),
        "variable": "kappa",
        "exponents": "shared",
        "fixed": ["eps_c=1", "eps_f=0.5:1"],
        "output": things.new("p.png"),
        "width": "single",
    },
    "relaxation": lambda things: {
        "file": things.file("dma.csv", "1,3e6,1e5\n10,4e6,8e5\n100,6e6,4e5\n"),
        "unit": "Pa",
        "poissons_ratio": "0.5",
    },
    "report": lambda things: {
        "results": things.file("results.nc", things.results()),
        "output": things.new("r.html"),
        "watch": False,
    },
    "run": lambda things: {
        "file": things.file("tiny.yaml", TINY),
        "output": things.new("run"),
        "workers": "0",
        "scheduler": None,
        "insecure": False,
        "cluster": None,
        "only": ["hurst=0.8"],
        "limit": "1",
        "retry_failed": False,
        "fail_fast": False,
        "until": None,
        "budget": None,
    },
    "schema": lambda things: {"kind": "scene"},
    "solve": lambda things: {
        "file": things.file("scene.yaml", SCENE),
        "threads": "1",
        "mpi": False,
        "output": things.new("s.nc"),
    },
    "statistics": lambda things: {
        "file": things.file("map.nc", things.map()),
        "output": things.new("t.nc"),
        "percolation": True,
    },
    "status": lambda things: {"directory": things.finished(), "as_json": False, "watch": False},
    "surface": lambda things: {"file": things.file("surface.yaml", SURFACE), "output": things.new("u.nc")},
    "verify": lambda things: {"directory": things.finished()},
}
# what may be given of these, as others cost processes or minutes
_NEVER_GIVEN = re.compile("[\0\ud800-\udc7f\udd00-\udfff]")  # what no system hands to a command
NUMBERS_OF_MANY = ["-1", "", "x", "1e3", "nan", "0.5", "9" * 30, "1e400", "0x10", " 1", "--"]
OF_MANY = ("workers", "realisations", "limit")


def command_of(name):
    return main.get_command(click.Context(main), name)


def words(name, arguments):
    """The command line of the arguments of a command, by the names of its parameters."""
    line = [name]
    for parameter in command_of(name).params:
        value = arguments[parameter.name]
        each = value if isinstance(value, list | tuple) else [value]
        if isinstance(parameter, click.Argument):
            line += ["--", *map(str, each)]
        elif getattr(parameter, "is_flag", False):
            line[1:1] = [parameter.opts[-1]] * bool(value is True)
        else:
            line[1:1] = [word for one in each if one is not None for word in (parameter.opts[-1], str(one))]
    return [_NEVER_GIVEN.sub("", word) for word in line]


def lines(name, arguments):
    """Strategy of the command line of a good call with some of its arguments altered."""
    flags = {each.name for each in command_of(name).params if getattr(each, "is_flag", False)}

    def other(key):
        if key == "mpi":  # which would start in the process of the tests, and stay
            return st.just(False)
        if key in flags:
            return st.booleans()
        if key in OF_MANY:
            return st.sampled_from(NUMBERS_OF_MANY)
        return altered(arguments[key] if arguments[key] is not None else "x")

    return (calls(arguments, other) if arguments else st.just({})).map(lambda given: words(name, given))


def ends_well(line):
    """A command ends with an exit code of its own and, if it is refused, a reason, in time."""
    with deadline(SECONDS):
        done = CliRunner().invoke(main, line)
    assert isinstance(done.exception, SystemExit | None), done.exception
    assert done.exit_code in (0, 2, 3, 130)
    assert "Traceback" not in done.output
    assert done.exit_code == 0 or done.output.strip()


def test_every_command_and_each_of_its_options_is_called():
    assert set(main.list_commands(click.Context(main))) == COMMANDS.keys()
    for name, made in COMMANDS.items():
        assert made(Mock()).keys() == {parameter.name for parameter in command_of(name).params}, name


@pytest.mark.long
def test_the_calls_of_commands_are_good(undrawn, things, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, made in COMMANDS.items():
        done = CliRunner().invoke(main, words(name, made(things)), catch_exceptions=False)
        assert done.exit_code == 0, done.output


@pytest.mark.long
@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_given_anything_ends_or_says_why(things, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    fuzzed(lines(name, COMMANDS[name](things)), ends_well, MANY, derandomize=True)


@pytest.mark.parametrize(
    "command", ["surface", "solve", "curve", "statistics", "accuracy", "fields", "plot", "fit", "report"]
)
def test_an_output_without_a_name_is_refused(things, tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    line = words(command, COMMANDS[command](things) | {"output": ""})
    ends_well(line)
    assert CliRunner().invoke(main, line).exit_code == 2
