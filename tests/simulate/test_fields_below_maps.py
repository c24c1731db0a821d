"""Fields in the body below a solved map: sections and planes, as datasets, pictures and on the command line."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.analysis import UnusableDataError, plot_body
from gfmd_numba.cli.contacts import largest_stress, place
from gfmd_numba.roughness.statistics import rms_gradient
from gfmd_numba.scene import InputError
from support.command_line import gfmd
from support.legible import faults

ROUGH = {
    "dimension": 2,
    "body": {"poissons_ratio": 0.33, "aspect_ratio": 0.5},
    "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
    "interface": {"hard_wall": {}},
    "loading": {"reduced_pressure": 0.05},
}
EPS = {"eps_c": 1 / 2, "eps_f": 1 / 4, "eps_t": 1 / 2}  # 32 x 32


def scene(**changes):
    return {"scene": ROUGH | changes, "discretisation": EPS}


@pytest.fixture(scope="module")
def contact():
    return gfmd_numba.solve(scene())


RUBBING = {"interface": {"hard_wall": {}, "friction": {"coefficient": 0.3}}}
LAYERS = {
    "layers": [
        {"height": 0.05, "youngs_modulus": 5.0, "poissons_ratio": 0.3},
        {"height": 0.2, "youngs_modulus": 1.0, "poissons_ratio": 0.45},
    ],
    "base": "rigid",
}


@pytest.mark.parametrize(
    "changes",
    [RUBBING, {"body": {"poissons_ratio": 0.5}}, RUBBING | {"body": LAYERS}],
    ids=["friction", "incompressible half-space", "layers with friction"],
)
def test_tractions_and_displacements_are_those_of_the_surface_and_the_base_is_held(changes):
    contact = gfmd_numba.solve(scene(**changes))
    base = -0.25 if changes.get("body") is LAYERS else -0.5
    y = contact.y[19].item()
    fields = gfmd_numba.body_fields(contact, [0.0, base], y=y)
    assert fields.y == y
    line, peak = contact.sel(y=y), contact.pressure.max().item()
    none = xr.zeros_like(line.pressure)
    np.testing.assert_allclose(fields.stress_3[0], -line.pressure, atol=1e-12 * peak)
    np.testing.assert_allclose(fields.stress_5[0], line.get("tangential_traction", none), atol=1e-12 * peak)
    np.testing.assert_allclose(fields.stress_4[0], line.get("tangential_traction_y", none), atol=1e-12 * peak)
    largest = abs(contact.displacement).max().item()
    np.testing.assert_allclose(fields.displacement_3[0], line.displacement, atol=1e-6 * largest)
    if "tangential_displacement" in contact:
        for i, name in ((1, "tangential_displacement"), (2, "tangential_displacement_y")):
            np.testing.assert_allclose(fields[f"displacement_{i}"][0], line[name], atol=1e-6 * largest)
    if "aspect_ratio" in changes.get("body", ROUGH["body"]):
        assert max(abs(fields[f"displacement_{i}"][1]).max() for i in (1, 2, 3)) < 1e-12 * largest


def test_a_ridge_has_the_fields_of_its_profile():
    x = np.arange(64) / 64
    heights = 0.01 * np.cos(2 * np.pi * x) + 0.001 * np.cos(10 * np.pi * x)
    profile, ridge = (
        gfmd_numba.body_fields(
            gfmd_numba.solve({"scene": scene(dimension=given.ndim)["scene"] | {"roughness": None}}, heights=given),
            [0.0, -0.01, -0.1],
        )
        for given in (heights, np.tile(heights, (64, 1)))
    )
    for name in ("displacement_1", "displacement_3", "strain_5", "stress_1", "stress_2", "stress_3", "von_mises"):
        largest = abs(profile[name]).max()
        np.testing.assert_allclose(ridge[name], profile[name], atol=1e-10 * largest, err_msg=name)


def test_a_pressed_paraboloid_has_the_largest_stress_of_hertz_below_its_centre():
    """Johnson 1985, (3.45): for nu = 0.3 the largest shear, half of von Mises's stress, is 0.31 p0 at 0.48 a."""
    n, radius = 128, 10.0
    x = np.arange(n) / n - 0.5
    heights = -(x**2 + x[:, np.newaxis] ** 2) / (2 * radius)
    force = 4.0 / 3.0 * 0.12**3 / radius
    press = {"dimension": 2, "body": {"poissons_ratio": 0.3}, "interface": {"hard_wall": {}}}
    reduced = force / rms_gradient(heights, (1.0, 1.0))
    contact = gfmd_numba.solve({"scene": press | {"loading": {"reduced_pressure": reduced}}}, heights=heights)
    a, p0 = 0.12, 2.0 * 0.12 / (np.pi * radius)
    fields = gfmd_numba.body_fields(contact, -a * np.linspace(0.3, 0.9, 25))
    deepest = int(fields.peak_von_mises.values.argmax())
    assert float(fields.peak_von_mises[deepest]) / p0 == pytest.approx(0.62, rel=0.02)
    assert -float(fields.z[deepest]) / a == pytest.approx(0.48, abs=0.04)
    assert float(fields.peak_x[deepest]) == pytest.approx(0.5, abs=1.5 / n)
    assert float(fields.y) == pytest.approx(0.5, abs=1.5 / n)  # the section through it
    assert float(fields.von_mises.max()) == pytest.approx(float(fields.peak_von_mises.max()), rel=1e-9)


def test_planes_hold_what_sections_cut_from_them(contact):
    z = [-0.01, -0.2]
    planes = gfmd_numba.body_fields(contact, planes=z)
    assert planes.von_mises.dims == ("z", "y", "x")
    for cut in ("x", "y"):
        section = gfmd_numba.body_fields(contact, z, **{cut: 0.25})
        assert section[cut] == 0.25
        for name in ("displacement_2", "strain_6", "stress_4", "von_mises"):
            xr.testing.assert_allclose(section[name], planes[name].sel({cut: 0.25}), atol=1e-12, rtol=1e-9)
    np.testing.assert_allclose(planes.peak_von_mises[0], planes.von_mises[0].max(), rtol=1e-9)
    at = planes.von_mises[0].sel(x=planes.peak_x[0], y=planes.peak_y[0], method="nearest")
    np.testing.assert_allclose(at, planes.peak_von_mises[0], rtol=1e-9)


@pytest.mark.long
def test_every_step_of_a_path_has_its_fields_on_one_section():
    contact = gfmd_numba.solve(
        scene(**RUBBING) | {"path": [{"sliding": 2e-5, "sliding_y": 1e-5}, {"sliding": 0.0, "sliding_y": 1e-5}]}
    )
    fields = gfmd_numba.body_fields(contact, [0.0, -0.1])
    assert fields.stress_4.dims == ("step", "z", "x")
    assert fields.y.dims == ()
    line = contact.tangential_traction_y.sel(y=fields.y)
    np.testing.assert_allclose(fields.stress_4[:, 0], line, atol=1e-12 * abs(line).max())


def test_a_rough_body_has_labels_and_what_formed_it():
    body = ROUGH["body"] | {"roughness": ROUGH["roughness"]}
    rough = gfmd_numba.solve(scene(body=body, roughness=None))
    fields = gfmd_numba.body_fields(rough, [0.0, -0.5], x=0.5)
    height = rough.body_height.sel(x=0.5)
    np.testing.assert_allclose(fields.formed_3[0], height, atol=1e-12 * abs(height).max())
    assert abs(fields.formed_1[0]).max() + abs(fields.formed_3[1]).max() < 1e-12 * abs(height).max()
    np.testing.assert_allclose(fields.stress_3[0], -rough.pressure.sel(x=0.5), atol=1e-12)


def test_units_are_those_of_the_contact(contact):
    si = {"youngs_modulus": 70e9, "poissons_ratio": 0.33, "aspect_ratio": 0.5}
    in_si = gfmd_numba.body_fields(gfmd_numba.solve(scene(body=si, length=1e-4)), [-1e-6], y=2e-5)
    bare = gfmd_numba.body_fields(contact, [-1e-2], y=0.2)
    assert in_si.z.units == in_si.y.units == in_si.displacement_2.units == in_si.peak_x.units == "m"
    assert in_si.stress_4.units == in_si.peak_von_mises.units == "Pa"
    assert {bare[name].attrs["units"] for name in bare.variables} == {"1"}
    np.testing.assert_allclose(in_si.von_mises, 70e9 / (1 - 0.33**2) * bare.von_mises, rtol=1e-8)
    np.testing.assert_allclose(in_si.peak_y, 1e-4 * bare.peak_y)


@pytest.mark.filterwarnings("ignore:steps_used_up:UserWarning")
def test_a_run_that_failed_has_no_fields():
    contact = gfmd_numba.solve(scene() | {"numerics": {"solver": "conjugate_gradients", "max_iterations": 1}})
    fields = gfmd_numba.body_fields(contact, [-0.1])
    assert np.isnan(fields.von_mises).all()
    assert np.isnan(fields.peak_von_mises).all()
    with pytest.raises(UnusableDataError, match="a run that is not ok"):
        plot_body(fields)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"x": 1.5}, "x: you gave 1.5; gfmd allows a number from 0 to 1, in L_x"),
        ({"y": "middle"}, "y: you gave 'middle'; gfmd allows a number from 0 to 1"),
        ({"y": float("nan")}, "y: you gave nan; gfmd allows a number"),
        ({"x": 0.1, "y": 0.1}, "y: you gave 0.1 in addition to x; gfmd allows one section"),
        ({"x": 0.1, "planes": [-0.1]}, "x: you gave 0.1 in addition to planes; gfmd allows one section"),
        ({"z": [-0.1], "planes": [-0.1]}, "planes: you gave .* in addition to z; gfmd allows either"),
        ({"planes": [-0.6]}, "planes: you gave -0.6; gfmd allows one row of heights"),
        ({"planes": []}, "planes: you gave an array of shape"),
        (
            {"planes": -np.linspace(0, 0.5, 10**6)},
            "planes: you gave 1000000 heights; gfmd allows fewer, or a grid that fits in",
        ),
    ],
)
def test_sections_that_cannot_be_are_refused(contact, asked, message):
    with pytest.raises(InputError, match=f"^{message}"):
        gfmd_numba.body_fields(contact, **asked)


@pytest.mark.parametrize(
    ("total", "asked", "message"),
    [
        (2e5, {}, "contact: you gave 32 x 32 nodes; gfmd allows a grid that fits in .* where a section below it needs"),
        (
            5e5,
            {"planes": [0.0, -0.1]},
            "planes: you gave 2 heights; gfmd allows fewer, or a grid .* this stack of planes needs",
        ),
    ],
)
def test_fields_beyond_the_memory_are_refused_by_what_was_asked(contact, monkeypatch, total, asked, message):
    monkeypatch.setattr("psutil.virtual_memory", lambda: SimpleNamespace(total=total))
    with pytest.raises(InputError, match=f"^{message}"):
        gfmd_numba.body_fields(contact, **asked)


@pytest.mark.parametrize("dim", ["x", "y"])
def test_a_map_that_is_not_a_whole_period_any_more_has_no_fields(contact, dim):
    for cut in (contact.isel({dim: slice(0, 20)}), contact.roll({dim: 5}, roll_coords=True)):
        with pytest.raises(InputError, match=r"^contact: you gave .*nodes .*; gfmd allows all nodes of the period"):
            gfmd_numba.body_fields(cut)
    with pytest.raises(InputError, match="contact: you gave a contact that was altered"):
        gfmd_numba.body_fields(contact.isel({dim: 3}))


@pytest.mark.long
@pytest.mark.parametrize(
    ("options", "dims"),
    [(("--x", "0.25"), ("z", "y")), (("--plane", "-0.01", "--plane", "-0.1"), ("z", "y", "x"))],
)
def test_sections_and_planes_on_the_command_line(contact, tmp_path, options, dims):
    contact.to_netcdf(tmp_path / "contact.nc")
    output = tmp_path / "fields.nc"
    said = gfmd("fields", tmp_path / "contact.nc", "-o", output, *options)
    assert said.exit_code == 0, said.output
    assert "von Mises stress" in said.output
    with xr.open_dataset(output) as fields:
        assert fields.von_mises.dims == dims
        assert faults(plot_body(fields)) == []
    assert output.with_suffix(".png").stat().st_size > 10_000


@pytest.mark.long
def test_places_on_the_command_line_that_are_none_are_refused(contact, tmp_path):
    contact.to_netcdf(tmp_path / "contact.nc")
    for options, message in (
        (("--y", "5um"), "--y: you gave '5um'; gfmd allows a number in L_x"),
        (("--y", "deep"), "--y: you gave 'deep'; gfmd allows a number in L_x"),
        (("--x", "1.5"), "--x: you gave 1.5; gfmd allows a number from 0 to 1, in L_x"),
        (("--plane", "nan"), "--plane: you gave 'nan'; gfmd allows a number in L_x"),
        (
            ("--plane", "0.1"),
            "--plane: you gave 0.1; gfmd allows one row of heights from -0.5 (the base) to 0 (the surface)",
        ),
        (("--body", "punch"), "--body: you gave 'punch'; gfmd allows 'body'"),
    ):
        said = gfmd("fields", tmp_path / "contact.nc", "-o", tmp_path / "none.nc", *options)
        assert said.exit_code == 2
        assert f"gfmd: {message}" in said.output


@pytest.mark.long
def test_a_file_that_is_no_contact_is_named_and_not_doubted_for_its_length(contact, tmp_path):
    gfmd_numba.body_fields(contact, [-0.1]).to_netcdf(tmp_path / "fields.nc")
    contact.drop_vars(["x", "pressure"]).to_netcdf(tmp_path / "other.nc")
    for name, at in (("fields.nc", "0.3"), ("other.nc", "3um")):
        said = gfmd("fields", tmp_path / name, "-o", tmp_path / "none.nc", "--x", at)
        assert f"gfmd: {tmp_path / name}: you gave no results of a contact" in said.output


def test_the_largest_stress_of_a_path_is_said_to_be_that_of_its_last_step(contact):
    fields = gfmd_numba.body_fields(contact.expand_dims(step=2), [-0.1])
    assert largest_stress(fields).startswith("von Mises stress of these depths, in the last step, ")
    assert "step" not in largest_stress(fields.isel(step=-1))


def test_places_have_units_where_the_scene_has_a_length():
    contact = xr.Dataset(coords={"x": ("x", [0.0, 1e-6], {"units": "m"})})
    assert place(contact, "plane", "-5um") == -5e-6
    for other in ("5MPa", "5e-6", "5"):
        with pytest.raises(InputError, match=f"--x: you gave '{other}'; gfmd allows a length with its unit, like 5um"):
            place(contact, "x", other)
