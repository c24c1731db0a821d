"""Files as instruments and their software write them: what they hold, or what to do with them."""

import re
import time

import numpy as np
import pytest
import xarray as xr

from gfmd_numba import make_surface
from gfmd_numba.roughness.measured import measured_field
from gfmd_numba.roughness.measurements import measurement
from gfmd_numba.roughness.surface_files import read_content, read_values
from gfmd_numba.roughness.surface_text import read_table
from gfmd_numba.scene import InputError
from gfmd_numba.scene.measured_record import Measured

PICK = np.random.default_rng(0)
Z = PICK.normal(size=64)
MAP = PICK.normal(size=(6, 8))
FILE = "z [um]\n" + "\n".join(map(str, Z))


def field(path, **more):
    return measured_field(Measured(method="measured", file=str(path), **more)).found


@pytest.mark.parametrize("encoding", ["utf-8", "latin-1", "utf-16"])
@pytest.mark.parametrize("name", ["p.tsv", "p.prn", "p.asc", "p.xyz", "P.CSV", "profil", "p.dat", "p.2024"])
def test_text_is_read_whatever_its_name(tmp_path, name, encoding):
    (tmp_path / name).write_text(FILE.replace("um", "µm"), encoding=encoding)
    found = read_content(tmp_path / name)
    np.testing.assert_array_equal(found.heights, [Z])
    assert found.units == {"z": "um"}


@pytest.mark.parametrize("name", ["p.zip", "p.csv.gz", "p.xlsx", "p.png", "p.TIF", "p.npz", "p.pdf"])
def test_what_holds_no_surface_is_to_be_exported(tmp_path, name):
    (tmp_path / name).write_bytes(b"PK\x03\x04\x14\0\x08\0")
    suffix = (tmp_path / name).suffix.lower()
    with pytest.raises(ValueError, match=rf"a {suffix} file, which gfmd does not open: export the heights as text"):
        read_content(tmp_path / name)


@pytest.mark.parametrize("name", ["profil", "p.opd"])
def test_a_binary_file_needs_the_reader_of_instruments(tmp_path, name):
    (tmp_path / name).write_bytes(b"\x01\0\x02\xff" * 100)
    with pytest.raises(ValueError, match="SurfaceTopography") as caught:
        read_content(tmp_path / name)
    assert "  " not in str(caught.value)


COLUMN = "\n".join(str(1.5 + i % 7) for i in range(48)) + "\n"


@pytest.mark.parametrize(
    "header",
    [
        "\\Samps/line: 8\n\\Lines: 6\nHeight(nm)\n",
        "points 8 lines 6\nz [nm]\n",
        "ncols 8\nnrows 6\nz [nm]\n",
        "NumPoints = 8\nNumProfiles = 6\nz [nm]\n",
        "Auflösung: 8 x 6 Pixel\nz [nm]\n",
        "Spalten;8\nZeilen;6\nAnzahl Punkte;48\nz [nm]\n",
    ],
)
def test_a_map_in_one_column_is_no_profile(tmp_path, header):
    (tmp_path / "m.txt").write_text(header + COLUMN)
    with pytest.raises(
        ValueError, match=r"48 heights in one column under a header that says '.*', so that they may be"
    ):
        read_content(tmp_path / "m.txt")


def test_a_square_map_in_one_column_is_known_by_one_side(tmp_path):
    rows = "\n".join(str(0.5 + i % 5) for i in range(49))
    (tmp_path / "m.txt").write_text(f"Samps/line: 7\nz [nm]\n{rows}\n")
    with pytest.raises(ValueError, match="'Samps/line: 7', so that they may be a map: write it as rows of heights, or"):
        read_content(tmp_path / "m.txt")
    for header in (
        "Points: 49\nAveraged samples: 7\n",
        "Taster 7\n",
        "Scan size: 7 um\n",
        "Resolution: 7 bit\n",
        "12.07.2024\n",
    ):
        (tmp_path / "m.txt").write_text(f"{header}z [nm]\n{rows}\n")
        assert read_content(tmp_path / "m.txt").heights.shape == (1, 49)


def test_heights_without_positions_are_called_what_they_are_taken_for(tmp_path):
    for name, heights, said in (("p.npy", Z, "a profile of 64 heights"), ("m.npy", MAP, "a map of 6 x 8 heights")):
        np.save(tmp_path / name, heights)
        surface = {"method": "measured", "file": str(tmp_path / name), "units": {"z": "um"}}
        with pytest.raises(InputError, match=f"{said} without positions: give spacing"):
            make_surface({"surface": surface})


@pytest.mark.parametrize("label", ["Nr", "No.", "Index", "Punkt", "Punkt Nr.", "Point", "Pixel", "N°", "Numéro"])
@pytest.mark.parametrize("first", [0, 1])
def test_a_column_that_counts_points_needs_a_spacing(tmp_path, label, first):
    rows = [f"{i + first};{z}" for i, z in enumerate(Z)]
    (tmp_path / "p.csv").write_text("\n".join([f"{label};z [um]", *rows]), encoding="utf-8")
    found = field(tmp_path / "p.csv", spacing=0.5e-6)
    np.testing.assert_allclose(found.heights, 1e-6 * Z)
    assert found.lengths == pytest.approx((32e-6,))
    assert "took whole numbers for numbers of points, as there is a spacing" in found.done
    with pytest.raises(
        ValueError, match=r"positions along x that are numbers of points: give spacing, .* or units: \{x"
    ):
        field(tmp_path / "p.csv")
    by_units = field(tmp_path / "p.csv", units={"x": "0.5 um"})
    np.testing.assert_array_equal(by_units.heights, found.heights)
    assert by_units.lengths == pytest.approx(found.lengths)


def test_whole_numbers_without_a_unit_may_count_points(tmp_path):
    counted = np.delete(np.arange(64), [3, 20])
    np.savetxt(tmp_path / "p.csv", np.column_stack([counted, Z[counted]]), delimiter=";", fmt="%.17g")
    with pytest.raises(
        ValueError, match=r"units: \{x: mm, z: um\}.*; if positions are numbers of points, give spacing"
    ):
        field(tmp_path / "p.csv")
    found = field(tmp_path / "p.csv", spacing=2e-6, units={"z": "um"})
    assert found.lengths == pytest.approx((128e-6,))
    np.testing.assert_allclose(found.heights[counted], 1e-6 * Z[counted])
    assert np.isnan(found.heights[[3, 20]]).all()
    y, x = np.indices(MAP.shape)
    np.savetxt(tmp_path / "m.xyz", np.column_stack([x.ravel(), y.ravel(), MAP.ravel()]), fmt="%.17g")
    found = field(tmp_path / "m.xyz", spacing=2e-6, units={"z": "um"})
    np.testing.assert_allclose(found.heights, 1e-6 * MAP)
    assert found.lengths == pytest.approx((12e-6, 16e-6))


@pytest.mark.parametrize(
    ("header", "x"),
    [("x [um];z [um]", np.arange(64)), ("x;z [um]", 2 * np.arange(64)), ("Nr;z [um]", 0.5 * np.arange(64))],
)
def test_a_spacing_next_to_positions_is_left_out(tmp_path, header, x):
    np.savetxt(tmp_path / "p.csv", np.column_stack([x, Z]), delimiter=";", header=header, comments="", fmt="%.17g")
    with pytest.raises(ValueError, match="spacing has to be left out"):
        field(tmp_path / "p.csv", spacing=1e-6)


def test_a_format_in_letters_of_instruments_is_theirs(tmp_path):
    (tmp_path / "m.sdf").write_text("aBCR-1.0\nNumPoints = 4\nXscale = 1e-6\n*\n1 2 3 4\n*\nend\n")
    with pytest.raises(ValueError, match="SurfaceTopography"):
        read_content(tmp_path / "m.sdf")


def test_a_header_of_many_digits_is_read_in_time(tmp_path):
    (tmp_path / "p.txt").write_text("# " + 5000 * "1" + "\n" + FILE)
    begin = time.process_time()
    assert read_content(tmp_path / "p.txt").heights.size == Z.size
    assert time.process_time() - begin < 5.0


@pytest.mark.parametrize(
    "line",
    [
        "dx = 0.5 um",
        "Δx: 0,5 µm",
        "delta x (um): 0.5",
        "Step size: 0.5 um",
        "XINC=0.0005 mm",
        "X increment: 0.5 um",
        "Messpunktabstand: 0,5 µm",
        "Abtastintervall 0.5 µm",
        "Pixelgröße: 0,5 µm",
        "Schrittweite in µm: 0,5",
        "Pas d'échantillonnage : 0,5 µm",
        "Paso de muestreo: 0,5 µm",
        "Tamaño de píxel: 0,5 µm",
        "Passo di campionamento: 0,5 µm",
    ],
)
def test_the_distance_of_points_is_known_in_the_words_of_five_languages(tmp_path, line):
    (tmp_path / "p.txt").write_text(f"# {line}\n" + FILE, encoding="utf-8")
    assert field(tmp_path / "p.txt").lengths == pytest.approx((32e-6,))


@pytest.mark.parametrize(
    "header",
    [
        "Channel: Topography\nWidth: 4.00 µm\nHeight: 3.00 µm\nValue units: nm",
        "Kanal: Topografie\nBreite: 4,00 µm\nHöhe: 3,00 µm\nWerteinheiten: nm",
        "Canal : Topographie\nLargeur : 4,00 µm\nHauteur : 3,00 µm\nUnités des valeurs : nm",
        "Canal: Topografía\nAnchura: 4,00 µm\nAltura: 3,00 µm\nUnidades de valor: nm",
        "Canale: Topografia\nLarghezza: 4,00 µm\nAltezza: 3,00 µm\nUnità del valore: nm",
        "Breite: 4 µm\nHöhe: 3 µm\nZ-Einheit: nm",
    ],
)
@pytest.mark.parametrize("encoding", ["utf-8", "latin-1"])
def test_sizes_and_units_of_maps_are_known_in_five_languages(tmp_path, header, encoding):
    rows = "\n".join("\t".join(map(str, row)) for row in MAP)
    commented = "".join(f"# {line}\n" for line in header.split("\n"))
    (tmp_path / "m.txt").write_text(commented + rows, encoding=encoding)
    found = field(tmp_path / "m.txt")
    np.testing.assert_allclose(found.heights, 1e-9 * MAP)
    assert found.lengths == pytest.approx((3e-6, 4e-6))


@pytest.mark.parametrize(
    "line",
    [
        "Amplitudeneinheit: m",
        "Cutoff 0.8 mm",
        "Resolution X: 0.5 um",
        "Taststrecke: 0,256 mm",
        "Bredde: 32.00 µm",
        "1.3 um/pixel",
        "lateral (um)",
        "cellsize 1e-6",
        "dx = 0.5",
    ],
)
def test_a_header_with_a_length_asks_for_the_unit_of_heights(tmp_path, line):
    for name, rows in (("p.txt", COLUMN), ("m.txt", "\n".join(" ".join(map(str, row)) for row in MAP))):
        (tmp_path / name).write_text(f"# {line}\n{rows}", encoding="utf-8")
        with pytest.raises(ValueError, match=r"heights without a unit under a header that says '.*': write units: \{z"):
            field(tmp_path / name)
        assert field(tmp_path / name, units={"z": "L_x"}).unit == "1"


@pytest.mark.parametrize("line", ["Speed 0.5 mm/s", "Made in Kiel", "Anna, M", "Sample 7, 3.5", "x-y-z"])
def test_a_header_without_a_length_asks_nothing(tmp_path, line):
    (tmp_path / "p.txt").write_text(f"# {line}\n{COLUMN}")
    assert field(tmp_path / "p.txt").unit is None


def test_a_word_between_a_name_and_its_number_makes_it_another_quantity(tmp_path):
    for line in ("Spacing error 3 um", "Step height: 0.5 um", "Width offset 2 um"):
        (tmp_path / "p.txt").write_text(f"{line}\n{FILE}")
        assert read_table(tmp_path / "p.txt").sizes == {}


def test_arrays_of_the_wrong_shape_are_told_what_fits(tmp_path):
    np.save(tmp_path / "p.npy", np.zeros((2, 8, 8)))
    xr.DataArray(np.zeros((2, 8, 8)), dims=("a", "b", "c"), name="height").to_netcdf(tmp_path / "p.nc")
    for name in ("p.npy", "p.nc"):
        with pytest.raises(ValueError, match=r"an array of shape \(2, 8, 8\) and type float64, not a row or a table"):
            field(tmp_path / name, spacing=1e-6, units={"z": "um"})
    for columns in (2, 3):
        np.save(tmp_path / "p.npy", np.zeros((512, columns)))
        with pytest.raises(ValueError, match=rf"512 x {columns} heights, not at least 4 x 4; columns of .* as text"):
            field(tmp_path / "p.npy", spacing=1e-6, units={"z": "um"})


@pytest.mark.parametrize("shape", [(0,), (0, 5), (5, 0)])
def test_an_array_without_heights_is_told_so(tmp_path, shape):
    np.save(tmp_path / "p.npy", np.zeros(shape))
    with pytest.raises(ValueError, match=rf"{re.escape(str(shape))} and type float64, not a row or a table of numbers"):
        field(tmp_path / "p.npy", spacing=1e-6, units={"z": "um"})


@pytest.mark.parametrize("across", ["x", "y"])
def test_a_map_of_one_row_or_column_is_a_profile(tmp_path, across):
    along = {"x": "y", "y": "x"}[across]
    positions = {along: (along, 0.5 * np.arange(64), {"units": "um"}), across: (across, [3.0], {"units": "um"})}
    line = xr.DataArray(Z, {along: positions[along]}, (along,), "height", {"units": "nm"})
    line.expand_dims(across).assign_coords(positions).to_netcdf(tmp_path / "p.nc")
    found = field(tmp_path / "p.nc")
    np.testing.assert_array_equal(found.heights, 1e-9 * Z)
    assert found.lengths == pytest.approx((32e-6,))


@pytest.mark.parametrize("heights", [Z, Z[np.newaxis]])
def test_a_profile_is_not_asked_about_the_other_axis_of_a_header(tmp_path, heights):
    np.savetxt(tmp_path / "p.txt", heights, header="dx = 0.6 um\ndy = 0.9 um")
    found = field(tmp_path / "p.txt", spacing=0.6e-6, units={"z": "um"})
    assert found.lengths == pytest.approx((38.4e-6,))
    for more in ({}, {"spacing": 0.6e-6}):
        with pytest.raises(ValueError, match=r"no positions along y in the file, so that units\.y has to be left out"):
            field(tmp_path / "p.txt", units={"y": "um", "z": "um"}, **more)
    with pytest.raises(ValueError, match=r"points 0\.6 um apart along x in the header of the file, not 0\.5 um"):
        field(tmp_path / "p.txt", spacing=0.5e-6, units={"z": "um"})


def test_positions_of_a_map_may_be_variables_along_its_rows_and_columns(tmp_path):
    positions = {axis: (dim, 0.5 * np.arange(8), {"units": "um"}) for axis, dim in (("y", "row"), ("x", "column"))}
    heights = (("row", "column"), Z.reshape(8, 8), {"units": "nm"})
    xr.Dataset({"height": heights, **positions}).to_netcdf(tmp_path / "m.nc")
    assert field(tmp_path / "m.nc").lengths == pytest.approx((4e-6, 4e-6))


@pytest.mark.parametrize("along", ["x", "y"])
def test_a_line_along_an_axis_keeps_the_units_of_its_own_axis(tmp_path, along):
    still = np.zeros_like(Z)
    moving = 0.5 * np.arange(64)
    columns = [moving, still, Z] if along == "x" else [still, moving, Z]
    np.savetxt(tmp_path / "p.csv", np.column_stack(columns), delimiter=";", fmt="%.17g")
    units = {"x": "um", "y": "um", "z": "nm"}
    found = field(tmp_path / "p.csv", units=units)
    np.testing.assert_allclose(found.heights, 1e-9 * Z)
    assert found.lengths == pytest.approx((32e-6,))
    assert field(tmp_path / "p.csv", units={along: "um", "z": "nm"}).lengths == pytest.approx((32e-6,))
    header = {"x": "x [um];y [mm];z [nm]", "y": "x [mm];y [um];z [nm]"}[along]
    np.savetxt(tmp_path / "p.csv", np.column_stack(columns), delimiter=";", header=header, fmt="%.17g", comments="")
    assert measurement(read_content(tmp_path / "p.csv")).lengths == pytest.approx((32e-6,))


@pytest.mark.parametrize(
    ("line", "mark"),
    [
        ("NODATA_value -9999", "-9999.0"),
        ("# nodata = -3.4028235e+38", "-3.40282346638529e+38"),
        ("Missing data value: 1e10", "10000000000"),
        ("No data: 0", "0"),
        ("_FillValue\t-32768", "-32768"),
        ("Fehlender Wert;-99,5", "-99.5"),
        ("Ungültiger Wert = 9999 nm", "9999"),
    ],
)
def test_what_a_header_says_to_mark_missing_heights_does(tmp_path, line, mark):
    profile, map_ = f"{line}\n1\n{mark}\n3\n", f"{line}\n5 2 7 4 3\n2 {mark} 4 5 1\n8 4 1 1 6\n"
    for text, place in ((profile, 1), (map_, 6)):
        (tmp_path / "m.asc").write_text(text, encoding="utf-8")
        found = read_content(tmp_path / "m.asc")
        assert np.flatnonzero(np.isnan(found.heights)).tolist() == [place]
        assert found.done == (f"took {float(mark):g} for a missing height, as the header says",)


@pytest.mark.parametrize("line", ["Missing points: 2", "Bad pixels 2", "Points 2", "value: 2"])
def test_what_a_header_counts_marks_no_missing_heights(tmp_path, line):
    (tmp_path / "m.txt").write_text(f"{line}\nz [um]\n1\n2\n3\n4\n")
    assert not np.isnan(read_content(tmp_path / "m.txt").heights).any()


def test_tractions_marked_as_missing_are_not_prescribed(tmp_path):
    (tmp_path / "t.csv").write_text("NODATA_value -9999\n1\n-9999\n2\n3\n")
    np.testing.assert_array_equal(read_values(tmp_path / "t.csv", 1), [1, np.nan, 2, 3])


@pytest.mark.parametrize("attribute", ["_FillValue", "missing_value"])
def test_the_mark_of_a_netcdf_variable_or_an_array_is_a_missing_height(tmp_path, attribute):
    array = xr.DataArray(np.array([1.0, -9999.0, 2.0, 3.0]), dims="x", name="height", attrs={attribute: -9999.0})
    record = Measured(method="measured", heights=array)
    np.testing.assert_array_equal(measured_field(record).found.heights, [1, np.nan, 2, 3])
    array.to_netcdf(tmp_path / "m.nc", engine="netcdf4")
    np.testing.assert_array_equal(read_content(tmp_path / "m.nc").heights, [1, np.nan, 2, 3])


@pytest.mark.parametrize("mark", ["OVER", "over", "nan(ind)", "-nan(ind)", "No Data", "NoData", "NO_DATA", "masked"])
@pytest.mark.parametrize("separator", [" ", ",", ";", "\t"])
def test_marks_of_instruments_are_missing_heights(tmp_path, mark, separator):
    rows = [["0", "0", mark], ["1", "0", "2.5"], ["0", "1", "3.5"], ["1", "1", mark]]
    (tmp_path / "m.xyz").write_text("".join(separator.join(row) + "\n" for row in rows))
    np.testing.assert_array_equal(read_table(tmp_path / "m.xyz").values[:, 2], [np.nan, 2.5, 3.5, np.nan])


@pytest.mark.parametrize("dims", [("x",), ("y", "x")])
def test_depths_of_netcdf_and_xarray_are_turned_upside_down_where_they_say_so(tmp_path, dims):
    depths = xr.DataArray(np.random.default_rng(0).normal(size=(8,) * len(dims)), dims=dims)
    for attributes, sign in (({}, 1.0), ({"positive": "up"}, 1.0), ({"positive": "down"}, -1.0)):
        given = depths.assign_attrs(units="um", **attributes)
        given.to_dataset(name="height").to_netcdf(tmp_path / "p.nc")
        np.testing.assert_array_equal(read_content(tmp_path / "p.nc").heights, sign * depths.values)
        np.testing.assert_array_equal(Measured(method="measured", heights=given).heights.values, sign * depths.values)
        assert Measured(method="measured", heights=given).heights.units == {"z": "um"}
    depths.to_dataset(name="depth").to_netcdf(tmp_path / "p.nc")
    with pytest.raises(ValueError, match="which may grow downwards"):
        read_content(tmp_path / "p.nc")
