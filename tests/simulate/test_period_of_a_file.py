"""A scene without a length: the file of a measured surface tells the period, and units and loads count by it."""

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.scene import InputError
from support.cases import some_of
from support.command_line import gfmd

N, LENGTH = 128, 4e-4
pytestmark = pytest.mark.filterwarnings("ignore:.*waves longer than two fifths")  # a wave of the period carries others
X = LENGTH * np.arange(N) / N
HEIGHTS = 2e-7 * (np.cos(2 * np.pi * X / LENGTH) + 0.2 * np.cos(26 * np.pi * X / LENGTH + 1))
BODY = {"youngs_modulus": "2 GPa", "poissons_ratio": 0.3, "aspect_ratio": 0.5}
WALL = {"hard_wall": {}}


@pytest.fixture
def profile(tmp_path):
    np.savetxt(tmp_path / "p.csv", np.column_stack([1e3 * X, 1e6 * HEIGHTS]), delimiter=",", header="x [mm], z [um]")
    return {"method": "measured", "file": str(tmp_path / "p.csv")}


def scene(roughness, **changes):
    return {"body": BODY, "roughness": roughness, "interface": WALL, "loading": {"displacement": "0.1 um"}} | changes


def same(first, second):
    for name in ("pressure", "height", "gap", "x"):
        np.testing.assert_allclose(first[name], second[name], rtol=1e-9, atol=1e-12 * float(abs(first[name]).max()))
    assert first["x"].units == second["x"].units == "m"


CHANGES = {
    "displacement": {},
    "cutoff": {"cutoff": "20 um"},
    "line load": {"loading": {"line_load": "50 N/m"}},
    "path": {
        "path": [{"displacement": "0.2 um"}, {"sliding": "1 nm"}],
        "interface": WALL | {"friction": {"coefficient": 0.2}},
    },
    "range": {"interface": WALL | {"exponential": {"work_of_adhesion": "1 mJ/m^2", "range": "5 um"}}, "points": 256},
    "layers": {
        "body": {
            "layers": [{"youngs_modulus": "3 GPa", "poissons_ratio": 0.3, "height": "10 um"}],
            "base": {"youngs_modulus": "2 GPa", "poissons_ratio": 0.3},
        },
        "loading": {"pressure": "1 MPa"},
    },
    "random body": {
        "body": BODY
        | {
            "roughness": {
                "method": "psd",
                "hurst": 0.8,
                "rms_height": "20 nm",
                "points": N,
                "cut_on": "20 um",
                "roll_off": "200 um",
            }
        }
    },
}


@pytest.mark.parametrize("change", some_of(CHANGES, 0, 2, 3, 5))
def test_the_file_says_as_much_as_a_length(profile, change):
    changes = dict(CHANGES[change])
    treatment = {key: changes.pop(key) for key in ("cutoff", "points") if key in changes}
    given = scene(profile | treatment, **changes)
    same(gfmd_numba.solve(given), gfmd_numba.solve(given | {"length": LENGTH}))


@pytest.mark.filterwarnings("ignore:nodes that touch stick out")  # heights are those of noise
def test_a_force_on_a_map_counts_by_the_period_of_its_file(tmp_path):
    z = np.add.outer(HEIGHTS[::4], HEIGHTS[::4])
    x = X[::4]
    table = xr.Dataset({"height": (("y", "x"), z, {"units": "m"})}, {"x": x, "y": x})
    for axis in "xy":
        table[axis].attrs["units"] = "m"
    table.to_netcdf(tmp_path / "m.nc", engine="netcdf4")
    rough = {"method": "measured", "file": str(tmp_path / "m.nc")}
    found = gfmd_numba.solve(scene(rough, loading={"force": "1 mN"}, body=BODY | {"aspect_ratio": float("inf")}))
    assert float(found["mean_pressure"]) == pytest.approx(1e-3 / LENGTH**2, rel=1e-6)


def test_heights_with_positions_tell_it_too():
    array = xr.DataArray(HEIGHTS, dims="x", coords={"x": ("x", X, {"units": "m"})}, attrs={"units": "m"})
    bare = {key: value for key, value in scene({}).items() if key != "roughness"}
    same(gfmd_numba.solve(bare, array), gfmd_numba.solve(bare | {"length": LENGTH}, array))


@pytest.mark.long
def test_a_second_surface_without_positions_has_the_period_of_the_first(profile, tmp_path):
    np.save(tmp_path / "q.npy", np.roll(HEIGHTS, 40))
    other = {"method": "measured", "file": str(tmp_path / "q.npy"), "units": {"z": "m"}}
    for first, second in ((profile, other), (other, profile)):
        given = scene(first, body=BODY | {"roughness": second})
        same(gfmd_numba.solve(given), gfmd_numba.solve(given | {"length": LENGTH}))
    np.savetxt(tmp_path / "r.csv", np.column_stack([1.1e3 * X, HEIGHTS]), delimiter=",", header="x [mm], z [m]")
    given = scene(profile, body=BODY | {"roughness": {"method": "measured", "file": str(tmp_path / "r.csv")}})
    said = (
        r"body\.roughness\.file: you gave r\.csv \(positions over a period of 0\.00044 m, not 0\.0004 m as in "
        r"roughness\)"
    )
    with pytest.raises(InputError, match=said):
        gfmd_numba.solve(given)


FAULTS = {
    "displacement": (
        {},
        {},
        "loading.displacement: you gave '0.1 um'; gfmd allows a number without a unit, as there is no length",
    ),
    "line load": (
        {"loading": {"line_load": 50.0}},
        {},
        "loading.line_load: you gave 50.0; gfmd allows line_load with the length of the period, or a reduced_pressure",
    ),
    "cutoff": (
        {"loading": {"reduced_pressure": 0.1}},
        {"cutoff": "20 um"},
        "(a cutoff with a unit, as neither the file nor a length tells the period in m: give length)",
    ),
    "path": (
        {"loading": {"displacement": 1e-4}, "path": [{"displacement": "0.2 um"}]},
        {},
        "path[0].displacement: you gave '0.2 um'; gfmd allows a number without a unit, as there is no length",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_file_in_units_of_its_period_tells_no_length(tmp_path, fault):
    changes, treatment, said = FAULTS[fault]
    np.save(tmp_path / "p.npy", HEIGHTS / LENGTH)
    rough = {"method": "measured", "file": str(tmp_path / "p.npy"), "units": {"z": "L_x"}, **treatment}
    with pytest.raises(InputError) as caught:
        gfmd_numba.solve(scene(rough, **changes))
    assert said in str(caught.value)


def test_a_surface_file_counts_by_the_period_of_its_file(profile):
    described = {"surface": profile | {"cutoff": "30 um"}, "hurst_range": {"shortest": "40 um", "longest": "0.3 mm"}}
    found, stated = gfmd_numba.make_surface(described), gfmd_numba.make_surface(described | {"length": "0.4 mm"})
    np.testing.assert_array_equal(found["height"], stated["height"])
    assert float(found["hurst_exponent"]) == float(stated["hurst_exponent"])
    bare = {"surface": profile | {"units": {}}}
    np.save(profile["file"].replace("csv", "npy"), HEIGHTS / LENGTH)
    bare["surface"]["file"] = profile["file"].replace("csv", "npy")
    with pytest.raises(
        InputError, match=r"hurst_range: .*wavelengths without a unit, as neither the file nor a length"
    ):
        gfmd_numba.make_surface(bare | {"hurst_range": described["hurst_range"]})


@pytest.mark.long
def test_a_load_curve_counts_by_the_period_of_the_file(profile, tmp_path):
    loads = ["0.05 um", "0.1 um"]
    found = gfmd_numba.load_curve(scene(profile), loads)
    np.testing.assert_allclose(found["prescribed_load"], [5e-8, 1e-7])
    assert found["prescribed_load"].units == "m"
    stated = gfmd_numba.load_curve(scene(profile, length=LENGTH), loads)
    np.testing.assert_allclose(found["mean_pressure"], stated["mean_pressure"])
    by_force = gfmd_numba.load_curve(scene(profile), ["10 N/m", "20 N/m"])
    np.testing.assert_allclose(by_force["mean_pressure"] * LENGTH, [10, 20])


def test_loads_with_units_need_a_scale():
    rough = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01, "points": 64, "cut_on": 0.1, "roll_off": 0.5}
    bare = scene(rough, body={"poissons_ratio": 0.3, "aspect_ratio": 0.5}, loading={"displacement": 1e-4})
    with pytest.raises(
        InputError, match=r"loads\[0\]: you gave '0.1 um'; gfmd allows a number without a unit, as there is no"
    ):
        gfmd_numba.load_curve(bare, ["0.1 um", "0.2 um"])


def test_check_reads_the_period_from_the_file(profile, tmp_path):
    text = (
        "body: {youngs_modulus: 2 GPa, poissons_ratio: 0.3, aspect_ratio: 1/2}\n"
        "roughness: {method: measured, file: p.csv, cutoff: 20 um}\ninterface: {hard_wall: {}}\n"
        "loading: {displacement: 0.1 um}\n"
    )
    (tmp_path / "s.yaml").write_text(text)
    assert "length 400 µm" in gfmd("check", tmp_path / "s.yaml").output
