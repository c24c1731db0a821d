"""Maps in text with axis values in their first row or column: positions or an error, and never heights."""

import numpy as np
import pytest

from gfmd_numba import make_surface
from gfmd_numba.roughness.measurements import Content, measurement, on_a_grid, split_axes
from gfmd_numba.roughness.surface_files import read_content
from gfmd_numba.scene import InputError
from support.faulty_files import complaint

UNITS = {"x": "mm", "y": "mm", "z": "um"}


def rough(ny, nx, hurst, seed=0):
    random = np.random.default_rng(seed)
    q = np.hypot(*np.meshgrid(ny * np.fft.fftfreq(ny), nx * np.fft.fftfreq(nx), indexing="ij"))
    q[0, 0] = np.inf
    waves = q ** -(1 + hurst) * (random.normal(size=q.shape) + 1j * random.normal(size=q.shape))
    heights = np.fft.ifft2(waves).real
    return heights / heights.std()


def with_axes(heights, x, y, corner=0.0):
    return np.block([[np.array([[corner]]), x[None, :]], [y[:, None], heights]])


def text(folder, table, header=""):
    rows = "\n".join(",".join("" if np.isnan(cell) else f"{cell:.10g}" for cell in row) for row in table)
    (folder / "map.csv").write_text(header + rows + "\n")
    return {"surface": {"method": "measured", "file": str(folder / "map.csv")}}


@pytest.mark.parametrize("corner", [0.0, 12.0, np.nan])
@pytest.mark.parametrize("x0", [0.0, 0.01, -0.3])
def test_axes_of_a_map_are_its_positions(tmp_path, corner, x0):
    z = rough(9, 12, 0.8)
    x, y = x0 + 0.01 * np.arange(12), 0.02 * np.arange(9)[::-1]
    file = text(tmp_path, with_axes(z, x, y, corner))
    file["surface"]["units"] = UNITS
    found = make_surface(file)
    np.testing.assert_allclose(found["height"], 1e-6 * z[::-1], rtol=1e-9)
    np.testing.assert_allclose(found["x"], 1e-5 * np.arange(12), atol=1e-15)
    np.testing.assert_allclose(found["y"], 2e-5 * np.arange(9), atol=1e-15)
    said = "read the first row as positions along x, and the first column as positions along y"
    assert found.attrs["processing"].split("\n")[0] == said


def test_units_of_the_axes_may_stand_in_the_header(tmp_path):
    table = with_axes(rough(8, 8, 0.5), np.arange(8.0), np.arange(8.0), 8.0)
    file = text(tmp_path, table, "# x [mm], y [um], z [nm]\n")
    found = make_surface(file)
    assert float(found["x"][1]) == pytest.approx(1e-3)
    assert float(found["y"][1]) == pytest.approx(1e-6)
    assert float(abs(found["height"]).max()) == pytest.approx(1e-9 * abs(table[1:, 1:]).max())
    file["surface"]["units"] = {"x": "um"}
    with pytest.raises(InputError, match=r"positions along x in mm as the file says, not um as units\.x does"):
        make_surface(file)


def test_axes_without_units_need_some(tmp_path):
    file = text(tmp_path, with_axes(rough(8, 8, 0.5), np.arange(8.0), np.arange(8.0)))
    for units in ({}, {"z": "um"}):
        with pytest.raises(InputError, match=r"positions along x and positions along y .*without a unit"):
            make_surface(file | {"surface": file["surface"] | {"units": units}, "length": 1e-3})


def test_axes_with_few_digits_are_still_no_heights(tmp_path):
    x = np.round(np.arange(9) / 3, 2)  # uneven by 1 %
    file = text(tmp_path, with_axes(rough(8, 9, 0.5), x, np.arange(8.0)))
    file["surface"]["units"] = UNITS
    with pytest.raises(InputError, match=r"a spacing of 0\.34 in x at index 1, where 0\.33375 is the mean"):
        make_surface(file)


@pytest.mark.parametrize(
    ("cut", "said"),
    [
        (
            np.s_[:, 1:],
            "a first row (line 2) of evenly spaced numbers, unlike the rows next to it: if they are positions",
        ),
        (np.s_[1:], "a first column (from line 2 on) of evenly spaced numbers, unlike the columns next to it"),
    ],
)
def test_one_axis_alone_is_refused(tmp_path, cut, said):
    text(tmp_path, with_axes(rough(8, 9, 0.5), np.arange(9.0), np.arange(8.0))[cut], "# a map\n")
    found = complaint(tmp_path, make_surface, "surface: {method: measured, file: map.csv}\n")
    assert said in found
    assert "if they are heights, save the map as .npy" in found


def test_rows_numbered_unevenly_are_refused(tmp_path):
    y = np.array([0, 1, 3, 4, 7, 8, 9, 12.0])
    file = text(tmp_path, with_axes(rough(8, 9, 0.5), np.arange(9.0), y, 9.0))
    with pytest.raises(InputError, match=r"a first row \(line 1\) .* give those along y as the first column, evenly"):
        make_surface(file)


@pytest.mark.parametrize("tilt", [0.0, 3.0])
@pytest.mark.parametrize("levels", [None, 30])
@pytest.mark.parametrize("hurst", [-1.0, 0.3, 0.8, 2.0])
def test_honest_maps_are_heights(tilt, levels, hurst):
    random = np.random.default_rng(0)
    for seed in range(50):
        ny, nx = random.integers(8, 40, 2)
        y, x = np.mgrid[:ny, :nx]
        heights = rough(ny, nx, hurst, seed) + tilt * (random.normal() * x + random.normal() * y)
        heights = heights if levels is None else np.round(levels * heights) / levels
        found, positions = split_axes(heights, 1)
        assert not positions
        assert found is heights


X, Y = np.meshgrid(np.arange(12.0), np.arange(10.0))
SHAPES = {
    "plane": X + 2 * Y,
    "multiplication table": (1 + X) * (1 + Y),
    "saddle": (X - 5.5) * (Y - 4.5),
    "roof": abs(X - Y),
    "corner of a pyramid": np.maximum(X, Y),
    "wedge in steps": np.round(0.97 * X + 0.3 * Y),
    "paraboloid": (X - 5.5) ** 2 + (Y - 4.5) ** 2,
    "cone": np.hypot(X, Y),
    "flat with a bump": X + np.exp(-((X - 6) ** 2) - (Y - 5) ** 2),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_shapes_with_straight_edges_are_heights(shape):
    for turned in (SHAPES[shape], SHAPES[shape].T, -SHAPES[shape]):
        assert split_axes(turned, 1)[0] is turned


@pytest.mark.parametrize(("corner", "unit"), [("y\\x", None), ("um", None), ("y [um]\\x [um]", "um")])
@pytest.mark.parametrize("separator", [",", "\t", ";"])
def test_a_label_in_the_corner_leaves_the_axes_as_they_are(tmp_path, corner, unit, separator):
    heights = rough(8, 9, 0.5)
    table = with_axes(heights, np.arange(9.0), 2.0 * np.arange(8.0))
    rows = [separator.join([corner, *map(str, table[0, 1:])]), *(separator.join(map(str, row)) for row in table[1:])]
    (tmp_path / "m.csv").write_text("\n".join(rows))
    content = read_content(tmp_path / "m.csv")
    np.testing.assert_array_equal(content.heights, heights)
    np.testing.assert_array_equal(content.positions["x"], np.arange(9.0))
    np.testing.assert_array_equal(content.positions["y"], 2.0 * np.arange(8.0))
    assert content.units.get("x") == unit
    rows[0] = rows[0].partition(separator)[2]
    (tmp_path / "m.csv").write_text("\n".join(rows))
    np.testing.assert_array_equal(read_content(tmp_path / "m.csv").heights, heights)


def test_points_of_a_grid_may_lack_whole_rows_and_columns():
    x, y = np.meshgrid(np.arange(20.0), 0.5 * np.arange(12.0))
    z = np.random.default_rng(0).normal(size=x.shape)
    kept = np.ones(x.shape, dtype=bool)
    kept[3:5], kept[:, 7] = False, False
    heights, positions = on_a_grid(x[kept], y[kept], z[kept])
    np.testing.assert_array_equal(heights, np.where(kept, z, np.nan))
    np.testing.assert_allclose(positions["y"], 0.5 * np.arange(12.0))
    rows, columns = kept[:, 0], kept[0]
    found = measurement(Content(z[rows][:, columns], {"x": x[0, columns], "y": y[rows, 0]}), UNITS)
    np.testing.assert_array_equal(found.heights, 1e-6 * np.where(kept, z, np.nan))
