"""Every public function and every command, given anything for each of its arguments: a result or a reason."""

import inspect
import warnings
from functools import cache, partial

import click
import pytest
import xarray as xr
import yaml
from click.testing import CliRunner
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import gfmd_numba
from gfmd_numba import analysis
from gfmd_numba.cli import main
from gfmd_numba.scene import InputError
from support.hostile import altered, calls, deadline

SCENE = {
    "length": 1e-4,
    "body": {"youngs_modulus": 70e9, "poissons_ratio": 0.33, "aspect_ratio": 1.0},
    "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
    "interface": {"hard_wall": {}},
    "loading": {"reduced_pressure": 0.1},
    "discretisation": {"eps_c": 0.5, "eps_f": 0.25, "eps_t": 1},
}
MAP = {**SCENE, "dimension": 2}
SURFACE = {
    "surface": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01, "points": 64, "cut_on": 0.1, "roll_off": 0.5}
}
CAMPAIGN = {
    "name": "small",
    "seed": 1,
    "realisations": 20,
    "scene": {key: SCENE[key] for key in ("length", "body", "roughness", "interface", "loading")},
    "reference": {"eps_c": 0.25, "eps_f": 0.25, "eps_t": 0.5},
    "limits": {"eps_c": [0.5, 0.25, 0.125], "eps_f": [0.5, 0.25, 0.125]},
    "grid": {"reduced_pressure": [0.05, 0.1]},
}
TINY = {key: CAMPAIGN[key] for key in ("name", "seed", "scene", "reference")} | {"realisations": 2}
EXPONENTS = {"eps_c": 1.0, "eps_f": [0.5, 1.0]}
SECONDS = 60.0  # netCDF files that may be damaged are tried by another process, for up to 10 s of processor time
FEW, MANY = 6, 500


class Things:
    """Files and datasets that the good calls take, each made once."""

    def __init__(self, folder):
        self.folder = folder

    @cache  # noqa: B019
    def written(self, name):
        """Path of a file in a folder of its own."""
        folder = self.folder / name.replace(".", "-")
        folder.mkdir()
        return folder / name

    def file(self, name, content):
        path = self.written(name)
        if not path.exists():
            if isinstance(content, dict):
                path.write_text(yaml.safe_dump(content))
            else:
                content.to_netcdf(path, engine="netcdf4")
        return path

    @cache  # noqa: B019
    def new(self, name):
        """Path of a file or folder that is not there, in a folder of its own."""
        return self.written(f"new-{name}")

    @cache  # noqa: B019
    def finished(self):
        """Output directory of a finished run."""
        gfmd_numba.run(TINY, self.folder / "finished")
        return self.folder / "finished"

    @cache  # noqa: B019
    def contact(self):
        return gfmd_numba.solve(SCENE)

    @cache  # noqa: B019
    def map(self):
        return gfmd_numba.solve(MAP)

    @cache  # noqa: B019
    def results(self):
        return gfmd_numba.run(CAMPAIGN, self.folder / "out")

    @cache  # noqa: B019
    def fit(self):
        return gfmd_numba.fit_tfc(self.results(), fixed=EXPONENTS)

    @cache  # noqa: B019
    def curve(self):
        return gfmd_numba.load_curve(SCENE, [0.1, 0.2])

    @cache  # noqa: B019
    def rounds(self):
        rounds = {
            "round_error": ("round", [0.2, 0.1]),
            "round_error_factor": ("round", [1.3, 1.1]),
            "round_predicted_error": ("round", [0.2, 0.12]),
            "round": [0, 1],
            "round_cpu_seconds": ("round", [1.0, 4.0]),
        }
        return self.results().assign(rounds).assign_attrs(target=0.05, until="kappa=0.05", ended="reached")

    @cache  # noqa: B019
    def accuracy(self):
        points = {
            "study": ["eps_c", "eps_c", "effects"],
            "curve": ["kappa", "kappa", "kappa"],
            "setting": [0.5, 0.25, 1.0],
            "error": [0.1, 0.05, 0.2],
            "seconds": [0.1, 0.2, 0.1],
            "failed": [0, 0, 0],
        }
        return xr.Dataset({name: ("point", values) for name, values in points.items()})


FUNCTIONS = {
    "gfmd_numba.solve": lambda things: {"scene": SCENE, "heights": None},
    "gfmd_numba.load_curve": lambda things: {"scene": SCENE, "loads": [0.1, 0.2], "realisations": 1, "heights": None},
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
    "gfmd_numba.leakage": lambda things: {"dataset": things.map()},
    "gfmd_numba.contact_conductance": lambda things: {"contact": things.contact()},
    "gfmd_numba.analysis.best_design": lambda things: {
        "pilot": things.results(),
        "seconds": [0.01] * 10,
        "budget": 10.0,
        "variable": "kappa",
        "fixed": EXPONENTS,
    },
    "gfmd_numba.analysis.cheapest_design": lambda things: {
        "pilot": things.results(),
        "seconds": [0.01] * 10,
        "target": 0.05,
        "variable": "kappa",
        "fixed": EXPONENTS,
    },
    "gfmd_numba.analysis.contact_stiffness": lambda things: {"dataset": things.results()},
    "gfmd_numba.analysis.ensemble_mean": lambda things: {"cases": things.results(), "variable": "kappa"},
    "gfmd_numba.analysis.plot_accuracy": lambda things: {"dataset": things.accuracy()},
    "gfmd_numba.analysis.plot_body": lambda things: {"dataset": gfmd_numba.body_fields(things.contact(), [-1e-5, 0.0])},
    "gfmd_numba.analysis.plot_campaign": lambda things: {
        "dataset": things.results(),
        "fit": things.fit(),
        "variable": "kappa",
    },
    "gfmd_numba.analysis.plot_contact": lambda things: {"dataset": things.contact()},
    "gfmd_numba.analysis.plot_curve": lambda things: {"dataset": things.curve()},
    "gfmd_numba.analysis.plot_fit": lambda things: {"fit": things.fit()},
    "gfmd_numba.analysis.plot_leakage": lambda things: {"dataset": analysis.leakage(things.map())},
    "gfmd_numba.analysis.plot_conductance": lambda things: {"dataset": gfmd_numba.contact_conductance(things.map())},
    "gfmd_numba.analysis.plot_rounds": lambda things: {"dataset": things.rounds()},
    "gfmd_numba.analysis.plot_statistics": lambda things: {
        "statistics": gfmd_numba.contact_statistics(things.contact())
    },
    "gfmd_numba.analysis.plot_surface": lambda things: {"dataset": gfmd_numba.make_surface(SURFACE)},
    "gfmd_numba.analysis.predictions": lambda things: {
        "results": things.results(),
        "counts": [20] * 10,
        "variable": "kappa",
        "fixed": EXPONENTS,
    },
    "gfmd_numba.analysis.select_limit": lambda things: {"dataset": things.results(), "limit": "eps_c"},
}
FUNCTIONS |= {  # the same functions, seen from another room
    f"gfmd_numba.analysis.{name}": FUNCTIONS[f"gfmd_numba.{name}"]
    for name in sorted(set(analysis.__all__) & set(gfmd_numba.__all__))
}


def public_functions():
    rooms = (gfmd_numba, analysis)
    return {
        f"{room.__name__}.{name}": getattr(room, name)
        for room in rooms
        for name in room.__all__
        if inspect.isroutine(getattr(room, name))
    }


@pytest.fixture(scope="module")
def things(tmp_path_factory):
    return Things(tmp_path_factory.mktemp("things"))


def test_every_public_function_and_each_of_its_arguments_has_a_good_call(things):
    public = public_functions()
    assert public.keys() == FUNCTIONS.keys()
    for name, function in public.items():
        arguments = FUNCTIONS[name](things)
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


def fuzzed(strategy, check, examples, **chosen):
    @given(arguments=strategy)
    @settings(max_examples=examples, deadline=None, database=None, suppress_health_check=list(HealthCheck), **chosen)
    def fuzz(arguments):
        check(arguments)

    fuzz()


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


@pytest.mark.parametrize("command", ["surface", "solve", "curve", "statistics", "accuracy", "fields", "plot", "fit"])
def test_an_output_without_a_name_is_refused(things, tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    line = words(command, COMMANDS[command](things) | {"output": ""})
    ends_well(line)
    assert CliRunner().invoke(main, line).exit_code == 2


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_given_anything_returns_or_says_why(things, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    function = public_functions()[name]
    fuzzed(calls(FUNCTIONS[name](things)), partial(result_or_reason, function), FEW, derandomize=True)


@pytest.mark.long
@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_given_anything_many_times_returns_or_says_why(things, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    function = public_functions()[name]
    fuzzed(calls(FUNCTIONS[name](things)), partial(result_or_reason, function), MANY)


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
    },
    "curve": lambda things: {
        "file": things.file("scene.yaml", SCENE),
        "loads": "0.1:0.2:2",
        "realisations": "1",
        "output": things.new("l.nc"),
    },
    "doctor": lambda things: {},
    "fields": lambda things: {
        "file": things.file("map.nc", things.map()),
        "output": things.new("f.nc"),
        "body": "body",
        "x": None,
        "y": "5e-5",
        "plane": [],
    },
    "fit": lambda things: {
        "results": things.file("results.nc", things.results()),
        "variable": "kappa",
        "exponents": "shared",
        "fixed": ["eps_c=1", "eps_f=0.5:1"],
        "output": things.new("fit.nc"),
    },
    "init": lambda things: {"file": things.new("new.yaml")},
    "leakage": lambda things: {
        "file": things.file("map.nc", things.map()),
        "output": things.new("k.nc"),
        "as_json": False,
    },
    "plan": lambda things: {
        "file": things.file("tiny.yaml", TINY),
        "workers": "1",
        "pilot": "0",
        "target": None,
        "budget": None,
        "write": None,
    },
    "plot": lambda things: {
        "results": things.file("results.nc", things.results()),
        "variable": "kappa",
        "exponents": "shared",
        "fixed": ["eps_c=1", "eps_f=0.5:1"],
        "output": things.new("p.png"),
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
    "solve": lambda things: {"file": things.file("scene.yaml", SCENE), "output": things.new("s.nc")},
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
    return [word.replace("\0", "") for word in line]  # which no system hands to a command


def lines(name, arguments):
    """Strategy of the command line of a good call with some of its arguments altered."""
    flags = {each.name for each in command_of(name).params if getattr(each, "is_flag", False)}

    def other(key):
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


def test_every_command_and_each_of_its_options_is_called(things):
    assert set(main.list_commands(click.Context(main))) == COMMANDS.keys()
    for name, made in COMMANDS.items():
        assert made(things).keys() == {parameter.name for parameter in command_of(name).params}, name


@pytest.mark.long
def test_the_calls_of_commands_are_good(things, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, made in COMMANDS.items():
        done = CliRunner().invoke(main, words(name, made(things)), catch_exceptions=False)
        assert done.exit_code == 0, done.output


@pytest.mark.parametrize("name", sorted(COMMANDS.keys() - {"accuracy", "doctor"}))  # which take seconds
def test_a_command_given_anything_ends_or_says_why(things, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    fuzzed(lines(name, COMMANDS[name](things)), ends_well, FEW // 2, derandomize=True)


@pytest.mark.long
@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_given_anything_many_times_ends_or_says_why(things, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    fuzzed(lines(name, COMMANDS[name](things)), ends_well, MANY)
