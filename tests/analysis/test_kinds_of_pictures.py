"""`gfmd plot` draws whatever gfmd writes, and its pictures can be read in grey and without blank axes."""

import json
from itertools import pairwise
from tempfile import TemporaryDirectory

import numpy as np
import pytest
import xarray as xr
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

import gfmd_numba
from gfmd_numba.analysis import UnusableDataError, leakage, plot_accuracy, plot_fit
from gfmd_numba.analysis.plots.kinds import KINDS, picture_of, second_picture_of
from gfmd_numba.analysis.plots.style import log_ticks, ordered_colours
from support import synthetic_campaigns
from support.cases import some_of
from support.command_line import gfmd
from support.legible import faults

SCENE = {
    "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5},
    "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
    "interface": {"hard_wall": {}},
    "loading": {"reduced_pressure": 0.1},
}
FILE = {"scene": SCENE, "discretisation": {"eps_c": 0.5, "eps_f": 0.25, "eps_t": 1}}


def _contact():
    return gfmd_numba.solve(FILE)


def _map():
    return gfmd_numba.solve(FILE | {"scene": SCENE | {"dimension": 2}})


def _paths():
    """Dragged to and fro under a load, for two coefficients of friction."""
    scene = SCENE | {"interface": {"hard_wall": {}, "friction": {"coefficient": 0.1}}}
    campaign = {"name": "dragged", "seed": 1, "realisations": 2, "scene": scene, "reference": FILE["discretisation"]}
    campaign |= {"grid": {"friction_coefficient": [0.1, 0.2]}, "path": [{"sliding": s} for s in (1e-3, 0.0, -1e-3)]}
    with TemporaryDirectory() as folder:
        return gfmd_numba.run(campaign, f"{folder}/out")


def _studies():
    return xr.Dataset(
        {
            "study": ("point", ["eps_c"] * 2 + ["surfaces"] * 2),
            "curve": ("point", ["counted"] * 2 + ["reference discretisation"] * 2),
            "setting": ("point", [0.5, 0.25, 4, 16]),
            "error": ("point", [0.2, 0.1, 0.02, 0.01]),
            "seconds": ("point", [1.0, 1.2, 1.0, 1.0]),
            "failed": ("point", [0, 0, 0, 0]),
        }
    )


def _fit(hursts=(0.3, 0.8)):
    made_up = synthetic_campaigns.campaign(hursts, realisations=20)
    dataset = synthetic_campaigns.noisy(made_up, np.random.default_rng(1))
    return gfmd_numba.fit_tfc(dataset, fixed=synthetic_campaigns.ALPHA)


CREEPS = FILE | {"scene": SCENE | {"body": SCENE["body"] | {"relaxation": [{"modulus": 2.0, "time": 1.0}]}}}
WRITTEN = {
    "contact": _contact,
    "body that flows": lambda: gfmd_numba.solve(
        FILE | {"scene": SCENE | {"body": {"poissons_ratio": 0.3, "plasticity": {"yield_stress": 5e-3}}}}
    ),
    "fields inside a body": lambda: gfmd_numba.body_fields(_contact()),
    "load curve": lambda: gfmd_numba.load_curve(FILE, [0.1, 0.2]),
    "creep curve": lambda: gfmd_numba.load_curve(CREEPS, times=[0.1, 1.0]),
    "friction curve": lambda: gfmd_numba.load_curve(CREEPS, speeds=[0.1, 1.0]),
    "statistics of a contact": lambda: gfmd_numba.contact_statistics(_contact()),
    "leakage": lambda: leakage(_map()),
    "conductance": lambda: gfmd_numba.contact_conductance(_map()),
    "surface": lambda: gfmd_numba.make_surface(
        {"surface": {"method": "psd", "hurst": 0.8, "rms_height": 0.01, "points": 64, "cut_on": 0.1, "roll_off": 0.5}}
    ),
    "loaded body": lambda: gfmd_numba.solve(
        {"scene": {"body": SCENE["body"], "boundary": {"normal_traction": 0.01}}, "points": 16}
    ),
    "accuracy": _studies,
    "fit": _fit,
    "loading path": _paths,
}


def test_every_kind_is_tried():
    assert WRITTEN.keys() == KINDS.keys()


@pytest.fixture
def faults_of_written(undrawn, monkeypatch):
    """Faults of each picture as it is written; what is written is empty."""
    found, write = [], Figure.savefig

    def looked_at(figure, file, **options):
        found.append(faults(figure))
        write(figure, file, **options)

    monkeypatch.setattr(Figure, "savefig", looked_at)
    return found


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:.*the grid has too few nodes")
@pytest.mark.parametrize("kind", WRITTEN)
def test_plot_draws_what_was_written(kind, tmp_path, faults_of_written):
    dataset = WRITTEN[kind]()
    assert picture_of(dataset) is KINDS[kind][1]
    dataset.to_netcdf(tmp_path / "written.nc")
    said = gfmd("plot", tmp_path / "written.nc")
    assert said.exit_code == 0, said.output
    assert faults_of_written == [[]]
    assert (tmp_path / "written.png").exists()


RUBBING = SCENE | {"interface": {"hard_wall": {}, "friction": {"coefficient": 0.1}}}
DISPLACED = SCENE | {"loading": {"displacement": 1e-3}}


@pytest.mark.long
@pytest.mark.parametrize(
    ("scene", "steps", "x", "y", "label"),
    [
        (RUBBING, {"sliding": [0.0, 1e-3, 0.0, -1e-3]}, "sliding", "mean_tangential_traction", "Sliding of the punch"),
        (DISPLACED, {"displacement": [1e-3, 4e-3, 2e-3]}, "punch_displacement", "mean_pressure", "Punch displacement"),
        (SCENE, {"reduced_pressure": [0.1, 0.3, 0.2]}, "reduced_pressure", "contact_area_fraction", "Reduced pressure"),
    ],
)
def test_the_picture_of_a_path_is_its_loop_and_a_second_one_its_last_step(
    scene, steps, x, y, label, tmp_path, faults_of_written
):
    ((name, values),) = steps.items()
    path = gfmd_numba.solve(FILE | {"scene": scene, "path": [{name: value} for value in values[1:]]})
    axis = picture_of(path)(path).axes[0]
    assert axis.get_xlabel().startswith(label)
    drawn = axis.lines[0].get_xydata()
    for found, variable in zip(drawn.T, (x, y), strict=True):
        np.testing.assert_allclose(found * np.ptp(path[variable].values), path[variable] * np.ptp(found), rtol=1e-9)
    path.to_netcdf(tmp_path / "path.nc")
    said = gfmd("plot", tmp_path / "path.nc")
    assert said.exit_code == 0, said.output
    assert faults_of_written == [[], []]
    assert sorted(each.name for each in tmp_path.glob("*.png")) == ["path-last-step.png", "path.png"]
    last = path.isel(step=-1)
    assert picture_of(last) is KINDS["contact"][1]
    assert second_picture_of(last) is None


@pytest.mark.parametrize("dimension", [1, pytest.param(2, marks=pytest.mark.long)])
def test_the_steps_of_friction_say_the_tangential_traction_and_what_sticks(dimension, tmp_path):
    scene = RUBBING | {"dimension": dimension}
    (tmp_path / "rub.yaml").write_text(json.dumps(FILE | {"scene": scene, "path": [{"sliding": 1e-3}]}))
    said = gfmd("solve", tmp_path / "rub.yaml", "-o", tmp_path / "rub.nc")
    assert said.exit_code == 0, said.output
    table = said.output.partition("steps of the path")[2]
    assert table.count("tangential") == dimension
    assert "sticking" in table
    found = xr.open_dataset(tmp_path / "rub.nc")
    assert f" {found['stick_fraction'].values[-1]:.4g} " in table


@pytest.mark.parametrize("count", range(2, 8))
def test_ordered_colours_fall_apart_in_grey(count):
    lightness = [np.dot(to_rgb(colour), (0.2126, 0.7152, 0.0722)) for colour in ordered_colours(count)]
    assert (np.diff(lightness) > 0.4 / count).all()


@pytest.mark.parametrize(("low", "high"), some_of([(1.01, 1.4), (0.3, 9.0), (1e-9, 1e-3)], 1))
def test_a_logarithmic_axis_has_at_least_two_labels_that_do_not_collide(low, high):
    figure = Figure((4.0, 3.0), layout="constrained")
    axis = figure.subplots()
    axis.set(xscale="log", xlim=(low, high))
    log_ticks(axis.xaxis)
    figure.draw_without_rendering()
    labels = [label for label in axis.get_xticklabels() if label.get_text()]
    boxes = [
        label.get_window_extent() for label, at in zip(labels, axis.get_xticks(), strict=False) if low <= at <= high
    ]
    assert len(boxes) >= 2
    assert all(left.x1 < right.x0 for left, right in pairwise(boxes))


def test_the_studies_of_accuracy_leave_no_panel_empty_and_no_default_colour():
    figure = plot_accuracy(_studies())
    assert [axis.get_title() for axis in figure.axes] == [
        r"Continuum: $1/\varepsilon_c$",
        "Number of surfaces",
    ]
    assert all(axis.lines for axis in figure.axes)


def test_every_curve_of_a_study_is_drawn_however_many_there_are():
    points = np.arange(1.0, 11.0)
    studies = xr.Dataset(
        {
            "study": ("point", ["solver residual"] * 10),
            "curve": ("point", [f"solver {i:g}" for i in points]),
            **{name: ("point", points) for name in ("setting", "error", "seconds")},
            "failed": ("point", np.zeros(10, int)),
        }
    )
    (axis,) = plot_accuracy(studies).axes
    assert len(axis.lines) == 10


@pytest.mark.parametrize("hursts", [pytest.param((0.3, 0.8), marks=pytest.mark.long), (0.8,)])
def test_the_picture_of_a_fit_shows_every_limit_with_its_error(hursts):
    fit = _fit(hursts)
    (axis,) = plot_fit(fit).axes
    (drawn,) = axis.containers
    assert drawn.lines[0].get_xdata().tolist() == list(hursts)
    np.testing.assert_array_equal(drawn.lines[0].get_ydata(), fit["kappa_tfc"])
    bars = np.array([[low[1], high[1]] for low, high in drawn.lines[2][0].get_segments()])
    np.testing.assert_allclose(np.ptp(bars, axis=1), 2 * fit["kappa_tfc_error"])


def test_a_refused_group_is_left_out_of_the_picture_of_a_fit():
    fit = _fit()
    fit["fit_status"] = ("group", ["refused", "ok"])
    (axis,) = plot_fit(fit).axes
    assert axis.containers[0].lines[0].get_xdata().tolist() == [0.8]
    fit["fit_status"] = ("group", ["refused", "refused"])
    with pytest.raises(UnusableDataError, match="refused in every group"):
        plot_fit(fit)
