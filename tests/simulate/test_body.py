"""Fields in the body of a solved contact, as datasets, pictures and on the command line."""

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

import gfmd_numba
from gfmd_numba.analysis import UnusableDataError, plot_body
from gfmd_numba.cli import main
from gfmd_numba.elasticity.fields import von_mises
from gfmd_numba.scene import InputError
from gfmd_numba.theory import closed_forms

ROUGH = {
    "body": {"poissons_ratio": 0.33, "aspect_ratio": 0.5},
    "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
    "interface": {"hard_wall": {}},
    "loading": {"reduced_pressure": 0.02},
}
RUBS = {"friction": {"coefficient": 0.3}}
FILE = {"scene": ROUGH, "discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1 / 2}}


def scene(**changes):
    return FILE | {"scene": ROUGH | changes}


@pytest.mark.parametrize(
    ("aspect_ratio", "laws", "nu"),
    [(0.1, {}, 0.5), (0.5, RUBS, 0.33), (0.1, RUBS, 0.5), (np.inf, {}, 0.5), (np.inf, RUBS, 0.33)],
)
def test_tractions_are_those_of_the_surface_and_the_base_is_held(aspect_ratio, laws, nu):
    body = {"poissons_ratio": nu, "aspect_ratio": aspect_ratio}
    contact = gfmd_numba.solve(scene(body=body, interface={"hard_wall": {}} | laws))
    base = -1.0 if np.isinf(aspect_ratio) else -aspect_ratio
    fields = gfmd_numba.body_fields(contact, [0.0, base])
    peak = contact.pressure.max().item()
    np.testing.assert_allclose(fields.stress_3[0], -contact.pressure, atol=3e-8 * peak)
    shear = contact.get("tangential_traction", xr.zeros_like(contact.pressure))
    np.testing.assert_allclose(fields.stress_5[0], shear, atol=3e-8 * peak)
    # of the pressure the fields follow exactly, of the displacement to the residual
    np.testing.assert_allclose(
        fields.displacement_3[0], contact.displacement, atol=1e-7 * abs(contact.displacement).max()
    )
    np.testing.assert_allclose(fields.stress_3.mean("x"), -contact.pressure.mean(), rtol=1e-9)
    if not np.isinf(aspect_ratio):
        largest = abs(fields.displacement_3).max()
        assert abs(fields.displacement_1[1]).max() < 1e-8 * largest  # the residual of the contact
        assert abs(fields.displacement_3[1]).max() < 1e-8 * largest


def test_stresses_below_a_wave_are_westergaards(tmp_path):
    """On the axis of symmetry Westergaard's stresses follow from his stress function (Johnson 1985, 13.2)."""
    nx, amplitude, load = 4096, 0.001, 0.3
    np.save(tmp_path / "wave.npy", amplitude * np.cos(2 * np.pi * (np.arange(nx) / nx - 0.5)))
    gradient = np.sqrt(2) * np.pi * amplitude
    loading = {"reduced_pressure": load * np.pi * amplitude / gradient}
    roughness = {"method": "measured", "file": str(tmp_path / "wave.npy")}
    body = {"poissons_ratio": 0.33}
    contact = gfmd_numba.solve({"scene": scene(body=body, roughness=roughness, loading=loading)["scene"]})
    depth = np.array([0.02, 0.1, 0.3])
    fields = gfmd_numba.body_fields(contact, -depth)
    # sigma_33 = -sum over the pressure's waves of p (1 + q d) exp(-q d) cos(qx), the exact pressure by quadrature
    x = (np.arange(2**16) + 0.5) / 2**16 - 0.5
    mean = load * np.pi * amplitude
    pressure = closed_forms.westergaard_pressure(x, mean, amplitude)
    q = 2 * np.pi * np.arange(1, 200)[:, np.newaxis]
    waves = 2 * (pressure * np.cos(q * x)).mean(axis=1)[:, np.newaxis]
    exact = -mean - (waves * (1 + q * depth) * np.exp(-q * depth)).sum(axis=0)
    np.testing.assert_allclose(fields.stress_3.isel(x=nx // 2), exact, rtol=2e-5)
    lateral = -mean * 0.33 / 0.67 - (waves * (1 - q * depth) * np.exp(-q * depth)).sum(axis=0)
    np.testing.assert_allclose(fields.stress_1.isel(x=nx // 2), lateral, rtol=1e-4)


def test_units_are_those_of_the_contact():
    si = {"youngs_modulus": 70e9, "poissons_ratio": 0.33, "aspect_ratio": 0.5}
    in_si = gfmd_numba.body_fields(gfmd_numba.solve(scene(body=si, length=1e-4)), [-1e-6, -5e-5])
    bare = gfmd_numba.body_fields(gfmd_numba.solve(scene()), [-1e-2, -0.5])
    assert in_si.z.units == in_si.x.units == in_si.displacement_3.units == "m"
    assert in_si.stress_1.units == in_si.von_mises.units == "Pa"
    assert {bare[name].units for name in bare.variables} == {"1"}
    modulus = 70e9 / (1 - 0.33**2)
    np.testing.assert_allclose(in_si.von_mises, modulus * bare.von_mises, rtol=1e-9)
    np.testing.assert_allclose(in_si.displacement_1, 1e-4 * bare.displacement_1, atol=1e-13 * 1e-4)
    np.testing.assert_allclose(in_si.strain_5, bare.strain_5, atol=1e-12)


def test_plane_stress_has_no_stress_out_of_the_plane():
    body = {"poissons_ratio": 0.5, "aspect_ratio": 0.5, "state": "plane_stress"}
    fields = gfmd_numba.body_fields(gfmd_numba.solve(scene(body=body)))
    assert not fields.stress_2.any()
    # E = 1 is the unit: Hooke's law of a sheet
    np.testing.assert_allclose(fields.strain_1, fields.stress_1 - 0.5 * fields.stress_3, atol=1e-14)
    np.testing.assert_allclose(
        fields.von_mises, von_mises(fields.stress_1, 0 * fields.stress_2, fields.stress_3, fields.stress_5)
    )


def test_every_step_of_a_path_has_its_fields():
    contact = gfmd_numba.solve(
        scene(loading={"displacement": 1e-4}) | {"path": [{"displacement": 2e-4}, {"displacement": 1e-4}]}
    )
    fields = gfmd_numba.body_fields(contact, [-0.01, -0.2])
    assert fields.stress_3.dims == ("step", "z", "x")
    np.testing.assert_array_equal(fields.punch_displacement, [1e-4, 2e-4, 1e-4])
    np.testing.assert_allclose(fields.stress_3[0], fields.stress_3[2], atol=1e-9)
    np.testing.assert_allclose(fields.stress_3.mean("x").isel(z=0), -contact.pressure.mean("x"))


@pytest.mark.filterwarnings("ignore:steps_used_up:UserWarning")
def test_a_run_that_failed_has_no_fields():
    contact = gfmd_numba.solve(scene() | {"numerics": {"max_iterations": 1}})
    fields = gfmd_numba.body_fields(contact)
    assert np.isnan(fields.von_mises).all()
    with pytest.raises(UnusableDataError, match="a run that is not ok"):
        plot_body(fields)


def test_a_body_that_is_just_touched_is_drawn():
    fields = gfmd_numba.body_fields(gfmd_numba.solve(scene(loading={"displacement": 0.0})))
    assert not fields.von_mises.any()
    plot_body(fields)


@pytest.mark.parametrize(
    ("z", "message"),
    [
        (
            [0.0, -0.6],
            "z: you gave -0.6; gfmd allows one row of heights from -0.5 (the base) to 0 (the surface), in L_x",
        ),
        (0.1, "z: you gave 0.1; gfmd allows"),
        ([np.nan], "z: you gave nan; gfmd allows"),
        ([[-0.1]], "z: you gave an array of shape (1, 1); gfmd allows"),
    ],
)
def test_z_outside_the_body_is_refused(z, message):
    contact = gfmd_numba.solve(scene())
    with pytest.raises(InputError) as caught:
        gfmd_numba.body_fields(contact, z)
    assert str(caught.value).startswith(message)


def test_what_is_no_contact_is_refused():
    with pytest.raises(
        InputError, match=r"contact: you gave no results of a contact; gfmd allows what `gfmd solve` leaves"
    ):
        gfmd_numba.body_fields(xr.Dataset())
    with pytest.raises(UnusableDataError, match="gfmd allows what `gfmd fields` leaves"):
        plot_body(gfmd_numba.solve(scene()))


CUTS = {
    "cropped": lambda contact: contact.isel(x=slice(0, 40)),
    "thinned": lambda contact: contact.isel(x=slice(None, None, 2)),
    "averaged": lambda contact: contact.coarsen(x=2).mean(keep_attrs=True),
    "uneven": lambda contact: contact.isel(x=np.delete(np.arange(contact.sizes["x"]), 7)),
    "refined": lambda contact: contact.interp(x=np.linspace(0, contact.x[-1].item(), 300)),
    "rolled": lambda contact: contact.roll(x=5, roll_coords=True),
    "in other units": lambda contact: contact.assign_coords(x=1e3 * contact.x),
}


@pytest.mark.parametrize("cut", CUTS)
@pytest.mark.parametrize("length", [None, 1e-4])
def test_a_contact_that_is_not_a_whole_period_any_more_has_no_fields(cut, length):
    body = ROUGH["body"] | ({"youngs_modulus": 70e9} if length else {})
    contact = gfmd_numba.solve(scene(body=body, **({"length": length} if length else {})))
    with xr.set_options(keep_attrs=True):
        altered = CUTS[cut](contact)
    with pytest.raises(InputError, match=r"^contact: you gave .*nodes .*; gfmd allows all nodes of the period"):
        gfmd_numba.body_fields(altered)


def test_a_shift_of_the_origin_and_single_precision_leave_a_period_whole():
    contact = gfmd_numba.solve(scene())
    fields = gfmd_numba.body_fields(contact, -0.1)
    with xr.set_options(keep_attrs=True):
        shifted = contact.assign_coords(x=contact.x - 0.5)
    for same in (shifted, contact.assign_coords(x=contact.x.astype(np.float32))):
        np.testing.assert_array_equal(gfmd_numba.body_fields(same, -0.1).stress_3, fields.stress_3)


def test_a_loaded_body_that_was_thinned_has_no_fields():
    body = {"poissons_ratio": 0.33, "aspect_ratio": 0.5}
    loaded = gfmd_numba.solve({"scene": {"body": body, "boundary": {"normal_traction": 1e-3}}, "points": 64})
    with pytest.raises(InputError, match="you gave 32 of the 64 nodes of its period"):
        gfmd_numba.body_fields(loaded.isel(x=slice(None, None, 2)))


@pytest.mark.long
@pytest.mark.usefixtures("undrawn")
def test_fields_on_the_command_line(tmp_path):
    gfmd_numba.solve(scene()).to_netcdf(tmp_path / "contact.nc")
    run = CliRunner().invoke(main, ["fields", str(tmp_path / "contact.nc"), "-o", str(tmp_path / "fields.nc")])
    assert run.exit_code == 0, run.output
    with xr.open_dataset(tmp_path / "fields.nc") as fields:
        assert fields.von_mises.dims == ("z", "x")
        assert fields.z[-1] == pytest.approx(-0.5)
    assert (tmp_path / "fields.png").exists()
    same = CliRunner().invoke(main, ["fields", str(tmp_path / "contact.nc"), "-o", str(tmp_path / "contact.nc")])
    assert same.exit_code == 2
    assert "which is an input" in same.output


def test_a_loaded_body_has_fields_too(tmp_path):
    x = np.arange(64) / 64
    np.savetxt(tmp_path / "wave.csv", 0.01 * np.cos(2 * np.pi * x))
    body = {"poissons_ratio": 0.33, "aspect_ratio": 0.5}
    boundary = {"tangential_traction": str(tmp_path / "wave.csv"), "normal_displacement": 1e-3}
    loaded = gfmd_numba.solve({"scene": {"body": body, "boundary": boundary}})
    fields = gfmd_numba.body_fields(loaded, [0.0, -0.5])
    np.testing.assert_allclose(fields.stress_5[0], loaded.tangential_traction, atol=1e-10)
    np.testing.assert_allclose(fields.stress_3[0], loaded.normal_traction, atol=1e-10)
    np.testing.assert_allclose(fields.displacement_3[0], 1e-3, atol=1e-10)
    np.testing.assert_allclose(fields.displacement_1[0], loaded.tangential_displacement, atol=1e-10)
    assert abs(fields.displacement_1[1]).max() + abs(fields.displacement_3[1]).max() < 1e-10
    plot_body(fields)


@pytest.mark.parametrize(("loading", "laws"), [({"reduced_pressure": 0.02}, RUBS), ({"displacement": 2e-4}, {})])
def test_tractions_under_a_punch_are_in_the_fields(tmp_path, loading, laws):
    x = np.arange(256) / 256
    np.savetxt(tmp_path / "wave.csv", 1e-3 * np.cos(2 * np.pi * x))
    boundary = {"tangential_traction": 1e-4, "normal_traction": str(tmp_path / "wave.csv")}
    contact = gfmd_numba.solve(scene(boundary=boundary, loading=loading, interface={"hard_wall": {}} | laws))
    fields = gfmd_numba.body_fields(contact, [0.0, -0.5])
    np.testing.assert_allclose(contact.prescribed_normal_traction, 1e-3 * np.cos(2 * np.pi * x), atol=1e-15)
    normal = contact.prescribed_normal_traction - contact.pressure
    along = 1e-4 + contact.get("tangential_traction", xr.zeros_like(contact.pressure))
    np.testing.assert_allclose(fields.stress_3[0], normal, atol=1e-15)
    np.testing.assert_allclose(fields.stress_5[0], along, atol=1e-15)
    np.testing.assert_allclose(fields.pressure, -normal, atol=1e-15)
    largest = abs(contact.displacement).max()  # to the residual of the contact
    np.testing.assert_allclose(fields.displacement_3[0], contact.displacement, atol=1e-7 * largest)
    if "tangential_displacement" in contact:
        np.testing.assert_allclose(fields.displacement_1[0], contact.tangential_displacement, atol=1e-6 * largest)
    assert abs(fields.displacement_3[1]).max() + abs(fields.displacement_1[1]).max() < 1e-7 * largest
    plot_body(fields)


def test_tractions_under_a_punch_that_were_removed_leave_no_fields():
    contact = gfmd_numba.solve(scene(boundary={"tangential_traction": 1e-4}))
    with pytest.raises(InputError, match="you gave a contact that was altered"):
        gfmd_numba.body_fields(contact.drop_vars("prescribed_normal_traction"))


@pytest.mark.parametrize("option", ["x", "y", "planes"])
def test_a_profile_has_no_other_section(option):
    with pytest.raises(InputError, match=f"{option}: you gave -?0.2; gfmd allows nothing for a profile"):
        gfmd_numba.body_fields(gfmd_numba.solve(scene()), **{option: 0.2 if option != "planes" else -0.2})
