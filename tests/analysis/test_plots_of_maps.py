"""Pictures of the contacts of maps: what is drawn, and that nothing is told where nothing is known."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.analysis import plot_contact
from support.solved_maps import paraboloid, pressed


@pytest.fixture(scope="module")
def solved():
    return gfmd_numba.solve(
        {
            "dimension": 2,
            "length": 1e-4,
            "body": {"youngs_modulus": 70e9, "poissons_ratio": 0.33},
            "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
            "interface": {"hard_wall": {}},
            "loading": {"reduced_pressure": 0.05},
            "discretisation": {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1 / 2},
        }
    )


@pytest.fixture(scope="module")
def drawn(solved):
    return plot_contact(solved)


@pytest.fixture
def rough(solved):
    return solved.copy(deep=True)


def panels(figure):
    """Axes of the picture by what they or their colour bars say."""
    images = [axis for axis in figure.axes if axis.images]
    return [axis.images[0] for axis in images], [axis for axis in figure.axes if axis.get_ylabel() == "Density"]


@pytest.mark.long
def test_heights_pressure_and_gap_are_drawn_in_their_units(rough, tmp_path):
    figure = plot_contact(rough)
    (heights, pressure, gap), _ = panels(figure)
    np.testing.assert_allclose(heights.get_array() / 1e9, rough["height"])
    labels = [image.colorbar.ax.get_xlabel() for image in (heights, pressure, gap)]
    assert labels == ["Height of the punch (nm)", "Pressure $p$ (GPa)", "Gap (nm), contact in orange"]
    figure.savefig(tmp_path / "map.png", dpi=40)


@pytest.mark.parametrize("dimension", [1, pytest.param(2, marks=pytest.mark.long)])
def test_surfaces_that_attract_each_other_apart_are_drawn(dimension):
    found = gfmd_numba.solve(
        {
            "dimension": dimension,
            "body": {"poissons_ratio": 0.3, "aspect_ratio": 1},
            "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
            "interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": 1e-6, "range": 5e-4}},
            "loading": {"displacement": -1e-3},
            "discretisation": {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1 / 2},
        }
    )
    assert found["pressure"].max() < 0.0 < found["gap"].min()
    plot_contact(found)
    statistics = gfmd_numba.contact_statistics(found)
    assert float(statistics["pressure_density"].sum()) == 0.0
    assert float(statistics["gap_density"].sum() * statistics["gap"].diff("gap")[0]) == pytest.approx(1.0)


@pytest.mark.long
def test_a_contact_under_a_displacement_is_not_called_a_step(rough):
    held = rough.drop_vars("reduced_pressure")  # which a displacement leaves out
    (legend,) = plot_contact(held).legends
    assert [text.get_text() for text in legend.get_texts()] == ["Simulation", "Persson"]


@pytest.mark.parametrize("overlap", ["some nodes", pytest.param("all nodes", marks=pytest.mark.long)])
def test_surfaces_that_overlap_under_a_cohesive_law_are_counted_and_drawn(rough, overlap):
    shift = rough["gap"].mean() if overlap == "some nodes" else 2.0 * rough["gap"].max()
    apart = rough.assign(gap=(rough["gap"] - shift).assign_attrs(rough["gap"].attrs))
    statistics = gfmd_numba.contact_statistics(apart)
    assert float(statistics["gap_density"].sum() * statistics["gap"].diff("gap")[0]) == pytest.approx(1.0)
    plot_contact(apart)


def test_a_punch_that_is_drawn_off_has_no_contact_in_perssons_theory(rough):
    statistics = gfmd_numba.contact_statistics(rough.assign(mean_pressure=-rough["mean_pressure"]))
    assert float(statistics["contact_area_fraction_persson"]) == 0.0
    assert not statistics["pressure_density_persson"].any()


def test_touching_nodes_have_a_colour_that_no_gap_has(rough, drawn):
    gap = panels(drawn)[0][2]
    touching = rough["gap"].values == 0.0
    np.testing.assert_array_equal(np.ma.getmaskarray(gap.get_array()), touching)
    colours = gap.to_rgba(gap.get_array())
    assert len(np.unique(colours[touching], axis=0)) == 1
    nearest = abs(colours[~touching] - colours[touching][0]).max(axis=1).min()
    assert nearest > 0.2


def test_a_gap_a_hundredth_of_another_is_told_from_it(drawn):
    """Colours of a linear scale would differ by a hundredth."""
    gap = panels(drawn)[0][2]
    large = gap.norm.vmax
    one, other = gap.to_rgba(np.array([0.01 * large, 0.0101 * 0.01 * large]))
    assert abs(one - other).max() > 0.05


@pytest.mark.long
def test_pressure_has_an_outline_where_contacts_are_large_enough():
    large = pressed(paraboloid(96), 4.0 / 3.0 * (20 / 96) ** 3 / 100.0)
    small = pressed(paraboloid(96), 4.0 / 3.0 * (1 / 96) ** 3 / 100.0)
    outlined = [len(plot_contact(dataset).axes[1].collections) for dataset in (large, small)]
    assert outlined == [1, 0]


def test_the_distributions_of_a_run_that_is_not_ok_are_not_drawn(rough, drawn):
    assert len(panels(drawn)[1]) == 2
    images, densities = panels(plot_contact(rough.assign(status=((), 1))))
    assert len(images) == 3
    assert densities == []


@pytest.mark.long
@pytest.mark.parametrize("gap", [0.0, 1e-9])
def test_full_contact_and_no_contact_are_drawn(rough, gap):
    rough["gap"][:] = gap
    rough["pressure"][:] = 0.0
    figure = plot_contact(rough)
    (_, pressure, _), _ = panels(figure)
    assert (pressure.axes.get_title(), pressure.colorbar) == ("No pressure", None)
    figure.draw_without_rendering()
