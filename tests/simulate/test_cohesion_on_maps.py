"""Scenes of maps under the law of gap and slip: from a file with a way to slide to fields, energy and a picture."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.analysis.plots.contact import plot_contact
from gfmd_numba.scene import InputError

COHESIVE = {"work_of_adhesion": "50 mJ/m^2", "normal_length": 2e-7, "tangential_length": 3e-7}


def scene(path=(), **changes):
    whole = {
        "dimension": 2,
        "length": 1e-4,
        "body": {"youngs_modulus": 1e9, "poissons_ratio": 0.3, "aspect_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}, "cohesive": COHESIVE},
        "loading": {"reduced_pressure": 0.1},
    }
    return {
        "scene": whole | changes,
        "discretisation": {"eps_c": 0.25, "eps_f": 0.25, "eps_t": 0.5},
        "path": list(path),
    }


def drag(steps, way=(4e-8, 2e-8)):
    return [{"sliding": way[0] * i / steps, "sliding_y": way[1] * i / steps} for i in range(1, steps + 1)]


@pytest.fixture(scope="module")
def dragged():
    return gfmd_numba.solve(scene(drag(4)))


def test_the_tractions_of_a_dragged_map_are_those_of_the_law(dragged):
    """In SI units, from the fields of the dataset alone."""
    work, normal, tangential = 0.05, 2e-7, 3e-7
    assert (dragged["status"] == 0).all()
    slips = [dragged[f"sliding{end}"] - dragged[f"tangential_displacement{end}"] for end in ("", "_y")]
    g = dragged["gap"] / normal
    peak = float(dragged["pressure"].max())
    decay = work * np.exp(-g - (slips[0] ** 2 + slips[1] ** 2) / tangential**2)
    for end, slip in zip(("", "_y"), slips, strict=True):
        found = dragged[f"tangential_traction{end}"]
        assert found.attrs["units"] == "Pa"
        expected = (2.0 * slip / tangential**2 * (1.0 + g) * decay).transpose(*found.dims)
        np.testing.assert_allclose(found, expected, atol=1e-7 * peak)
        assert (found[-1].mean() > 100.0 * abs(found[0].mean())).item()
    open_gap = (dragged["gap"] > 0.0).values
    attraction = -(g / normal * decay).transpose(*dragged["pressure"].dims).values
    np.testing.assert_allclose(dragged["pressure"].values[open_gap], attraction[open_gap], atol=1e-7 * peak)
    assert "slip" not in dragged  # which is of touching nodes that rub


@pytest.mark.long
def test_the_work_of_a_drag_is_the_energy_it_stores(dragged):
    """What the trapezoidal work of steps seems to lose falls with the square of the step."""
    halved = gfmd_numba.solve(scene(drag(8)))
    seems_lost, less = (abs(float(each["energy_lost"].sum())) for each in (dragged, halved))
    work = float(dragged["mean_tangential_traction"][-1]) * 4e-8 / 2.0
    assert seems_lost < 2e-3 * work
    assert less == pytest.approx(seems_lost / 4.0, rel=0.05)


@pytest.mark.long
def test_a_path_with_displacement_control_and_an_incompressible_slab_is_solved():
    body = {"youngs_modulus": 1e9, "poissons_ratio": 0.5, "aspect_ratio": 0.3}
    steps = [{"displacement": 3e-8}, {"sliding_y": 3e-8}, {"displacement": -1e-8}]
    result = gfmd_numba.solve(scene(steps, body=body, loading={"displacement": 2e-8}))
    assert (result["status"] == 0).all()
    np.testing.assert_allclose(result["displacement"].mean(("y", "x")), 0.0, atol=1e-14)
    assert (np.diff(result["mean_pressure"])[[0, 2]] * [1, -1] > 0.0).all()


@pytest.mark.long
def test_a_campaign_of_maps_drags_a_cohesive_contact(tmp_path):
    file = {
        "name": "cohesion-on-maps",
        "seed": 1,
        "realisations": 1,
        "scene": scene()["scene"],
        "path": [*drag(1), {"sliding": 0.0, "sliding_y": 0.0}],
        "grid": {"aspect_ratio": [0.2, 0.4]},
        "reference": {"eps_c": 0.5, "eps_f": 0.25, "eps_t": 0.5},
    }
    result = gfmd_numba.run(file, tmp_path / "out")
    assert (result["status"] == 0).all()
    along, across = result["mean_tangential_traction"], result["mean_tangential_traction_y"]
    np.testing.assert_allclose(across[..., 1] / along[..., 1], 0.5, atol=0.02)
    assert (along[0, :, 1] > along[1, :, 1]).all()  # the thinner slab is the stiffer spring
    np.testing.assert_allclose(along[..., 2], along[..., 0], atol=1e-6 * float(along.max()))
    work = abs(along[..., 1]) * 4e-8
    assert (abs(result["hysteresis"]) < 1e-6 * work).all()


@pytest.mark.long
def test_a_cohesive_map_is_drawn(dragged):
    figure = plot_contact(dragged)
    texts = [text.get_text() for axis in figure.axes for text in (axis.xaxis.label, axis.yaxis.label)]
    assert any("Tangential traction" in text for text in texts)
    figure.draw_without_rendering()


def test_a_law_too_short_for_the_grid_of_a_map_is_refused():
    short = {"hard_wall": {}, "cohesive": COHESIVE | {"normal_length": 5e-10}}
    with pytest.raises(InputError, match=r"interface\.cohesive\.normal_length.*Take .* points both ways|eps_c = 1/"):
        gfmd_numba.solve(scene(interface=short))


@pytest.mark.parametrize(
    "more", [{"friction": {"coefficient": 0.3}}, {"exponential": {"work_of_adhesion": 1e-3, "range": 1e-7}}]
)
def test_one_law_of_both_tractions_acts_alone(more):
    with pytest.raises(InputError, match="one law of normal and tangential tractions"):
        gfmd_numba.solve(scene(interface={"hard_wall": {}, "cohesive": COHESIVE, **more}))
