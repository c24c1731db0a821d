"""Units of measured surfaces: none is invented, and none but m and L_x is taken for one of them."""

import numpy as np
import pytest
import xarray as xr

from gfmd_numba import make_surface, solve
from gfmd_numba.roughness.measured import measured_surface
from gfmd_numba.scene import InputError
from gfmd_numba.scene.measured_record import FileUnits, Measured
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
    assert float(found["x"][1]) == pytest.approx(1 / (64 if periodic == "mirror" else 32))


def test_heights_in_metres_without_a_unit_are_told_to_count_in_periods(tmp_path):
    in_metres = 1e-3 * HEIGHTS
    np.save(tmp_path / "p.npy", in_metres)
    for source in ({"file": str(tmp_path / "p.npy")}, {"heights": in_metres}):
        record = Measured(method="measured", **source)
        (said,) = measured_surface(record, None).doubts
        assert "heights without a unit count in periods: if they are in m, write units: {z: m} and the length" in said
        assert measured_surface(record, None).found.startswith("found 32 heights in L_x")
        assert measured_surface(record.model_copy(update={"units": FileUnits(z="L_x")}), None).doubts == ()


def test_heights_with_a_length_need_a_unit(tmp_path):
    np.savetxt(tmp_path / "p.csv", HEIGHTS)
    surface = {"method": "measured", "file": str(tmp_path / "p.csv"), "periodic": "mirror"}
    with pytest.raises(InputError, match=r"heights without a unit, but a length in m: write units: \{z: um\}"):
        make_surface({"surface": surface, "length": 1e-3})
    with pytest.warns(UserWarning, match="below 0.0002, is smoother than polished glass"):
        found = make_surface({"surface": surface | {"units": {"z": "mm"}, "spacing": 1 / 64}})
    assert found["rms_height"].units == found["x"].units == "m"
    assert float(found["x"][1]) == pytest.approx(1 / 64)
    np.testing.assert_allclose(found["height"][:32], 1e-3 * HEIGHTS, rtol=1e-15)


def test_a_field_of_one_metre_is_in_metres(tmp_path):
    np.savetxt(tmp_path / "p.csv", np.column_stack([X / 32, HEIGHTS]), delimiter=",", header="x [m], z [m]")
    assert made(tmp_path / "p.csv")["height"].units == "m"


@pytest.mark.parametrize(
    ("header", "said"),
    [
        ("", "positions along x and heights without a unit: write units: {x: mm, z: um}"),
        ("x, z", "positions along x and heights without a unit"),
        ("x, z [um]", "positions along x without a unit: write units: {x: mm}"),
        ("x [s], z [um]", "positions along x in 's', which is no unit of length: write units: {x: mm}, with theirs"),
        ("x [L_x], z [um]", "some of positions along x and heights in L_x, not all"),
    ],
)
def test_two_columns_of_unknown_units_are_refused(tmp_path, header, said):
    columns = np.column_stack([X, HEIGHTS])
    np.savetxt(tmp_path / "p.csv", columns, delimiter=",", header=header, encoding="utf-8")
    assert said in complaint(tmp_path, make_surface, "surface: {method: measured, file: p.csv}\n")


def test_a_file_without_a_method_is_told_what_to_add(tmp_path):
    said = "surface.method: you gave nothing; gfmd needs 'measured' for the heights of a file: add `method: measured`"
    assert said in complaint(tmp_path, make_surface, "surface: {file: p.csv}\n")


def test_the_unit_of_a_header_counts_for_one_column_too(tmp_path):
    np.savetxt(tmp_path / "p.csv", HEIGHTS, header="by hand (A. Name)\nz [nm]")
    record = Measured(method="measured", file=str(tmp_path / "p.csv"))
    found = measured_surface(record, 1e-3)
    np.testing.assert_allclose(found.heights, 1e-9 * HEIGHTS, rtol=1e-15)
    assert (found.lengths, found.unit) == ((1e-3,), "m")
    with pytest.raises(ValueError, match=r"heights in nm as the file says, not um as units\.z does"):
        measured_surface(record.model_copy(update={"units": FileUnits(z="um")}), 1e-3)
    with pytest.raises(InputError, match="heights without positions: give spacing"):
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
        (None, None, "positions along x and heights without a unit"),
        ("volt", "mm", "heights in 'volt', which is no unit of length"),
        ("m", "1", "some of positions along x and heights in L_x, not all"),
    ],
)
def test_netcdf_of_unknown_units_is_refused(tmp_path, units, x_units, said):
    with pytest.raises(InputError, match=said):
        made(netcdf(tmp_path, units, x_units))


@pytest.mark.long
def test_netcdf_is_in_the_units_it_states(tmp_path):
    assert made(netcdf(tmp_path, "m", "m"))["x"].units == "m"
    with pytest.warns(UserWarning, match="below 0.0002, is smoother than polished glass"):
        assert made(netcdf(tmp_path, "um", "mm"))["x"].units == "m"
    with pytest.raises(InputError, match="positions over a period of 4, one spacing for each of the 32 points, not 1"):
        made(netcdf(tmp_path, "1", "1"))
    with pytest.raises(InputError, match="heights without positions: give spacing"):
        made(netcdf(tmp_path, "m", None, positions=False))
    file = {"surface": {"method": "measured", "file": str(netcdf(tmp_path, "1", None, positions=False))}}
    with pytest.raises(InputError, match="heights in units of the period, so that length has to be left out"):
        make_surface(file | {"length": 1e-3})


@pytest.mark.parametrize("periodic", ["none", "mirror", "window"])
def test_a_written_surface_in_units_of_its_period_is_read_again(tmp_path, periodic):
    np.savetxt(tmp_path / "p.csv", HEIGHTS)
    first = made(tmp_path / "p.csv", periodic=periodic)
    first.to_netcdf(tmp_path / "s.nc", engine="netcdf4")
    again = measured_surface(Measured(method="measured", file=str(tmp_path / "s.nc")), None)
    np.testing.assert_allclose(again.in_periods, first["height"], rtol=1e-14)
    assert (again.lengths, again.unit) == (pytest.approx((1.0,)), "1")


def test_moduli_in_pascal_do_not_go_with_heights_without_a_unit(tmp_path):
    np.save(tmp_path / "p.npy", HEIGHTS)
    rough = {"method": "measured", "file": str(tmp_path / "p.npy")}
    wall = {"interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.1}}
    soft, stiff = {"poissons_ratio": 0.3}, {"poissons_ratio": 0.3, "youngs_modulus": 1e9}
    assert int(solve({**wall, "body": soft, "roughness": rough})["status"]) == 0
    for scene in ({"body": stiff, "roughness": rough}, {"body": stiff | {"roughness": rough}}):
        with pytest.raises(InputError, match=r"heights without a unit, but moduli in Pa: write units: \{z: um\}"):
            solve({**wall, **scene})
    in_periods = solve({**wall, "body": stiff, "roughness": rough | {"units": {"z": "L_x"}}})
    np.testing.assert_allclose(in_periods["height"], HEIGHTS, rtol=1e-12)
    in_mm = {"body": stiff, "roughness": rough | {"units": {"z": "mm"}, "detrend": "mean"}, "length": 1e-3}
    found = solve({**wall, **in_mm})
    np.testing.assert_allclose(found["height"], 1e-3 * (HEIGHTS - HEIGHTS.mean()), atol=1e-18)
    first, second, *_ = found.attrs["processing"].splitlines()
    assert first == "found 32 heights in mm, 31.25 µm apart, over 1 mm"  # so that a reader sees what was understood
    assert second == "subtracted the mean"


@pytest.mark.parametrize("periodic", ["none", "mirror"])
def test_a_spacing_tells_the_period_of_heights_without_positions(periodic):
    heights = np.random.default_rng(0).normal(size=(12, 12))
    found, twice = (2.0 if periodic == "mirror" else 1.0), {"units": {"z": "nm"}, "periodic": periodic}
    surface = {"method": "measured", "heights": heights, "spacing": "1.5 um", **twice}
    made = make_surface({"surface": surface})
    assert float(made["x"][1]) == pytest.approx(1.5e-6)
    assert made.sizes["x"] == 12 * found
    assert float(abs(made["height"]).max()) == pytest.approx(1e-9 * abs(heights - heights.mean()).max(), rel=0.5)


def test_a_spacing_next_to_positions_is_refused(tmp_path):
    np.savetxt(tmp_path / "p.csv", np.column_stack([np.arange(20.0), np.arange(20.0) % 3]), header="x [um] z [um]")
    surface = {"method": "measured", "file": str(tmp_path / "p.csv"), "spacing": "1 um"}
    with pytest.raises(InputError, match="spacing has to be left out"):
        make_surface({"surface": surface})


@pytest.mark.parametrize("header", ["Messung 7;;\nNr.;Weg [mm];Höhe [mil]", "Nr.;Weg [mm];Höhe [mil];Zeit [s]"])
def test_columns_of_other_languages_are_known_by_their_units_of_length(tmp_path, header):
    others = header.count(";", header.rfind("\n") + 1) - 2
    rows = [f"{i};{i / 100};{z}" + ";7" * others for i, z in enumerate(HEIGHTS)]
    (tmp_path / "p.csv").write_text("\n".join([header, *rows]).replace(".", ","), encoding="latin-1")
    found = made(tmp_path / "p.csv", units=None)
    assert float(found["x"][1]) == pytest.approx(1e-5)
    np.testing.assert_allclose(found["height"], 2.54e-5 * HEIGHTS, atol=1e-12)


def test_a_column_without_a_unit_that_is_named_is_not_left_out(tmp_path):
    (tmp_path / "p.csv").write_text("x [mm],y [mm],z\n" + "".join(f"{i},{i},{z}\n" for i, z in enumerate(HEIGHTS)))
    with pytest.raises(InputError, match="which are no grid"):
        made(tmp_path / "p.csv")


def test_a_spacing_or_a_length_that_contradicts_the_header_is_refused(tmp_path):
    rows = "\n".join(" ".join(map(str, row)) for row in np.random.default_rng(1).normal(size=(20, 20)))
    for name, header in (("pixel.txt", "pixel size 0.5 um"), ("width.txt", "# Width: 10 um\n# Height: 10 um")):
        path = tmp_path / name
        path.write_text(f"{header}\nz unit: nm\n{rows}\n")
        told = made(path)
        assert float(told["x"][1]) == pytest.approx(0.5e-6)
        assert "took 0.5 um from the header as the distance of neighbouring points" in told.attrs["processing"]
        assert float(made(path, spacing=0.504e-6)["x"][1]) == pytest.approx(0.504e-6)  # rounded
        with pytest.raises(InputError, match=r"0.5 um apart along y in the header of the file, not 0.51 um: leave"):
            made(path, spacing=0.51e-6)
        surface = {"method": "measured", "file": str(path)}
        near = make_surface({"surface": surface, "length": 10.05e-6})
        assert float(near["x"][1]) == pytest.approx(10.05e-6 / 20)
        with pytest.raises(InputError, match=r"a period of 1e-05 m, .*, not length = 1.02e-05 m"):
            make_surface({"surface": surface, "length": 10.2e-6})


def test_a_profile_takes_the_distance_of_its_points_from_the_header(tmp_path):
    for name, text in (("p.txt", "spacing: 2 um\nz unit: um\n"), ("w.txt", "width: 2 um\nz unit: um\n")):
        (tmp_path / name).write_text(text + "\n".join(map(str, HEIGHTS)))
    assert float(made(tmp_path / "p.txt")["x"][1]) == pytest.approx(2e-6)
    with pytest.raises(InputError, match="heights without positions"):
        made(tmp_path / "w.txt")
