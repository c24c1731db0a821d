"""Text files of surfaces: how their columns, decimals, headers and gaps are read."""

import os

import numpy as np
import pytest

from gfmd_numba.roughness.measurements import measurement
from gfmd_numba.roughness.surface_files import read_content, read_values
from gfmd_numba.roughness.surface_text import columns_of, read_table

X = 0.5 * np.arange(40)
Z = np.random.default_rng(0).normal(size=40)
MAP = np.random.default_rng(1).normal(size=(6, 9))
LAYOUTS = [(separator, ".") for separator in (",", ", ", ";", "; ", "\t", "   ")]
LAYOUTS += [(separator, ",") for separator in (";", "; ", "\t", "   ")]


def written(folder, rows, separator=",", decimal=".", header="", name="p.csv"):
    lines = [separator.join(f"{value:.17g}".replace(".", decimal) for value in row) for row in rows]
    (folder / name).write_text(header + "\n".join(lines) + "\n", encoding="utf-8")
    return folder / name


@pytest.mark.parametrize(
    ("name", "header"),
    [
        ("p.csv", ""),
        ("p.txt", "# made by hand, on Monday 3.5\n"),
        ("p.dat", "Sample 7\nx [mm]{0}z [um]\n"),
        ("p.csv", "\n%\n\n"),
    ],
)
@pytest.mark.parametrize(("separator", "decimal"), LAYOUTS)
def test_every_layout_gives_the_same_numbers_bit_by_bit(tmp_path, separator, decimal, header, name):
    columns = written(tmp_path, np.column_stack([X, Z]), separator, decimal, header.format(separator), name)
    np.testing.assert_array_equal(read_table(columns).values, np.column_stack([X, Z]))
    stated = ("mm", "um") if "mm" in header else (None, None)
    assert read_table(columns).units == stated
    rows = written(tmp_path, MAP, separator, decimal, "# z [nm]\n", name)
    assert read_table(rows).units == ("nm",)
    np.testing.assert_array_equal(read_table(rows).values, MAP)
    one = written(tmp_path, Z[:, None], separator, decimal, "z/µm\n", name)
    np.testing.assert_array_equal(read_table(one).values[:, 0], Z)
    assert read_table(one).units == ("um",)


@pytest.mark.parametrize(
    ("header", "units"),
    [
        ("x [mm], height (um)", ("mm", "um")),
        ("x/µm;z/nm", ("um", "nm")),
        ("position (Å)\theight [inch]", ("angstrom", "in")),
        ("# [m]", ("m", "m")),
        ("x [mm] z", ("mm", None)),
        ("x, z [μm]", (None, "um")),
        ("x, z", (None, None)),
        ("scan length (mm): 4\nx, z", (None, None)),
        ("resolution 12 px/mm", (None, None)),
        ("speed 3 [mm]", (None, None)),
        ("x [mm], z [um]\n# second line of a header", ("mm", "um")),
        ("x [px], z [V]", ("px", "V")),
    ],
)
def test_units_of_two_columns_in_a_header(tmp_path, header, units):
    rows = np.column_stack([X, Z])
    assert read_table(written(tmp_path, rows, header=header + "\n")).units == units


@pytest.mark.parametrize("mark", ["[DATA]", "[ Profile ]", "[Messwerte]"])
@pytest.mark.parametrize(
    ("entry", "unit"),
    [("Unit : um", "um"), ("Z unit = nm", "nm"), ("Einheit: µm", "um"), ("Operator: JK", None)],
)
def test_the_mark_of_a_section_is_no_unit(tmp_path, mark, entry, unit):
    file = written(tmp_path, Z[:, None], header=f"TESTER 5\nNumber of data : 40\n{entry}\n{mark}\n")
    assert read_table(file).units == (unit,)
    for other in ("[mV]", "[counts]", "[a.u.]", "[Volt]"):
        stated = read_table(written(tmp_path, Z[:, None], header=f"{entry}\n{other}\n")).units[0]
        assert stated == other.strip("[]") or stated in ("px", None)  # which is refused


@pytest.mark.parametrize(
    ("header", "units"),
    [
        ("Unit: mm\nx [mm],z [?m]", ("mm", "?m")),
        ("Unit: mm\nx [mm],z [V]", ("mm", "V")),
        ("Unit: mm\nx,z\nmm,V", ("mm", "V")),
        ("[X-Axis]\nUnit: mm\n[Z-Axis]\nUnit: um\n[Data]", (None, None)),
        ("[Filter]\nLambda c: 0.8\nUnit: mm\n[Data]", (None, None)),
        ("Unit: mm\nZ [um]", ("mm", "um")),
        ("Unit: mm\nZ (um)", ("mm", "um")),
        ("Unit: mm\nHeights in um", ("mm", "um")),
        ("Unit: mm\nz_um", ("mm", "um")),
        ("Units: mm, um", (None, None)),
        ("Units,mm,um", (None, None)),
        ("Einheiten: mm; µm", (None, None)),
        ("Unit: um (z), mm (x)", ("z", "x")),
        ("Unit: mm\nUnit: um", (None, None)),
        ("Z-Unit: um\nUnit: mm", ("mm", "um")),
        ("Unit: mm\nVertical units: um", (None, None)),
        ("Unité de la hauteur : µm\nUnit: mm", (None, None)),
        ("Einheit Messwerte: µm\nEinheit: mm", (None, None)),
        ("Unit: mm\nSpeed unit: mm/s", ("mm", "mm")),
        ("X unit: mm\nZ unit: um\n[Profile]", ("mm", "um")),
    ],
)
def test_no_general_unit_overrules_another(tmp_path, header, units):
    """What is unclear has no unit, or one that is none of length, and is refused where a length is needed."""
    assert read_table(written(tmp_path, np.column_stack([X, Z]), header=header + "\n")).units == units


@pytest.mark.parametrize(
    ("header", "units"),
    [
        ("z,x", (None, None)),
        ("z x", (None, None)),
        ("# Height; Position", (None, None)),
        ("z [um], x [mm]", ("mm", "um")),
        ("z/nm\tx/um", ("um", "nm")),
        ("height (um), lateral position (mm)", ("mm", "um")),
        ("z, x [mm]", ("mm", None)),
        ("z [um] x", (None, "um")),
        ('"y","x"', (None, None)),
        ("z, y", (None, None)),
        ("signal, distance", (None, None)),
        ("z_um,x_mm", ("mm", "um")),
        ("z, x\n# second line of a header", (None, None)),
    ],
)
def test_labels_tell_which_column_holds_the_heights(tmp_path, header, units):
    table = read_table(written(tmp_path, np.column_stack([Z, X]), header=header + "\n"))
    np.testing.assert_array_equal(table.values, np.column_stack([X, Z]))
    assert table.units == units
    said = "took the first of two columns for heights and the second for positions, as their labels say"
    assert table.done == (said,)


@pytest.mark.parametrize(
    "header", ["x,z", "x,y", "y,z", "x [mm], x [um]", "position height", "a,b", "z, z2", "x z\nz,"]
)
def test_columns_in_their_usual_order_stay(tmp_path, header):
    table = read_table(written(tmp_path, np.column_stack([X, Z]), header=header + "\n"))
    np.testing.assert_array_equal(table.values, np.column_stack([X, Z]))
    assert table.done == ()


@pytest.mark.parametrize(
    ("header", "unit"),
    [
        ("z [um]", "um"),
        ("Width (mm): 3\n# heights in (nm)", "nm"),
        ("width [mm] height [um]", "um"),
        ("x [mm] y [mm]", None),
    ],
)
def test_unit_of_a_map_in_a_header(tmp_path, header, unit):
    assert read_table(written(tmp_path, MAP, header=header + "\n")).units == (unit,)


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("z\n0,5\n1,5\n2,5\n", [[0.5], [1.5], [2.5]]),  # one name: one column
        ("x,z\n0,5\n1,5\n2,5\n", [[0, 5], [1, 5], [2, 5]]),  # two names
        ("0,5\n1,5\n2,5\n", [[0, 5], [1, 5], [2, 5]]),  # positions
        ("0,5\n0,7\n1,25\n", [[0.5], [0.7], [1.25]]),  # no position comes twice
        ("1,5\n-0,5\n3,5\n", [[1.5], [-0.5], [3.5]]),  # none is -0
        ("1e-3,2e-3\n2e-3,5\n", [[1e-3, 2e-3], [2e-3, 5]]),
        ("1,-2\n3,4\n", [[1, -2], [3, 4]]),
        ("1;2;\n3;4;\n", [[1, 2], [3, 4]]),  # a separator at the end of each row
        ('"1","2.5"\n"3","4"\n', [[1, 2.5], [3, 4]]),
        ("1 # first\n\n# a comment\n3\n\n\n", [[1], [np.nan], [3]]),
        ("1,nan\n2,\n3,Bad\n4,--\n5,1\n", [[1, np.nan], [2, np.nan], [3, np.nan], [4, np.nan], [5, 1]]),
        ("1\r\n2\r\n", [[1], [2]]),
        ("z\nnan\nNaN\n1\n", [[np.nan], [np.nan], [1]]),  # missing from the start
        ("x;z\n---\n1;2\n3;4\n", [[1, 2], [3, 4]]),
    ],
)
def test_small_tables(tmp_path, text, values):
    (tmp_path / "p.csv").write_bytes(text.encode())
    np.testing.assert_array_equal(read_table(tmp_path / "p.csv").values, values)


def test_a_micro_sign_in_one_byte(tmp_path):
    (tmp_path / "p.txt").write_bytes("z [µm]\n1\n2\n".encode("latin-1"))
    assert read_table(tmp_path / "p.txt").units == ("um",)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "no number"),
        (b"x,z\n", "no row of numbers, but 'x,z'"),
        (b"1,5\n3,5\n8,5\n", "rows like '1,5' that are one column with a decimal comma or two columns"),
        (b"1\n2\nthree\n4\n", "'three' in line 3, not a number"),
        (b"# a\nz\n1\n# b\n2\n1.2.3\n", "'1.2.3' in line 6, not a number"),
        (b"1.5,2\n2.5,3\n1,2,3\n", "3 columns in line 3, where line 1 has 2"),
        (b"1\n2\n\0\n4\n", "a zero byte at byte 4: no text"),
        (b"1," * 70_000 + b"1\n", "70001 columns, more than 65536"),
        (b"1," * 2**22 + b"1\n", "a line 1 of 8388609 characters, more than 4194304"),
        (b"\x89PNG\r\n\x1a\n" + bytes(range(1, 256)), "no row of numbers, but"),
    ],
)
def test_what_is_no_table_is_told_with_its_line(tmp_path, content, said):
    (tmp_path / "p.csv").write_bytes(content)
    with pytest.raises(ValueError) as caught:  # noqa: PT011, what it says is looked at below
        measurement(read_content(tmp_path / "p.csv"))
    assert said in str(caught.value)


def test_any_bytes_are_numbers_or_told(tmp_path):
    pick = np.random.default_rng(0)
    alphabet = np.frombuffer(b'0123456789.,;-+eE \t\n\n\n#%"[]()xzm/nau\xb5\xff\0', dtype=np.uint8)
    said = set()
    for _ in range(300):
        (tmp_path / "p.csv").write_bytes(pick.choice(alphabet, pick.integers(1, 120)).tobytes())
        try:
            measurement(read_content(tmp_path / "p.csv"), resample=bool(pick.integers(2)))
        except ValueError as error:
            said.add(str(error))
    assert len(said) > 20
    assert max(map(len, said)) < 300


@pytest.mark.parametrize("suffix", ["csv", "txt", "dat", "npy", "nc", "opd"])
def test_what_is_no_regular_file_is_not_opened(tmp_path, suffix):
    os.mkfifo(tmp_path / f"pipe.{suffix}")
    (tmp_path / f"zero.{suffix}").symlink_to("/dev/zero")
    (tmp_path / f"folder.{suffix}").mkdir()
    with open(tmp_path / f"wide.{suffix}", "wb") as file:
        file.truncate(2**42)
    kinds = {
        "pipe": "a device, pipe or socket",
        "zero": "a device",
        "folder": "cannot be read",
        "wide": "MB, more than",
    }
    for kind, said in kinds.items():
        with pytest.raises(ValueError, match=said):
            measurement(read_content(tmp_path / f"{kind}.{suffix}"))


def test_a_binary_file_named_like_text_is_an_instruments_or_none(tmp_path):
    pytest.importorskip("SurfaceTopography")
    (tmp_path / "p.dat").write_bytes(b"\x88\x1b\x03\x6f\0\0" + bytes(4000))
    with pytest.raises(ValueError, match="SurfaceTopography"):
        measurement(read_content(tmp_path / "p.dat"))


@pytest.mark.parametrize(
    ("header", "separator"),
    [("X;Z\nmm;µm\n", ";"), ("Distance\tHeight\n[mm]\t[um]\n", "\t"), ("x,z\nmm,um\n", ","), ("x z\nmm um\n", " ")],
)
def test_a_row_of_units_below_the_names_states_them(tmp_path, header, separator):
    decimal = "." if separator == "," else ","
    table = read_table(written(tmp_path, np.column_stack([X, Z]), separator, decimal, header))
    assert table.units == ("mm", "um")
    np.testing.assert_array_equal(table.values, np.column_stack([X, Z]))


@pytest.mark.parametrize(
    ("names", "units", "places"),
    [
        (["No.", "x (mm)", "z (um)"], None, [1, 2]),
        (["#", "Position [mm]", "Height [µm]"], None, [1, 2]),
        (["x/mm", "z/um", "quality"], None, [0, 1]),
        (["time (s)", "z [um]", "speed", "x [mm]"], None, [3, 1]),
        (["index", "x", "z"], ["", "mm", "um"], [1, 2]),
        (["Point", "X", "Y", "Z"], ["-", "mm", "mm", "um"], [1, 2, 3]),
    ],
)
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_columns_that_are_neither_positions_nor_heights_are_left_out(tmp_path, names, units, places, separator):
    others = np.arange(1.0, 1.0 + X.size)
    columns = [others] * len(names)
    data = [X, Z] if len(places) == 2 else [X, np.zeros_like(X), Z]
    for place, each in zip(places, data, strict=True):
        columns[place] = each
    header = "".join(separator.join(line) + "\n" for line in (names, units) if line)
    table = read_table(written(tmp_path, np.column_stack(columns), separator, header=header))
    np.testing.assert_array_equal(table.values, np.column_stack(data))
    assert table.units == ("mm", *["mm"] * (len(places) - 2), "um")
    assert f"took {len(places)} of {len(names)} columns" in table.done[-1]


@pytest.mark.parametrize("names", ["a,b,c", "x,y", "x1,z1,x2"])
def test_columns_are_left_out_only_where_one_is_named_heights_and_one_positions(tmp_path, names):
    rows = np.column_stack([X, Z, Z])
    np.testing.assert_array_equal(read_table(written(tmp_path, rows, header=names + "\n")).values, rows)


def test_quoted_cells_may_have_decimal_commas(tmp_path):
    rows = [[f'"{value:.17g}"'.replace(".", ",") for value in row] for row in np.column_stack([X, Z])]
    (tmp_path / "p.csv").write_text('"x (mm)","z (um)"\n' + "\n".join(map(",".join, rows)) + "\n")
    table = read_table(tmp_path / "p.csv")
    np.testing.assert_array_equal(table.values, np.column_stack([X, Z]))
    assert table.units == ("mm", "um")


@pytest.mark.parametrize(
    ("header", "units"),
    [
        ("Pixel size (um),1.3\nUnits,nm\n", ("nm",)),
        ("Pixel size [mm]: 0.0013\nHeight unit: um\n", ("um",)),
        ("Pixel size (um) 1.3\nZ unit: nm\n", ("nm",)),
        ("Width: 120 um\nHeight: 120 um\nValue units: nm\n", ("nm",)),
        ("Pixel size (um),1.3\n", (None,)),
    ],
)
def test_the_unit_of_a_map_is_not_that_of_its_pixels(tmp_path, header, units):
    assert read_table(written(tmp_path, MAP, header=header)).units == units


def test_entries_of_a_header_state_the_units_of_columns(tmp_path):
    table = read_table(written(tmp_path, np.column_stack([X, Z]), header="Profile\nX unit: mm\nZ unit: µm\n"))
    assert table.units == ("mm", "um")


def test_columns_and_units_are_known_by_their_labels():
    assert columns_of(["Profile", "Lateral unit: mm", "Z unit: um"], 2) == ([0, 1], ("mm", "um"))
    assert columns_of(["Nr.;Weg [mm];Höhe [mil];Zeit"], 4)[0] == [1, 2]
    assert columns_of(["Nr.;Weg/mm;Höhe/mil"], 3) == ([1, 2], ("mm", "mil"))
    assert columns_of(["Nr.;Weg in mm;Höhe in mil"], 3) == ([1, 2], ("mm", "mil"))
    assert columns_of(["No.,Horizontal,Vertical", ",um,nm"], 3) == ([1, 2], ("um", "nm"))
    assert columns_of(["Nr.;Auflösung;px/mm"], 3)[0] == [0, 1, 2]
    assert columns_of(["Numéro;Abscisse [mm];Hauteur [um];Temps [s]"], 4) == ([1, 2], ("mm", "um"))
    for header, columns in (("Nr.;x;Weg [mm];Höhe [mil]", 4), ("x [mm],primary [um],roughness [um]", 3)):
        with pytest.raises(ValueError, match="name the positions x"):
            columns_of([header], columns)


@pytest.mark.parametrize("mark", ["-----", "*", "********", "Bad", "nan"])
def test_missing_numbers_are_marked_in_any_length(tmp_path, mark):
    (tmp_path / "p.csv").write_text(f"x [mm];z [um]\n0;1\n1;{mark}\n2;3\n3;4\n")
    np.testing.assert_equal(read_table(tmp_path / "p.csv").values[:, 1], [1, np.nan, 3, 4])


@pytest.mark.parametrize(
    ("header", "x", "y"),
    [
        ("pixel size 0.645 um", (0.645, "um", True), (0.645, "um", True)),
        ('"XY calibration","645","nm/pixel"', (645.0, "nm", True), (645.0, "nm", True)),
        ("# Width: 100 µm\n# Height: 80 µm", (100.0, "um", False), (80.0, "um", False)),
        ("Pixel_size (um); 0,645", (0.645, "um", True), (0.645, "um", True)),
        ("Pixel size = 0.645 um x 0.5 um", (0.645, "um", True), (0.5, "um", True)),
        ("X pixel size\t1.2 nm\nY pixel size\t1.3 nm", (1.2, "nm", True), (1.3, "nm", True)),
        ("pixel width: 2 um\npixel height: 3 um\nwidth: 1 mm", (2.0, "um", True), (3.0, "um", True)),
        ("point spacing: 5e-1 um", (0.5, "um", True), (0.5, "um", True)),
        ("Scan Size: 10 um", (10.0, "um", False), None),
        ("Height: 3 um", None, None),
        ("Width: 155 px", None, None),
        ("Z calibration: 1 nm", None, None),
        ("Lt = 4,00 mm   Ls = 2,5 µm", None, None),
        ("spacing: -1 um", None, None),
    ],
)
def test_sizes_are_read_where_the_header_states_them(tmp_path, header, x, y):
    (tmp_path / "map.txt").write_text(header + "\nz unit: um\n" + "1.5 2.5 3.25 4.5 1\n2 5 6 7 3.5\n" * 3)
    assert read_table(tmp_path / "map.txt").sizes == {
        axis: size for axis, size in (("x", x), ("y", y)) if size is not None
    }


@pytest.mark.parametrize(
    "row", ["[mm],[um]", "(mm),(um)", "# [mm],[um]", "[mm];[um]", "mm,um", "[mm]\t(um)", "mm;[um]"]
)
def test_each_column_has_its_own_unit_in_a_row_of_units(tmp_path, row):
    separator = next(each for each in ",;\t" if each in row)
    table = read_table(written(tmp_path, np.column_stack([X, Z]), separator, header=f"X{separator}Z\n{row}\n"))
    assert table.units == ("mm", "um")
    (tmp_path / "m.csv").write_text("X,Y,Z\n[um],[mm],[nm]\n" + "0,0,1\n1,0,2\n")
    assert read_table(tmp_path / "m.csv").units == ("um", "mm", "nm")


@pytest.mark.parametrize(
    "names",
    [
        ["y [mm]", "x [um]", "z [nm]"],
        ["z [nm]", "x [um]", "y [mm]"],
        ["z (nm)", "y (mm)", "x (um)"],
        ["Height/nm", "Y position/mm", "X position/um"],
        ["Y [mm]", "X [um]", "Höhe [nm]"],
        ["intensity", "y [mm]", "z [nm]", "x [um]"],
    ],
)
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_labels_of_three_columns_are_followed_in_any_order(tmp_path, names, separator):
    of = {"x": X, "y": 2.0 * X, "z": Z, "i": np.ones_like(X)}
    axes = [next(a for a, known in (("z", "zH"), ("y", "yY"), ("x", "xX"), ("i", "i")) if n[0] in known) for n in names]
    table = read_table(
        written(tmp_path, np.column_stack([of[axis] for axis in axes]), separator, header=separator.join(names) + "\n")
    )
    np.testing.assert_array_equal(table.values, np.column_stack([X, 2.0 * X, Z]))
    assert table.units == ("um", "mm", "nm")


@pytest.mark.parametrize(
    "header", ["Höhe [µm];Weg [mm]", "Height (um),Length (mm)", "HÖHE/µm\tMessstrecke/mm", "Profilhöhe in um;Weg in mm"]
)
def test_common_names_tell_heights_and_positions(tmp_path, header):
    separator = next(each for each in ";\t," if each in header)
    table = read_table(written(tmp_path, np.column_stack([Z, X]), separator, header=header + "\n"))
    np.testing.assert_array_equal(table.values, np.column_stack([X, Z]))
    assert table.units == ("mm", "um")


def test_entries_of_a_header_go_with_columns_in_any_order(tmp_path):
    table = read_table(written(tmp_path, np.column_stack([Z, X]), header="X unit: mm\nZ unit: µm\nz,x\n"))
    assert table.units == ("mm", "um")


@pytest.mark.parametrize(
    "mark",
    ["#N/A", "#NV", "#DIV/0!", "#VALUE!", "#WERT!", "N/A", "NA", "NULL", "BAD", "***", "---", "", '"#N/A"', "1.#QNAN"],
)
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_errors_of_spreadsheets_are_missing_heights(tmp_path, mark, separator):
    rows = [["1", "2", mark, "4", "5"], ["6", "7", "8", "9", mark], ["1", mark, mark, "4.5", "5"]]
    (tmp_path / "p.csv").write_text("z [um]\n" + "\n".join(map(separator.join, [*rows, *rows])))
    nan = np.nan
    expected = [[1, 2, nan, 4, 5], [6, 7, 8, 9, nan], [1, nan, nan, 4.5, 5]]
    np.testing.assert_array_equal(read_table(tmp_path / "p.csv").values, expected * 2)
    if mark:
        (tmp_path / "p.csv").write_text(f"z [um]\n1.5\n{mark}\n2\n{mark}\n")
        np.testing.assert_array_equal(read_table(tmp_path / "p.csv").values[:, 0], [1.5, nan, 2, nan])


def test_a_comment_does_not_cut_a_row(tmp_path):
    (tmp_path / "p.csv").write_text("1,2,3,4\n5,6,7,8 # good\n1,2, # bad, 3,4\n")
    with pytest.raises(ValueError, match="a comment in line 3 before its last column"):
        read_table(tmp_path / "p.csv")
    (tmp_path / "p.csv").write_text("1,2,3,4\n5,6#7,7,8\n")
    with pytest.raises(ValueError, match="'6#7' in line 2, not a number"):
        read_table(tmp_path / "p.csv")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("z [nm]\n-212\n1,006\n-1,215\n", "numbers like 1,006 next to -212, .*: write 1.006 or 1006"),
        ('x [um],z [nm]\n0,998\n1,"1,788"\n', "numbers like 1,788 next to 998"),
        ("x;z\n0;998\n1;1,788\n", "numbers like 1,788 next to 998"),
        ("0 998\n1 1,788\n", "numbers like 1,788 next to 998"),
        ("z [nm]\n-212\n1.006\n0\n", "numbers like 1.006 next to -212, whose points .*: write 1.006 next to -212.000"),
    ],
)
def test_commas_before_three_digits_in_some_rows_are_asked_about(tmp_path, text, said):
    (tmp_path / "p.csv").write_text(text)
    with pytest.raises(ValueError, match=said):
        read_table(tmp_path / "p.csv")


def test_decimal_commas_with_three_digits_are_no_thousands(tmp_path):
    for text in ("z\n1,788\n0\n1,5\n2\n", "z\n1,788\n0,998\n2\n", "0;1,788\n1;1,790\n2;1,795\n", "z\n1,788\n1998\n5\n"):
        (tmp_path / "p.csv").write_text(text)
        assert read_table(tmp_path / "p.csv").values[0, -1] == 1.788


@pytest.mark.parametrize(
    ("line", "scale"),
    [
        ("# Scale factor: 0.5 nm/count", "0.5 nm/count"),
        ("Z scale (nm/digit); 0,25", "0,25 nm/digit"),
        ("Resolution: 2 nm per LSB", "2 nm per LSB"),
        ("scale = 1e-3", "1e-3"),
    ],
)
def test_a_scale_of_heights_is_used_or_asked_about(tmp_path, line, scale):
    (tmp_path / "p.txt").write_text(line + "\n" + "\n".join(map(str, range(10))))
    content = read_content(tmp_path / "p.txt")
    assert content.units == {"z": scale}
    with pytest.raises(ValueError, match=r"a scale of .* in the header: write units: \{z: .* nm\}"):
        measurement(content)
    with pytest.raises(ValueError, match=r"a scale of .* in the header"):
        measurement(content, {"z": "nm"})
    found = measurement(content, {"z": "0.5 nm"})
    np.testing.assert_allclose(found.heights, 0.5e-9 * np.arange(10))
    assert found.units == {"z": "nm"}


@pytest.mark.parametrize("line", ["Scale: 1", "X scale: 2 um/pixel", "Full scale: 10 um", "Scale factor: 1 nm/count"])
def test_what_scales_no_heights_is_no_scale(tmp_path, line):
    (tmp_path / "p.txt").write_text(line + "\nz unit: nm\n" + "\n".join(map(str, range(10))))
    assert read_table(tmp_path / "p.txt").units == ("nm",)
    assert read_table(tmp_path / "p.txt").done == ()


def test_one_or_two_rows_are_a_profile(tmp_path):
    table = read_table(written(tmp_path, Z[None], header="z [um]\n"))
    np.testing.assert_array_equal(table.values[:, 0], Z)
    assert (table.units, table.done) == (("um",), ("took rows for columns",))
    np.testing.assert_array_equal(read_table(written(tmp_path, [X, Z])).values, np.column_stack([X, Z]))


def test_values_of_nodes_in_one_row_are_those_of_a_profile(tmp_path):
    (tmp_path / "row.csv").write_text("0.5 1 2 3 4 -5\n")
    np.testing.assert_array_equal(read_values(tmp_path / "row.csv", 1), [0.5, 1.0, 2.0, 3.0, 4.0, -5.0])


@pytest.mark.parametrize("header", [",x_um,z_nm", "x_um;z_nm", "position_um,height_nm", "distance_µm,Height_nm"])
def test_units_behind_an_underscore_are_read(tmp_path, header):
    """So data frames name their columns; the first of them has an index."""
    lines = [f"{'7,' * header.startswith(',')}{0.5 * i}{',;'[';' in header]}{np.sin(i):.4f}" for i in range(32)]
    path = tmp_path / "line.csv"
    path.write_text("\n".join([header, *lines]), encoding="utf-8")
    found = measurement(read_content(path))
    assert found.units == {"x": "um", "z": "nm"}
    np.testing.assert_allclose(found.heights, 1e-9 * np.sin(np.arange(32)), atol=1e-13)


@pytest.mark.parametrize("separator", [";", ",", "\t"])
@pytest.mark.parametrize("extra", [(1, 0), (2, 2), (0, 3)])
def test_empty_columns_behind_the_last_one_are_none(tmp_path, separator, extra):
    """Spreadsheets write them in the header, in the rows, or in both."""
    of_header, of_rows = (separator * n for n in extra)
    rows = [separator.join((str(i + 1), f"{0.5 * i}", f"{np.sin(i):.4f}")) + of_rows for i in range(32)]
    path = tmp_path / "trace.csv"
    path.write_text("\n".join([separator.join(("No", "x [mm]", "z [um]")) + of_header, *rows, of_rows]))
    found = measurement(read_content(path))
    assert found.units == {"x": "mm", "z": "um"}
    assert len(found.heights) == 32


@pytest.mark.parametrize("rows", [40, 4000])
def test_a_row_of_words_is_told_by_its_line(tmp_path, rows):
    """A mean below the heights, behind rows with cells that are empty."""
    lines = ["x [mm];z [um];;", *(f"{0.5 * i};{np.sin(i):.4f};;" for i in range(rows)), ";;;", "Mean;0.134;;", ";;;"]
    path = tmp_path / "trace.csv"
    path.write_text("\n".join(lines))
    with pytest.raises(ValueError, match=rf"^'Mean' in line {rows + 3}, not a number \(delete that line if"):
        read_content(path)


@pytest.mark.parametrize(
    ("header", "columns"),
    [
        ("x [mm],depth [um]", 2),
        ("Weg [mm];Profiltiefe [um]", 2),
        ("Position;Profondeur\nmm;um", 2),
        ("No.,x [mm],Depth [um]", 3),
        ("Depth [nm]", 1),
        ("Depth [nm]", 6),
    ],
)
def test_depths_are_not_taken_for_heights(header, columns):
    with pytest.raises(ValueError, match="which may grow downwards"):
        columns_of(header.split("\n"), columns)


@pytest.mark.parametrize(
    "header", ["depth,x,height\num,mm,um", "Etch depth: 5 um\nx [mm],z [um]", "x [mm],depth z [um]"]
)
def test_depths_that_are_no_heights_are_left_alone(header):
    lines = header.split("\n")
    chosen, units = columns_of(lines, lines[-1].count(",") + 1)
    assert len(chosen) == 2
    assert units == ("mm", "um")
