"""Tractions and displacements of a scene file, alone and under a rough punch."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.contact.problem import Tractions
from gfmd_numba.contact.reduction import reduce
from gfmd_numba.contact.rough_surfaces import FacingSurfaces
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.scene import Numerics, Scene, SceneFile
from support.coupled_bodies import NX, X, flat


def save(folder, **arrays):
    for name, array in arrays.items():
        np.savetxt(folder / f"{name}.csv", array)
    return {name: str(folder / f"{name}.csv") for name in arrays}


def test_a_file_in_si_units_is_the_same_problem(tmp_path):
    """The same problem in E* and L_x, flat, as a record, and in Pa and m."""
    given, _ = flat(64, 16, -1e-3)
    x = np.arange(64) / 64
    files = save(tmp_path, normal_displacement=given[1], tangential_traction=0.01 * np.cos(2 * np.pi * x))
    plain = {"scene": {"body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5}, "boundary": files}}
    one = gfmd_numba.solve(plain)
    assert int(one["status"]) == 0
    assert one["normal_traction"].units == one["x"].units == "1"
    for same in (plain["scene"], SceneFile.model_validate(plain)):
        np.testing.assert_array_equal(gfmd_numba.solve(same)["normal_traction"], one["normal_traction"])
    length, young = 1e-4, 70e9
    modulus = young / (1 - 0.3**2)
    files = save(
        tmp_path,
        normal_displacement=given[1] * length,
        tangential_traction=0.01 * np.cos(2 * np.pi * x) * modulus,
    )
    scene = {"length": length, "body": plain["scene"]["body"] | {"youngs_modulus": young}, "boundary": files}
    two = gfmd_numba.solve({"scene": scene})
    for name, scale, unit in (("displacement", length, "m"), ("traction", modulus, "Pa")):
        for component in ("normal", "tangential"):
            assert two[f"{component}_{name}"].units == unit
            np.testing.assert_allclose(
                two[f"{component}_{name}"], scale * one[f"{component}_{name}"], rtol=1e-9, atol=1e-13 * scale
            )


def under_a_punch(tmp_path, interface, loading, aspect_ratio=0.5, **boundary):
    """A rough contact with a boundary, and its total tractions [component, x] on the body in E*."""
    scene = {
        "body": {"poissons_ratio": 0.3, "aspect_ratio": aspect_ratio},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}} | interface,
        "loading": loading,
    }
    if boundary:
        scene["boundary"] = save(tmp_path, **boundary)
    file = {"scene": scene, "discretisation": {"eps_c": 0.5, "eps_f": 1 / 16, "eps_t": 0.5}}
    result = gfmd_numba.solve(file | {"numerics": {"residual": 1e-9}})
    assert int(result["status"]) == 0
    return result


WAVE = 2e-3 * np.cos(2 * np.pi * 3 * X + 0.2)
SHEAR = 3e-3 * np.sin(2 * np.pi * 2 * X) + 1e-3


@pytest.mark.parametrize("friction", [pytest.param({}, marks=pytest.mark.long), {"friction": {"coefficient": 0.2}}])
@pytest.mark.parametrize("loading", [{"reduced_pressure": 0.1}, {"displacement": 3e-3}])
def test_tractions_under_a_rough_punch_and_its_pressure_balance(tmp_path, friction, loading):
    """Where the body is, what is prescribed and the pressure of the punch balance, and nothing penetrates."""
    result = under_a_punch(tmp_path, friction, loading, normal_traction=WAVE, tangential_traction=SHEAR)
    bare = under_a_punch(tmp_path, friction, loading)
    k = ElasticBody(0.3, 0.5).response((NX,))
    pressure, u3 = result["pressure"].values, result["displacement"].values
    c3 = grid.coefficients(u3)
    shear = SHEAR + (result["tangential_traction"].values if friction else 0.0)
    u1 = np.divide(grid.coefficients(shear) - 1j * k.elements[1] * c3, k.elements[0])
    if friction:
        np.testing.assert_allclose(result["tangential_displacement"], grid.signal(u1, NX), atol=1e-10)
    pull = grid.signal(k.normal * c3 - 1j * k.elements[1] * u1, NX)
    np.testing.assert_allclose(pull, WAVE - pressure, atol=1e-8 * pressure.max())
    gap = result["gap"].values
    assert gap.min() == 0.0
    assert (pressure[gap > 0] == 0.0).all()
    assert pressure.min() >= 0.0
    if "reduced_pressure" in loading:
        assert float(result["mean_pressure"]) == pytest.approx(0.1 * 0.01, rel=1e-8)
        rise = (result["height"] + u3 + gap).values  # the punch: its profile upside down at some height
        np.testing.assert_allclose(rise, rise[0], atol=1e-12)
    assert abs(bare["pressure"] - pressure).max() > 0.1 * pressure.max()


def test_tractions_that_shape_the_body_like_the_punch_leave_a_uniform_pressure(tmp_path):
    bare = under_a_punch(tmp_path, {}, {"reduced_pressure": 0.02}, np.inf)
    k = grid.wavenumbers(128) / 2
    shaping = grid.signal(-k * grid.coefficients(bare["height"].values), 128)
    result = under_a_punch(tmp_path, {}, {"reduced_pressure": 0.02}, np.inf, normal_traction=shaping)
    np.testing.assert_allclose(result["pressure"], 0.02 * 0.01, rtol=1e-6)
    assert float(result["contact_area_fraction"]) == 1.0


def test_tractions_are_part_of_the_identity_and_of_the_effects():
    scene = {
        "body": {"poissons_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.01},
    }
    drawn = FacingSurfaces(RandomSurface(SelfAffineWaves(0.8, 2, 32), 128, 0), 0.01)

    def reduced(*prescribed):
        return reduce(Scene.model_validate(scene), drawn, Numerics(), (), *prescribed)

    problem, effects = reduced()
    assert problem.tractions is None
    assert [e.state for e in effects if e.name == "prescribed tractions"] == ["off"]
    one, two = (reduced(Tractions.of(SHEAR, wave)) for wave in (WAVE, 2 * WAVE))
    assert len({problem.identity, one[0].identity, two[0].identity}) == 3
    assert [e.state for e in one[1] if e.name == "prescribed tractions"] == ["on"]
    assert one[0].body.poissons_ratio == 0.3  # tangential tractions move the surface up and down by it
    scene["body"]["aspect_ratio"] = 6.0
    assert reduced(Tractions.of(SHEAR, WAVE))[0].body.aspect_ratio == 6.0  # however deep, its mean shear counts
    assert reduced()[0].body.aspect_ratio is None
