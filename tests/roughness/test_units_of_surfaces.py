"""Units of measured surfaces: none is invented, and none but m and L_x is taken for one of them."""

import numpy as np
import pytest
import xarray as xr

from gfmd_numba import make_surface
from gfmd_numba.roughness.measured import read_profile
from gfmd_numba.scene import InputError
from support.faulty_files import complaint

HEIGHTS = 1e-3 * np.random.default_rng(0).normal(size=32)
X = np.arange(32.0)


def made(path, **more):
    return make_surface({"surface": {"method": "measured", "file": str(path), "detrend": "none", **more}})


@pytest.mark.parametrize("periodic", ["none", "mirror", "window"])
@pytest.mark.parametrize("name", ["p.csv", "p.npy"])
def test_heights_without_a_length_are_in_units_of_the_field(tmp_path, name, periodic):
    np.save(tmp_path / "p.npy", HEIGHTS)
    np.savetxt(tmp_path / "p.csv", HEIGHTS)
    found = made(tmp_path / name, periodic=periodic)
    lengths = [found[each].units for each in ("x", "height", "rms_height", "distance", "wavenumber")]
    assert lengths == ["1"] * 5
    assert float(found["x"][1]) == pytest.approx(1 / 32)


def test_heights_with_a_length_are_in_metres(tmp_path):
    np.savetxt(tmp_path / "p.csv", HEIGHTS)
    file = {"surface": {"method": "measured", "file": str(tmp_path / "p.csv"), "periodic": "mirror"}, "length": 1.0}
    found = make_surface(file)
    assert found["rms_height"].units == found["x"].units == "m"
    assert float(found["x"][1]) == pytest.approx(1 / 32)


def test_a_field_of_one_metre_is_in_metres(tmp_path):
    np.savetxt(tmp_path / "p.csv", np.column_stack([X / 32, HEIGHTS]), delimiter=",", header="x [m], z [m]")
    assert made(tmp_path / "p.csv")["height"].units == "m"


@pytest.mark.parametrize(
    ("header", "said"),
    [
        ("", "two columns without a unit: begin the file with the line `# x [m], height [m]`"),
        ("x, z", "two columns without a unit"),
        ("x [mm], z [um]", "numbers in units 'mm', 'um', not all in m: convert them first"),
        ("x (m), z (µm)", "numbers in units 'm', 'µm', not all in m"),
    ],
)
def test_two_columns_that_are_not_said_to_be_in_metres_are_refused(tmp_path, header, said):
    columns = np.column_stack([X, HEIGHTS])
    np.savetxt(tmp_path / "p.csv", columns, delimiter=",", header=header, encoding="utf-8")
    assert said in complaint(tmp_path, make_surface, "surface: {method: measured, file: p.csv}\n")


def test_a_header_in_another_unit_is_refused_for_one_column_too(tmp_path):
    np.savetxt(tmp_path / "p.csv", HEIGHTS, header="by hand (A. Name)\nz [nm]")
    with pytest.raises(InputError, match="numbers in units 'nm', not all in m"):
        make_surface({"surface": {"method": "measured", "file": str(tmp_path / "p.csv")}, "length": 1e-3})
    with pytest.raises(ValueError, match="heights in units 'nm', not in m, as the scene's length"):
        read_profile(tmp_path / "p.csv", 1e-3)
    np.savetxt(tmp_path / "p.csv", HEIGHTS, header="z [m]")
    np.testing.assert_allclose(read_profile(tmp_path / "p.csv", 1e-3), HEIGHTS)
    with pytest.raises(ValueError, match="heights in units 'm', not in 1, as the scene has no length"):
        read_profile(tmp_path / "p.csv")
    with pytest.raises(InputError, match="heights in m without positions, so that length is needed"):
        made(tmp_path / "p.csv")


def netcdf(folder, units, x_units, positions=True):
    dataset = xr.Dataset({"height": ("x", HEIGHTS, {"units": units} if units else {})})
    if positions:
        dataset = dataset.assign_coords(x=("x", X / 8, {"units": x_units} if x_units else {}))
    dataset.to_netcdf(folder / "p.nc", engine="netcdf4")
    return folder / "p.nc"


@pytest.mark.parametrize(
    ("units", "x_units", "said"),
    [
        (None, None, "positions and heights without units: give both the attribute units, m or 1"),
        ("um", "mm", "numbers in units 'um', 'mm', not all in m"),
        ("m", "1", "numbers in units 'm', '1', not all in m"),
    ],
)
def test_netcdf_of_unknown_units_is_refused(tmp_path, units, x_units, said):
    with pytest.raises(InputError, match=said):
        made(netcdf(tmp_path, units, x_units))


def test_netcdf_is_in_the_units_it_states(tmp_path):
    assert made(netcdf(tmp_path, "m", "m"))["x"].units == "m"
    assert made(netcdf(tmp_path, "1", "1"))["x"].units == "1"
    with pytest.raises(InputError, match="heights in m without positions, so that length is needed"):
        made(netcdf(tmp_path, "m", None, positions=False))
    file = {"surface": {"method": "measured", "file": str(netcdf(tmp_path, "1", None, positions=False))}}
    with pytest.raises(InputError, match="heights in units of the period, so that length has to be left out"):
        make_surface(file | {"length": 1e-3})


def test_a_mirrored_field_in_units_of_its_half_is_no_period_of_a_scene(tmp_path):
    np.savetxt(tmp_path / "p.csv", HEIGHTS)
    made(tmp_path / "p.csv", periodic="mirror").to_netcdf(tmp_path / "s.nc", engine="netcdf4")
    with pytest.raises(ValueError, match="x over 2, not over 1, the period"):
        read_profile(tmp_path / "s.nc")
