"""Scenes of maps with friction: from a file with a way to slide to fields, units, a picture, and refusals."""

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.analysis.plots.contact import plot_contact
from gfmd_numba.scene import InputError, load_scene

FRICTION = 0.3


def scene(path, dimension=2, **changes):
    whole = {
        "dimension": dimension,
        "length": 1e-4,
        "body": {"youngs_modulus": 1e9, "poissons_ratio": 0.3, "aspect_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}, "friction": {"coefficient": FRICTION}},
        "loading": {"reduced_pressure": 0.1},
    }
    return {
        "scene": {name: value for name, value in (whole | changes).items() if value is not None},
        "discretisation": {"eps_c": 0.25, "eps_f": 0.25, "eps_t": 0.5},
        "path": path,
    }


@pytest.fixture(scope="module")
def dragged():
    return gfmd_numba.solve(scene([{"sliding": 1e-9}, {"sliding_y": 2e-9}, {"sliding": 3e-6, "sliding_y": "-4 µm"}]))


def test_a_map_is_dragged_in_any_direction(dragged):
    """What a step leaves out stays as it is; far drags slide at friction times pressure, against their way."""
    assert (dragged["status"] == 0).all()
    np.testing.assert_allclose(dragged["sliding"], [0.0, 1e-9, 1e-9, 3e-6])
    np.testing.assert_allclose(dragged["sliding_y"], [0.0, 0.0, 2e-9, -4e-6])
    along = np.array([dragged[f"tangential_traction{end}"].mean(("y", "x")) for end in ("", "_y")])
    shear = along / (FRICTION * dragged["mean_pressure"].values)
    assert abs(shear[:, 0]).max() < 0.02
    assert shear[0, 1] > 0.01 > abs(shear[1, 1])
    assert shear[1, 2] > 0.01
    np.testing.assert_allclose(shear[:, 3], [0.6, -0.8], atol=0.01)
    last = dragged.isel(step=-1)
    size = np.hypot(last["tangential_traction"], last["tangential_traction_y"])
    touches = last["gap"].values == 0.0
    np.testing.assert_allclose(size.values[touches], FRICTION * last["pressure"].values[touches], rtol=1e-4)


def test_slip_tells_sticking_from_slipping_nodes(dragged):
    touches, slides = (dragged["gap"] == 0.0).values, (dragged["slip"] > 0.0).values
    assert not (slides & ~touches).any()
    traction = np.hypot(dragged["tangential_traction"], dragged["tangential_traction_y"]).values
    bound = FRICTION * dragged["pressure"].values
    peak = dragged["pressure"].values.max()
    assert (traction <= bound + 1e-6 * peak).all()
    np.testing.assert_allclose(traction[slides], bound[slides], atol=1e-6 * peak)
    assert (touches & ~slides)[1].sum() > 0.3 * touches[1].sum()
    assert slides[3].sum() == touches[3].sum()
    assert dragged["slip"].attrs["units"] == dragged["tangential_displacement_y"].attrs["units"] == "m"
    assert dragged["tangential_traction_y"].attrs["units"] == "Pa"


def test_the_elastic_energy_is_of_all_three_displacements(dragged):
    """By Clapeyron half of all tractions times displacements, without what the means of these take."""
    pairs = [("pressure", "displacement", -0.5)]
    pairs += [(f"tangential_traction{end}", f"tangential_displacement{end}", 0.5) for end in ("", "_y")]
    energy = 0.0
    for traction, displacement, sign in pairs:
        u = dragged[displacement] - dragged[displacement].mean(("y", "x"))
        energy = energy + sign * (dragged[traction] * u).mean(("y", "x"))
    np.testing.assert_allclose(dragged["elastic_energy"], energy, rtol=1e-9)


@pytest.mark.long
def test_friction_on_a_map_is_drawn(dragged):
    figure = plot_contact(dragged)
    labels = [axis.get_xlabel() or axis.get_ylabel() for axis in figure.axes]
    assert sum("Position" in label for label in labels) == 6
    texts = [text.get_text() for axis in figure.axes for text in (axis.xaxis.label, axis.yaxis.label)]
    assert any("Tangential traction" in text for text in texts)
    assert any("Slip" in text for text in texts)
    nothing = dragged.isel(step=[0]).copy(deep=True)  # a map where nothing slips and nothing pulls
    nothing["slip"] = xr.zeros_like(nothing["slip"])
    for end in ("", "_y"):
        nothing[f"tangential_traction{end}"] = xr.zeros_like(nothing["slip"])
    plot_contact(nothing).draw_without_rendering()


def test_without_friction_a_map_has_no_tangential_fields():
    result = gfmd_numba.solve(scene([], interface={"hard_wall": {}}))
    assert not [name for name in result.variables if "tangential" in name or name in ("slip", "sliding", "sliding_y")]


@pytest.mark.long
def test_a_half_space_and_displacement_control_know_friction_on_maps():
    friction = {"hard_wall": {}, "friction": {"coefficient": 0.4}}
    pressed = gfmd_numba.solve(
        scene([{"reduced_pressure": 0.05}], interface=friction, body={"youngs_modulus": 1e9, "poissons_ratio": 0.2})
    )
    assert (pressed["status"] == 0).all()
    shear = np.hypot(pressed["tangential_traction"], pressed["tangential_traction_y"])
    assert float(shear.max()) > 0.01 * float(pressed["peak_pressure"].max())
    assert abs(float(pressed["tangential_traction"].mean())) < 1e-6 * float(pressed["mean_pressure"][0])
    lowered = gfmd_numba.solve(
        scene([{"displacement": 2e-8}, {"sliding_y": 1e-9}], loading={"displacement": 3e-8}, interface=friction)
    )
    assert (lowered["status"] == 0).all()


def test_an_incompressible_half_space_needs_no_friction():
    body = {"youngs_modulus": 1e9, "poissons_ratio": 0.5}
    result = gfmd_numba.solve(scene([], body=body))
    assert "no tangential displacement" in result.attrs["dropped_effects"]
    assert "tangential_traction" not in result


@pytest.mark.long
def test_a_campaign_of_maps_varies_friction(tmp_path):
    file = {
        "name": "friction-on-maps",
        "seed": 1,
        "realisations": 1,
        "scene": scene([])["scene"],
        "grid": {"friction_coefficient": [0.1, 0.5]},
        "reference": {"eps_c": 0.5, "eps_f": 0.25, "eps_t": 0.5},
    }
    result = gfmd_numba.run(file, tmp_path / "out")
    assert (result["status"] == 0).all()
    energy = result["elastic_energy"].values
    assert (energy[0] != energy[1]).all()


@pytest.mark.parametrize(
    ("path", "changes", "said"),
    [
        ([{"sliding_y": 1e-9}], {"dimension": 1}, "nothing with dimension 1; sliding_y needs dimension 2"),
        ([{"sliding_y": 1e-9}], {"interface": {"hard_wall": {}}}, "nothing without friction, a cohesive law or wear"),
        (
            [{"sliding_y": 1e-9}],
            {"body": {"youngs_modulus": 1e9, "poissons_ratio": 0.3}},
            "nothing without a finite aspect_ratio",
        ),
        ([{"sliding_y": "1 MPa"}], {}, "sliding_y"),
        ([{"sliding_y": float("nan")}], {}, "sliding_y"),
    ],
)
def test_what_cannot_be_dragged_along_y_is_refused(path, changes, said):
    with pytest.raises(InputError) as error:
        gfmd_numba.solve(scene(path, **changes))
    assert "path[0].sliding_y" in str(error.value)
    assert said in str(error.value)


def test_a_map_too_large_for_friction_is_refused(monkeypatch):
    """Its tangential displacements take eleven times the memory of a frictionless map."""
    memory = type("Memory", (), {"total": 8e9, "available": 8e9})()
    monkeypatch.setattr("psutil.virtual_memory", lambda: memory)
    large = scene([]) | {"discretisation": {"eps_c": 0.25, "eps_f": 1 / 256, "eps_t": 0.5}}  # 4096^2 nodes
    with pytest.raises(InputError, match=r"a grid that fits in 8 GB of memory, where nx = 4096 needs 34.4 GB"):
        load_scene(large)
    large["scene"]["interface"] = {"hard_wall": {}}
    load_scene(large)
