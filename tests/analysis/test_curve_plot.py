"""Pictures of load curves, and of the step of a path that is drawn."""

from itertools import pairwise

import numpy as np
import pytest
import xarray as xr

from gfmd_numba import load_curve, solve
from gfmd_numba.analysis import UnusableDataError, plot_contact, plot_curve
from support.cases import some_of
from support.contacts import scene_file
from support.legible import faults


@pytest.fixture(scope="module")
def found():
    fine = {"discretisation": {"eps_c": 1 / 8, "eps_f": 1 / 32, "eps_t": 0.5}}
    return load_curve(scene_file(1e-4, 70e9) | fine, [0.01, 0.1, 0.5], 3)


def test_a_curve_shows_four_quantities_over_the_pressure_with_their_errors(found):
    axes = plot_curve(found).axes
    labels = [axis.get_ylabel() for axis in axes]
    assert [label.split(" (")[0].split(" $")[0] for label in labels] == [
        "Contact area fraction",
        "Mean gap",
        "Stiffness",
        "Peak pressure",
    ]
    assert [label.partition("(")[2] for label in labels] == ["", "nm)", "MPa/µm)", "GPa)"]
    assert [axis.get_yscale() for axis in axes] == ["log", "linear", "log", "linear"]
    for axis in axes:
        assert axis.get_xscale() == "log"
        np.testing.assert_allclose(axis.lines[0].get_xdata(), found["mean_pressure"] * 1e-6)
        assert len(axis.collections) == 1
        assert not any("warning" in line.get_label() for line in axis.lines)


@pytest.mark.long
def test_a_curve_says_which_bodies_it_is_of_within_its_frame(found):
    figure = plot_curve(found, "single")
    figure.draw_without_rendering()
    said, box = figure.get_suptitle(), figure._suptitle.get_window_extent()
    assert not any(line[0].isalpha() and before[-1].isdigit() for before, line in pairwise(said.splitlines()))
    assert said.replace("\n", " ").startswith("Rough profile, Hurst exponent 0.8, 100 µm long, on a ")
    assert "Young's modulus 70 GPa" in said.replace("\n", " ")
    assert said.endswith("Mean of 3 surfaces, band: standard error")
    assert box.x0 >= 0.0
    assert box.x1 <= figure.bbox.x1
    assert box.y0 > figure.axes[0].get_window_extent().y1


def test_loads_without_a_result_are_left_out(found):
    failed = found.copy(deep=True)
    failed["n_realisations"][1] = 0
    assert [len(axis.lines[0].get_xdata()) for axis in plot_curve(failed).axes] == [2] * 4
    failed["n_realisations"][:] = 0
    with pytest.raises(UnusableDataError, match="no load with a result"):
        plot_curve(failed)


@pytest.mark.long
def test_loads_that_are_warned_of_are_hollow():
    """Single nodes at the first two loads; every contact is some 20 nodes wide at the last."""
    scene = scene_file(1e-4, 70e9) | {"discretisation": {"eps_c": 0.5, "eps_f": 0.01, "eps_t": 0.25}}
    with pytest.warns(UserWarning, match="contacts are narrow"):
        narrow = load_curve(scene, [2e-3, 4e-3, 0.5])
    assert narrow["n_warned"].values.tolist() == [1, 1, 0]
    figure = plot_curve(narrow)
    for axis in figure.axes:
        line, hollow = axis.lines[:2]
        assert hollow.get_markerfacecolor() == "white"
        np.testing.assert_array_equal(hollow.get_xydata(), line.get_xydata()[:2])
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["with a warning"]


def test_infinite_stiffness_is_left_out(found):
    full = found.copy(deep=True)
    full["contact_stiffness"][-1] = np.inf
    assert [len(axis.lines[0].get_xdata()) for axis in plot_curve(full).axes] == [3, 3, 2, 3]


def test_a_stiffness_that_is_infinite_everywhere_is_called_so(found):
    full = found.copy(deep=True)
    full["contact_stiffness"][:] = np.inf
    assert [text.get_text() for text in plot_curve(full).axes[2].texts] == ["infinite"]


@pytest.mark.parametrize(
    ("length", "modulus", "unit"), some_of([(None, 70e9, "(GPa$/L_x$)"), (1e-4, None, "($E^*$/m)")], 1)
)
def test_a_stiffness_without_moduli_or_length_says_so(length, modulus, unit):
    stiffness = plot_curve(load_curve(scene_file(length, modulus), [0.05, 0.5])).axes[2]
    assert unit in stiffness.get_ylabel()


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:.*the grid has too few nodes")
def test_a_curve_with_a_hardness_shows_it_and_the_area_that_yields():
    scene = scene_file(1e-4, 70e9)
    scene["scene"]["interface"] = {"hard_wall": {"hardness": "0.5 GPa"}}
    curve = load_curve(scene, ["10 MPa", "30 MPa", "100 MPa"])
    figure = plot_curve(curve, "single")
    area, _, _, peak = figure.axes
    line = next(each for each in peak.lines if each.get_label() == "hardness")
    assert set(line.get_ydata()) == {500.0}
    assert peak.get_ylabel() == "Peak pressure (MPa)"
    assert peak.get_ylim()[0] < 500.0 < peak.get_ylim()[1]
    yields = curve["plastic_area_fraction"].values
    drawn = next(each for each in area.lines if "hardness" in each.get_label()).get_ydata()
    np.testing.assert_array_equal(drawn, np.where(yields > 0.0, yields, np.nan))
    assert np.isfinite(drawn).any()
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["area at the hardness", "hardness"]
    assert faults(figure) == []


@pytest.mark.long
def test_a_curve_of_a_body_that_flows_shows_its_plastic_strain(found):
    flows = found.assign(largest_plastic_strain=("prescribed_load", [0.0, 0.01, 0.02]))
    figure = plot_curve(flows, "double")
    strain = figure.axes[-1]
    assert strain.get_ylabel() == "Largest plastic strain"
    np.testing.assert_array_equal(strain.lines[0].get_ydata(), [0.0, 0.01, 0.02])
    below = [axis for axis in figure.axes if axis.get_xlabel()]
    assert below == figure.axes[-2:]
    figure.draw_without_rendering()
    assert all(any(label.get_visible() for label in axis.get_xticklabels()) for axis in below)
    assert faults(figure) == []


@pytest.mark.long
def test_what_hardly_changes_spans_a_small_part_of_its_axis(found):
    """Peak pressures that differ by 2e-4 have no axis from 2.4500 to 2.4504."""
    near = found.drop_vars("peak_pressure_standard_error").copy(deep=True)
    near["peak_pressure"][:] = [2.4500e9, 2.4502e9, 2.4504e9]
    figure = plot_curve(near)
    figure.draw_without_rendering()
    low, high = figure.axes[3].get_ylim()
    assert low < 2.45 < 2.4504 < high
    assert high - low > 0.2
    assert max(len(label.get_text()) for label in figure.axes[3].get_yticklabels()) <= 4


def test_other_datasets_are_no_curves():
    with pytest.raises(UnusableDataError, match="no load curve"):
        plot_curve(xr.Dataset({"prescribed_load": ("prescribed_load", [1.0])}))


def test_the_picture_of_a_path_says_which_step_it_shows():
    path = solve(scene_file() | {"path": [{"reduced_pressure": 0.1}, {"reduced_pressure": 0.2}]})
    assert plot_contact(path).get_suptitle() == "Step 2, the last, $p^*$ = 0.2"
    assert plot_contact(path.isel(step=0)).get_suptitle() == ""
