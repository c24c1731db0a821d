"""Laws of the gap on maps: the profile that a ridge is, forces that balance, solvers that agree, JKR and DMT."""

import numpy as np
import pytest
import slab_stiffness

import gfmd_numba
from gfmd_numba.arrays.regions import on_wall
from gfmd_numba.contact.jumps import smallest_curvature
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.table import Options
from support import adhesive_sphere
from support.maps import body, rough

SOLVERS = ("truncated_newton", "verlet", "gronbech_jensen", "fire")
LAWS = {
    "adhesive wall": Interactions(True, ExponentialLaw(0.002, 0.01)),
    "repulsive wall": Interactions(True, ExponentialLaw(-0.002, 0.01)),
    "repulsive": Interactions(False, ExponentialLaw(-0.002, 0.01)),
}
TIGHT = 1e-11


@pytest.mark.parametrize("solver", ["truncated_newton", "verlet"])
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("slab", [None, (0.33, 0.1)])
def test_a_ridge_is_the_profile(solver, law, slab):
    """On a half-space under a pressure, on a slab under a displacement."""
    heights = self_affine.SelfAffineWaves(0.8, 2, 16).heights((64,), 1, range(1))
    profile = heights.max(axis=1, keepdims=True) - heights
    load = 0.05 if slab is None else None
    if load is None:
        profile -= 0.02
    ridge = np.repeat(profile[:, np.newaxis], 12, axis=1)
    options = Options(solver, residual=TIGHT)
    expected = equilibrate(profile, SpectralResponse.of_normal(body((64,), slab)), load, options, LAWS[law])
    found = equilibrate(ridge, SpectralResponse.of_normal(body((12, 64), slab)), load, options, LAWS[law])
    assert found.status[0] == expected.status[0] == 0
    scale = abs(expected.pressure).max()
    np.testing.assert_allclose(found.pressure[0], np.broadcast_to(expected.pressure, (12, 64)), atol=1e-8 * scale)
    across = found.pressure[0].T  # a ridge along x, of the transposed map
    turned = equilibrate(
        ridge.swapaxes(1, 2).copy(), SpectralResponse.of_normal(body((64, 12), slab)), load, options, LAWS[law]
    )
    np.testing.assert_allclose(turned.pressure[0], across, atol=1e-8 * scale)


@pytest.mark.parametrize("load", [0.03, None])
@pytest.mark.parametrize("law", LAWS)
def test_forces_balance_and_all_solvers_find_the_same(law, load):
    interface, slab = LAWS[law], None if load else (0.33, 0.2)
    punch, stiff = rough(32, range(2)), body((32, 32), slab)
    if load is None:
        punch -= 0.01
    found = [
        equilibrate(punch, SpectralResponse.of_normal(stiff), load, Options(solver), interface) for solver in SOLVERS
    ]
    for result in found:
        assert (result.status == 0).all()
        restoring = grid.signal(stiff * grid.coefficients(result.displacement, 2), 32, 32)
        balance = (load or 0.0) - restoring - result.pressure
        np.testing.assert_allclose(balance, 0.0, atol=3e-8 * abs(found[0].pressure).max() + 2e-9)
        wall = result.pressure + interface.normal_law.traction(punch - result.displacement)
        assert (wall >= -1e-8).all()
        assert result.touching.any() == interface.hard_wall
        np.testing.assert_allclose(result.pressure, found[0].pressure, atol=1e-5 * abs(found[0].pressure).max())
    if load is not None:
        np.testing.assert_allclose(found[0].pressure.mean(axis=(1, 2)), load, rtol=1e-7)


def test_a_map_under_a_law_does_not_know_its_batch():
    punch, stiff = rough(32, range(3)), body((32, 32))
    options, law = Options("truncated_newton"), LAWS["adhesive wall"]
    together = equilibrate(punch, SpectralResponse.of_normal(stiff), 0.03, options, law)
    for i in range(3):
        alone = equilibrate(punch[i : i + 1], SpectralResponse.of_normal(stiff), 0.03, options, law)
        np.testing.assert_array_equal(alone.pressure[0], together.pressure[i])


def law_of(radius_of_contact, tabor):
    work = 8.0 * radius_of_contact**3 / (9.0 * np.pi)
    return work, work ** (2.0 / 3.0) / tabor


def pull_off(nodes, radius_of_contact, tabor, step):
    """Largest tension of a paraboloid of radius L_x drawn off in steps of a part of the range; and 2 pi w R.

    JKR's radius of contact at pull-off tells the work of adhesion, a^3 = 9 pi w R^2 / 8 E*, and Tabor's parameter,
    (R w^2 / E*^2 range^3)^(1/3), the range.
    """
    work, length = law_of(radius_of_contact, tabor)
    law, x = Interactions(True, ExponentialLaw(work, length)), np.arange(nodes) / nodes - 0.5
    punch = 0.5 * (x**2 + x[:, np.newaxis] ** 2)[np.newaxis]
    stiff, before, most = body((nodes, nodes), (0.3, 1.0)), None, 0.0
    while before is None or before.touching.any():
        start = None if before is None else following(before, punch, 0.0)
        before = equilibrate(
            punch, SpectralResponse.of_normal(stiff), None, Options("truncated_newton", residual=1e-6), law, start
        )
        assert before.status[0] == 0
        most = max(most, -before.pressure.mean())
        punch = punch + step * length
    return most, 2.0 * np.pi * work


@pytest.mark.long
def test_pull_off_of_a_paraboloid_goes_from_dmt_to_jkr():
    """2 pi w R where Tabor's parameter is small, 3/2 pi w R where it is large: the rest falls as its power -3/2.

    In between it is that of rings of pressure on a half-space, but for 0.2 % by the images of the period.
    """
    tension, bradley = pull_off(64, 0.004, 0.01, 0.005)
    assert tension / bradley == pytest.approx(1.0, abs=0.01)
    beyond = {tabor: np.divide(*pull_off(256, 0.1, tabor, 0.2)) / 0.75 - 1.0 for tabor in (2.0, 3.0)}
    assert 0.02 < beyond[3.0] < beyond[2.0] < 0.06
    work, length = law_of(0.1, 2.0)
    rings = adhesive_sphere.pull_off(work, length, 200) / (1.5 * np.pi * work)
    assert 1.0 + beyond[2.0] == pytest.approx(1.002 * rings, rel=3e-3)
    falls = (2.0 / 3.0) ** 1.5
    assert (beyond[3.0] - falls * beyond[2.0]) / (1.0 - falls) == pytest.approx(0.0, abs=0.01)


def path_of(heights):
    """A loading path over a jump into contact and one out of it, of an adhesive wave or of a ridge of it."""
    steps = [-0.03, -0.1]
    scene = {
        "dimension": heights.ndim,
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 1},
        "roughness": {"method": "measured", "heights": heights},
        "interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": 6e-3, "range": 9e-3}},
        "loading": {"displacement": -0.05},
    }
    path = [{"displacement": each} for each in steps]
    return gfmd_numba.solve({"scene": scene, "path": path, "numerics": {"residual": TIGHT}})


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:an rms gradient of 0.444", "ignore:the grid does not resolve the")
def test_a_path_of_a_ridge_jumps_and_loses_energy_like_the_profile():
    profile = 0.1 * np.cos(2.0 * np.pi * np.arange(48) / 48)
    expected, found = path_of(profile), path_of(np.tile(profile, (48, 1)))
    jumped = ~np.isnan(expected["jump_displacement"].values)
    assert jumped.sum() >= 2
    for name in (
        "energy_lost",
        "jump_displacement",
        "mean_pressure",
        "contact_area_fraction_counted",
        "relative_softening",
    ):
        scale = np.nanmax(abs(expected[name].values))
        np.testing.assert_allclose(found[name].values, expected[name].values, atol=1e-8 * scale, err_msg=name)
    np.testing.assert_allclose(found["stability"].values, expected["stability"].values, atol=1e-3)


@pytest.mark.parametrize("load", [None, 0.03])
def test_the_smallest_curvature_of_a_map_is_that_of_the_dense_matrix(load):
    punch, stiff = rough(8), body((8, 8), None if load else (0.33, 0.2))
    law = ExponentialLaw(0.01, 0.05)
    found = equilibrate(
        punch, SpectralResponse.of_normal(stiff), load, Options("truncated_newton"), Interactions(True, law)
    )
    gap, held = punch[0] - found.displacement[0], found.touching[0]
    assert 0 < held.sum() < 60
    free = ~held.ravel()
    positive = np.where(stiff > 0.0, stiff, stiff.ravel()[1:].min())
    kernel, whole = (
        np.array([grid.signal(symbol * grid.coefficients(unit.reshape(8, 8), 2), 8, 8).ravel() for unit in np.eye(64)])
        for symbol in (positive, stiff)
    )
    energy = whole + np.diag(law.stiffness(gap).ravel())
    values = np.linalg.eigvals(np.linalg.solve(kernel[np.ix_(free, free)], energy[np.ix_(free, free)]))
    assert smallest_curvature(gap, held, stiff, law) == pytest.approx(values.real.min(), rel=1e-4)
    assert values.real.min() < 0.99


def test_a_uniform_gap_is_as_stable_as_its_softest_wave():
    gap, stiff = np.full((16, 16), 0.05), slab_stiffness.slab(grid.magnitudes((16, 16)), 0.3, 0.1)
    expected = 1.0 - 0.2 / 0.05**2 * np.exp(-1.0) / stiff.min()
    found = smallest_curvature(gap, np.zeros((16, 16), dtype=bool), stiff, ExponentialLaw(0.2, 0.05))
    assert found == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("dimension", [1, 2])
@pytest.mark.parametrize(
    "interface",
    [
        {"hard_wall": {}},
        {"hard_wall": {}, "exponential": {"work_of_adhesion": 3e-6, "range": 5e-4}},
        {"hard_wall": {"hardness": 0.01}},
    ],
)
def test_nodes_with_a_gap_of_zero_are_those_on_which_the_wall_presses(interface, dimension):
    scene = {
        "dimension": dimension,
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 1},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05},
        "interface": interface,
        "loading": {"displacement": 2e-3},
    }
    eps = {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1 / 2}
    found = gfmd_numba.solve({"scene": scene, "discretisation": eps})
    touching = on_wall(found["gap"])
    assert float(touching.mean()) == found["contact_area_fraction_counted"].item() > 0.0
