"""Pictures of contacts, fields and surfaces say what they show, in one unit a quantity, with nothing cut off."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.analysis import leakage, plot_body, plot_conductance, plot_contact, plot_leakage
from gfmd_numba.analysis.plots.bodies import plot_flow, plot_loaded_body
from gfmd_numba.analysis.plots.contact import plot_statistics
from gfmd_numba.analysis.plots.path import plot_path
from gfmd_numba.analysis.plots.surface import plot_surface
from gfmd_numba.text.numbers import si_prefix
from support.legible import faults

BODY = {"youngs_modulus": 1e9, "poissons_ratio": 0.3, "aspect_ratio": 0.5}
ROUGH = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02}
SCENE = {
    "length": 1e-4,
    "body": BODY,
    "roughness": ROUGH,
    "interface": {"hard_wall": {}, "friction": {"coefficient": 0.3}},
    "loading": {"reduced_pressure": 0.05},
}
GRID = {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1 / 2}


@pytest.fixture(scope="module")
def dragged():
    return gfmd_numba.solve({"scene": SCENE, "discretisation": GRID, "path": [{"sliding": 5e-9}]})


@pytest.fixture(scope="module")
def dragged_map():
    return gfmd_numba.solve(
        {"scene": SCENE | {"dimension": 2}, "discretisation": GRID | {"eps_f": 1 / 4}, "path": [{"sliding": 5e-9}]}
    )


@pytest.fixture(scope="module")
def below(dragged):
    return gfmd_numba.body_fields(dragged)


@pytest.fixture(
    scope="module",
    params=[{"y": 50e-6}, {"planes": [-1e-6, -5e-6]}],
    ids=["section", "planes"],
)
def below_map(dragged_map, request):
    return gfmd_numba.body_fields(dragged_map, **request.param)


@pytest.mark.long
def test_the_tangential_traction_of_a_profile_is_drawn_in_the_unit_of_its_pressure(dragged):
    figure = plot_contact(dragged)
    below = figure.axes[-1]
    assert below.get_ylabel() == r"Tractions $p$, $\tau$ (MPa)"
    drawn = {line.get_label(): line.get_ydata() for line in below.lines}
    np.testing.assert_allclose(drawn[r"tangential $\tau$"], dragged["tangential_traction"][-1] / 1e6)
    assert below.get_ylim()[0] < drawn[r"tangential $\tau$"].min() < 0.0
    assert faults(figure) == []


@pytest.mark.long
def test_tractions_prescribed_under_a_punch_are_drawn_with_its_pressure():
    boundary = {"normal_traction": -2e6, "tangential_traction": 3e6}
    scene = SCENE | {"boundary": boundary, "loading": {"displacement": 5e-8}}
    figure = plot_contact(gfmd_numba.solve({"scene": scene, "discretisation": GRID}))
    drawn = {line.get_label(): line.get_ydata() for line in figure.axes[-1].lines}
    np.testing.assert_allclose(drawn["prescribed, outwards"], -2.0, rtol=1e-9)
    np.testing.assert_allclose(drawn["prescribed, along $x$"], 3.0, rtol=1e-9)
    assert figure.axes[-1].get_ylabel() == "Tractions (MPa)"
    assert faults(figure) == []


def test_the_punch_reaches_the_top_of_the_picture_however_far_the_close_up_goes(dragged):
    dragged = dragged.copy()
    dragged["gap"] = 0.0 * dragged["gap"]
    whole = plot_contact(dragged).axes[0]
    punch = whole.collections[0].get_paths()[0].vertices[:, 1]
    assert punch.max() == pytest.approx(whole.get_ylim()[1], rel=1e-9)


@pytest.mark.long
def test_a_section_without_contact_says_so_and_its_deep_maximum_leaves_the_title_whole(dragged_map):
    fields = gfmd_numba.body_fields(dragged_map, y=50e-6).copy(deep=True)
    fields["pressure"][:] = 0.0
    fields["von_mises"][:, np.argmin(np.abs(fields["z"].values + 14e-6)), 7] = 1e9
    figure = plot_body(fields)
    assert [text.get_text() for text in figure.axes[0].texts] == ["no pressure along this section"]
    assert figure.axes[0].get_ylabel() == "Pressure $p$"
    assert faults(figure) == []


@pytest.mark.long
def test_fields_along_a_path_name_the_step_that_they_show(dragged_map, below_map):
    figure = plot_body(below_map)
    assert figure.get_suptitle() == plot_contact(dragged_map).get_suptitle() != ""
    assert faults(figure) == []


@pytest.mark.long
def test_fields_inside_the_counter_body_are_called_so():
    both = {name: SCENE[name] for name in ("length", "loading")} | {"interface": {"hard_wall": {}}}
    both |= {"body": BODY | {"roughness": ROUGH}, "counter_body": BODY}
    contact = gfmd_numba.solve({"scene": both, "discretisation": GRID, "numerics": {"topography_order": 0}})
    fields = gfmd_numba.body_fields(contact, body="counter_body")
    assert fields.attrs["title"] == "fields inside the counter body"
    figure = plot_body(fields)
    assert figure.get_suptitle() == "Counter body"
    assert faults(figure) == []


@pytest.mark.long
def test_powers_of_ten_are_multiplied_in_titles(below_map):
    fields = below_map.copy()
    fields["von_mises"] = (1e-11 * fields["von_mises"]).assign_attrs(units="1")
    titles = " ".join(axis.get_title() for axis in plot_body(fields).axes)
    assert r"$\times$$10^{" in titles


@pytest.mark.long
def test_the_pressure_lies_right_above_the_section(below):
    figure = plot_body(below)
    assert figure.get_suptitle() != "Counter body"
    figure.draw_without_rendering()
    above, whole = (axis.get_window_extent() for axis in figure.axes[:2])
    assert abs(above.x0 - whole.x0) < 2.0
    assert abs(above.x1 - whole.x1) < 2.0


def test_heights_of_a_map_are_called_those_of_both_surfaces_where_the_body_is_rough():
    scene = {name: SCENE[name] for name in ("length", "loading")} | {"interface": {"hard_wall": {}}, "dimension": 2}
    rough = gfmd_numba.solve({"scene": scene | {"body": BODY | {"roughness": ROUGH}}, "discretisation": GRID})
    assert plot_contact(rough).axes[0].images[0].colorbar.ax.get_xlabel() == "Height of both surfaces together (nm)"


@pytest.mark.long
@pytest.mark.parametrize(("tension", "extend"), [(0.0, "max"), (1e6, "both")])
def test_a_tension_beyond_the_colours_of_the_pressure_has_an_arrow(dragged_map, tension, extend):
    pulled = dragged_map.copy(deep=True)
    pulled["pressure"] = pulled["pressure"] - tension * (pulled["gap"] > 0.0)
    (bar,) = (
        axis.images[0].colorbar
        for axis in plot_contact(pulled).axes
        if axis.images and "Pressure" in axis.images[0].colorbar.ax.get_xlabel()
    )
    assert bar.extend == extend


def test_a_traction_left_by_a_residual_is_drawn_in_one_colour():
    boundary = {"normal_traction": 1e6, "tangential_traction": 2e5}
    loaded = gfmd_numba.solve(
        {"scene": {"dimension": 2, "length": 1e-4, "body": BODY, "boundary": boundary}, "points": 16}
    ).copy(deep=True)
    loaded["tangential_traction_y"][:] = 1e-3 * np.random.default_rng(1).standard_normal((16, 16))
    image = plot_loaded_body(loaded).axes[5].images[0]
    assert np.ptp(image.norm(image.get_array())) < 1e-6
    assert image.norm.vmax == pytest.approx(1.0)  # MPa, the largest component


@pytest.mark.long
def test_wave_numbers_are_in_the_unit_of_lengths_and_their_labels_keep_apart():
    surface = {"method": "psd", "hurst": 0.8, "rms_height": 3e-7, "points": 96, "cut_on": "3 um", "roll_off": "50 um"}
    figure = plot_surface(gfmd_numba.make_surface({"surface": surface, "length": 96e-6, "dimension": 2}))
    (spectrum,) = (axis for axis in figure.axes if "Wave number" in axis.get_xlabel())
    assert spectrum.get_xlabel() == "Wave number $q$ (1/µm)"
    assert spectrum.lines[0].get_xdata()[0] == pytest.approx(2.0 * np.pi / 96.0, rel=0.5)
    assert faults(figure) == []


def test_a_load_in_a_legend_has_four_digits(dragged):
    statistics = gfmd_numba.contact_statistics(dragged.isel(step=0))
    statistics["reduced_pressure"] = 0.0122897
    (legend,) = plot_statistics(statistics).legends
    assert legend.get_texts()[0].get_text() == r"$\bar{p}^* = 0.01229$"


@pytest.mark.long
def test_the_energy_of_a_path_has_one_prefix_in_all_panels(tmp_path):
    campaign = {"name": "lost", "seed": 1, "realisations": 3, "scene": SCENE, "reference": GRID | {"eps_f": 1 / 4}}
    campaign |= {"grid": {"hurst": [0.3, 0.8]}, "path": [{"sliding": 4e-8}, {"sliding": 0.0}]}
    found = gfmd_numba.run(campaign, tmp_path / "out").copy(deep=True)
    spread = np.array([0.1, 0.2, 2.7]) * 9e-4  # J/m^2: one of three is above 1 mJ/m^2, their mean is not
    found["hysteresis"][:] = spread
    found["energy_lost"][:] = spread[:, None] * [0.0, 0.5, 0.5]
    labels = [axis.get_ylabel() for axis in plot_path(found).axes if "Energy" in axis.get_ylabel()]
    assert labels == ["Energy lost so far per area (µJ/m²)", "Energy lost per area (µJ/m²)"]


def test_what_rounding_leaves_just_below_a_prefix_has_it():
    assert si_prefix(1e9 * (1.0 - 1e-14), "Pa") == (1e-9, "GPa")
    assert si_prefix(0.99999e9, "Pa") == (1e-6, "MPa")


def widest_bare_rim(figure):
    """Height in inches that is left bare above or below all that is drawn."""
    figure.draw_without_rendering()
    boxes = [axis.get_tightbbox() for axis in figure.axes]
    return max(figure.bbox.y1 - max(box.y1 for box in boxes), min(box.y0 for box in boxes)) / figure.dpi


@pytest.fixture(scope="module")
def pressed_map():
    wall = {"hard_wall": {}}
    return gfmd_numba.solve({"scene": SCENE | {"dimension": 2, "interface": wall}, "discretisation": GRID})


def test_a_direction_in_which_nothing_flows_has_no_panel_but_a_sentence(dragged):
    figure = plot_leakage(leakage(dragged.isel(step=-1)), "single")
    (axis,) = figure.axes
    assert axis.get_ylabel().replace("\n", " ") == "Flow along $y$ over its mean"
    assert figure.get_suptitle() == "No flow along $x$"
    assert faults(figure) == []


def test_a_map_through_which_nothing_flows_has_no_colours_to_explain(pressed_map):
    closed = leakage(pressed_map.assign(gap=0.0 * pressed_map["gap"]))
    figure = plot_leakage(closed)
    (axis,) = figure.axes
    assert axis.images[0].get_array().mask.all()
    assert figure.get_suptitle() == "No flow along $x$ or $y$"


@pytest.mark.long
def test_the_map_of_a_conductance_fills_its_picture(pressed_map):
    assert widest_bare_rim(plot_conductance(gfmd_numba.contact_conductance(pressed_map), "double")) < 0.3


@pytest.mark.long
def test_bodies_that_do_not_touch_are_drawn_in_a_unit_of_their_gap():
    scene = SCENE | {"interface": {"hard_wall": {}}, "loading": {"displacement": 0.0}}
    figure = plot_contact(gfmd_numba.solve({"scene": scene, "discretisation": GRID}))
    figure.draw_without_rendering()
    whole, close, pressure = figure.axes
    assert [whole.get_ylabel(), close.get_ylabel()] == ["Position (nm)", "Close-up (nm)"]
    assert {axis.yaxis.get_offset_text().get_text() for axis in figure.axes} == {""}
    assert close.get_ylim()[1] > 0.5 * whole.get_ylim()[1]
    assert [label.get_text() for label in pressure.get_yticklabels()] == ["0"]


@pytest.mark.long
def test_the_title_of_a_close_up_keeps_off_the_numbers_of_its_colours(below):
    fields = below.isel(step=-1).copy(deep=True)
    fields["von_mises"][dict(x=3, z=int(np.argmin(abs(fields["z"].values + 5.76e-6))))] = 1e9
    figure = plot_body(fields, "single")
    assert faults(figure) == []
    lines = [line for axis in figure.axes for line in axis.get_title().splitlines()]
    assert not [line for line in lines if line.startswith("=") or line.endswith("=")]


@pytest.mark.long
def test_a_path_in_a_column_has_no_equation_broken_in_its_title(below):
    longer = {name: 1.2346 * below[name] for name in ("reduced_pressure", "sliding")}
    lines = plot_body(below.assign_coords(longer), "single").get_suptitle().splitlines()
    assert len(lines) > 1
    assert not [line for line in lines if line.startswith("=") or line.endswith("=")]


@pytest.mark.long
@pytest.mark.parametrize("dimension", [1, 2])
def test_what_has_flowed_has_four_panels_and_of_a_map_names_its_row(dimension):
    body = {"youngs_modulus": 1e9, "poissons_ratio": 0.3, "plasticity": {"yield_stress": 5e6, "sublayers": 8}}
    scene = SCENE | {"interface": {"hard_wall": {}}, "body": body, "dimension": dimension}
    solved = gfmd_numba.solve({"scene": scene, "discretisation": GRID | {"eps_f": 1 / 2}})
    figure = plot_flow(solved, "single")
    _, dents, _, _, *bars = figure.axes
    assert len(bars) == 2
    assert dents.get_ylabel().replace("\n", " ").startswith("Residual $u_z$ (")
    row = int(np.argmax(solved["equivalent_plastic_strain"].max(["depth", "x"]).values)) if dimension == 2 else None
    moved = solved["residual_displacement"] if row is None else solved["residual_displacement"][row]
    np.testing.assert_allclose(
        dents.lines[0].get_ydata() * abs(moved).max().item(), moved * abs(dents.lines[0].get_ydata()).max()
    )
    told = "" if row is None else f"Section at $y$ = {1e6 * float(solved['y'][row]):.4g} µm"
    assert figure.get_suptitle() == told
    assert faults(figure) == []


def test_no_legend_explains_a_line_that_is_not_there(pressed_map):
    statistics = gfmd_numba.contact_statistics(pressed_map)
    statistics["pressure_density_persson"] = 0.0 * statistics["pressure_density_persson"]
    assert "Persson" not in [text.get_text() for text in plot_statistics(statistics).legends[0].get_texts()]


def test_a_small_load_has_a_power_of_ten_in_the_title(dragged):
    light = dragged.assign_coords(reduced_pressure=1e-5 * dragged["reduced_pressure"])
    assert r"$p^*$ = $5 \times 10^{-7}$" in plot_contact(light).get_suptitle()
