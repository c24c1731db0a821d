"""Prescribed tractions of scene files on maps, alone and under a rough punch: fields, units, pictures, refusals."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.analysis.plots.bodies import plot_loaded_body
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.scene import InputError, load_scene

N = 32
Y, X = np.meshgrid(np.arange(N) / N, np.arange(N) / N, indexing="ij")
WAVE = 2e-3 * np.cos(2 * np.pi * (3 * X + Y) + 0.2)
SHEAR = np.stack((3e-3 * np.sin(4 * np.pi * Y) + 1e-3, 2e-3 * np.cos(2 * np.pi * X) - 2e-3))


def save(folder, **arrays):
    for name, array in arrays.items():
        np.save(folder / f"{name}.npy", array)
    return {name: str(folder / f"{name}.npy") for name in arrays}


def loaded(folder, length=1.0, modulus=None, **boundary):
    body = {"poissons_ratio": 0.3, "aspect_ratio": 0.5} | ({} if modulus is None else {"youngs_modulus": modulus})
    scene = {"dimension": 2, "body": body, "boundary": save(folder, **boundary)}
    return {"scene": scene | ({} if length == 1.0 else {"length": length})}


def test_a_file_in_si_units_is_the_same_problem(tmp_path):
    held = np.where(np.hypot(X - 0.5, Y - 0.5) < 0.2, -1e-3, np.nan)
    one = gfmd_numba.solve(loaded(tmp_path, normal_displacement=held, tangential_traction_y=SHEAR[1]))
    assert int(one["status"]) == 0
    assert one["normal_traction"].dims == ("y", "x")
    length, young = 1e-4, 70e9
    modulus = young / (1 - 0.3**2)
    given = {"normal_displacement": held * length, "tangential_traction_y": SHEAR[1] * modulus}
    two = gfmd_numba.solve(loaded(tmp_path, length, young, **given))
    for name, scale, unit in (("displacement", length, "m"), ("traction", modulus, "Pa")):
        for component in (f"normal_{name}", f"tangential_{name}", f"tangential_{name}_y"):
            assert two[component].units == unit
            np.testing.assert_allclose(two[component], scale * one[component], rtol=1e-7, atol=1e-10 * scale)
    inside = np.isfinite(held)
    np.testing.assert_array_equal(one["normal_displacement"].values[inside], -1e-3)
    np.testing.assert_allclose(one["tangential_traction_y"], SHEAR[1], atol=1e-9)


def test_text_and_numbers_are_maps_too(tmp_path):
    np.savetxt(tmp_path / "wave.csv", WAVE, delimiter=",")
    body = {"poissons_ratio": 0.3, "aspect_ratio": 0.5}
    boundary = {"normal_traction": str(tmp_path / "wave.csv"), "tangential_traction": 0.01}
    found = gfmd_numba.solve({"scene": {"dimension": 2, "body": body, "boundary": boundary}})
    np.testing.assert_allclose(found["normal_traction"], WAVE, atol=1e-12)
    np.testing.assert_allclose(found["tangential_displacement"].mean(), 0.01 * 0.5 / 0.35, rtol=1e-9)
    uniform = {"dimension": 2, "body": body, "boundary": {"tangential_traction_y": 0.01}}
    found = gfmd_numba.solve({"scene": uniform, "points": 6})
    assert found["normal_traction"].shape == (6, 6)
    np.testing.assert_allclose(found["tangential_displacement_y"], 0.01 * 0.5 / 0.35, rtol=1e-9)


@pytest.mark.long
def test_a_loaded_map_is_drawn(tmp_path):
    figure = plot_loaded_body(gfmd_numba.solve(loaded(tmp_path, 1e-4, 1e9, normal_traction=1e6 * WAVE)))
    assert len(figure.axes) == 12  # of six maps with their colour bars
    figure.draw_without_rendering()


def under_a_punch(folder, interface, loading, aspect_ratio=0.5, path=(), **boundary):
    scene = {
        "dimension": 2,
        "body": {"poissons_ratio": 0.3, "aspect_ratio": aspect_ratio},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}} | interface,
        "loading": loading,
    }
    if boundary:
        scene["boundary"] = save(folder, **boundary)
    eps = {"eps_c": 0.5, "eps_f": 0.25, "eps_t": 0.5}  # 32 nodes both ways
    return {"scene": scene, "discretisation": eps, "path": list(path), "numerics": {"residual": 1e-9}}


@pytest.mark.parametrize(
    "friction",
    [pytest.param({}, marks=pytest.mark.long), {"friction": {"coefficient": 0.2}}],
    ids=["frictionless", "friction"],
)
@pytest.mark.parametrize("loading", [{"reduced_pressure": 0.1}, {"displacement": 3e-3}], ids=["load", "displacement"])
def test_tractions_under_a_rough_punch_and_its_pressure_balance(tmp_path, friction, loading):
    """Where the body is, what is prescribed and what the punch bears balance, and nothing penetrates."""
    given = {"normal_traction": WAVE, "tangential_traction": SHEAR[0], "tangential_traction_y": SHEAR[1]}
    result = gfmd_numba.solve(under_a_punch(tmp_path, friction, loading, **given))
    bare = gfmd_numba.solve(under_a_punch(tmp_path, friction, loading))
    assert int(result["status"]) == int(bare["status"]) == 0
    pressure, u3, total = result["pressure"].values, result["displacement"].values, SHEAR.copy()
    if friction:
        total += np.stack([result[f"tangential_traction{end}"] for end in ("", "_y")])
    xx, xy, yy, xz, yz, zz = ElasticBody(0.3, 0.5).response((N, N)).elements
    z, tx, ty = np.fft.rfft2(u3), *np.fft.rfft2(total)
    wx, wy, plane = tx - 1j * xz * z, ty - 1j * yz * z, xx * yy - xy**2  # what is left for the tangential displacements
    x, y = (yy * wx - xy * wy) / plane, (xx * wy - xy * wx) / plane
    if friction:
        for end, waves in (("", x), ("_y", y)):
            np.testing.assert_allclose(result[f"tangential_displacement{end}"], np.fft.irfft2(waves), atol=1e-10)
    pull = np.fft.irfft2(zz * z - 1j * (xz * x + yz * y))
    np.testing.assert_allclose(pull, WAVE - pressure, atol=1e-8 * pressure.max())
    gap = result["gap"].values
    assert gap.min() == 0.0
    assert (pressure[gap > 0] == 0.0).all()
    assert pressure.min() >= 0.0
    if "reduced_pressure" in loading:
        assert float(result["mean_pressure"]) == pytest.approx(0.1 * 0.01, rel=1e-8)
    assert abs(bare["pressure"] - pressure).max() > 0.1 * pressure.max()


def test_a_traction_that_drags_the_body_is_a_path_of_the_punch_the_other_way(tmp_path):
    """A uniform traction shears the slab by t z_m / C44; dragged after it, the punch bears what it bore without."""
    shift = 1e-4
    friction, load = {"friction": {"coefficient": 0.3}}, {"reduced_pressure": 0.1}
    bare = gfmd_numba.solve(under_a_punch(tmp_path, friction, load))
    sheared = np.full((N, N), shift * 0.35 / 0.5)
    result = gfmd_numba.solve(under_a_punch(tmp_path, friction, load, tangential_traction_y=sheared))
    np.testing.assert_allclose(result["pressure"], bare["pressure"], atol=1e-9)
    moved = result["tangential_displacement_y"] - bare["tangential_displacement_y"]
    np.testing.assert_allclose(moved, shift, rtol=1e-6)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"dimension": 1}, "scene.boundary.tangential_traction_y: you gave 0.1; gfmd allows nothing with dimension 1"),
        ({"body": {"poissons_ratio": 0.3}}, "tangential_traction_y: you gave a mean of 0.1; gfmd allows a mean of 0"),
        (
            {"boundary": {"normal_traction": "odd"}},
            "you gave odd.npy (32 x 31 values); gfmd allows one value for each of",
        ),
        ({"boundary": {"normal_traction": "row"}}, "not rows of numbers); gfmd allows rows of numbers, one for each y"),
        ({"boundary": {"normal_traction": "endless"}}, "endless.npy (inf at index 2, 3); gfmd allows finite numbers"),
        (
            {"boundary": {"tangential_traction_y": 0.1, "tangential_displacement_y": "held"}},
            "you gave 0.1 at node 0, 1; gfmd allows a file with not-a-number at the nodes whose "
            "tangential_displacement_y",
        ),
        ({"body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5, "state": "plane_stress"}}, "'plane_strain'"),
        ({"points": 2**20}, "points: you gave 1048576; gfmd allows a grid that fits in"),
    ],
)
def test_what_a_map_cannot_bear_is_refused_where_it_stands(tmp_path, changes, said):
    endless, held = np.zeros((N, N)), np.full((N, N), np.nan)
    endless[2, 3], held[0, 1] = np.inf, 0.0
    names = save(tmp_path, odd=np.zeros((32, 31)), row=np.zeros(32), endless=endless, held=held)
    scene = {
        "dimension": 2,
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5},
        "boundary": {"tangential_traction_y": 0.1},
    }
    points = changes.get("points", N)
    scene |= {key: value for key, value in changes.items() if key != "points"}
    scene["boundary"] = {key: names.get(value, value) for key, value in scene["boundary"].items()}
    with pytest.raises(InputError) as error:
        gfmd_numba.solve({"scene": scene, "points": points})
    assert said in str(error.value)


def test_a_boundary_of_another_grid_than_the_punch_is_refused(tmp_path):
    with pytest.raises(
        InputError, match=r"you gave normal_traction\.npy \(8 x 8 values\); gfmd allows .* 32 x 32 nodes"
    ):
        gfmd_numba.solve(under_a_punch(tmp_path, {}, {"reduced_pressure": 0.1}, normal_traction=np.zeros((8, 8))))


def test_a_displacement_along_y_under_a_punch_is_refused(tmp_path):
    file = under_a_punch(tmp_path, {}, {"reduced_pressure": 0.1}, tangential_displacement_y=np.zeros((N, N)))
    load_scene(file)
    with pytest.raises(InputError, match=r"tangential_displacement_y.*only tractions with a punch"):
        gfmd_numba.solve(file)


@pytest.mark.parametrize("name", ["tangential_traction", "tangential_traction_y"])
def test_nothing_holds_a_half_space_under_a_punch_along_either_axis(tmp_path, name):
    file = under_a_punch(tmp_path, {}, {"reduced_pressure": 0.1}, aspect_ratio=np.inf, **{name: 1e-3 + 0.0 * X})
    with pytest.raises(
        InputError, match=rf"boundary\.{name}: you gave a mean of 0\.001; .* nothing holds a half-space"
    ):
        gfmd_numba.solve(file)
