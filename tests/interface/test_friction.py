"""Both displacements together: the coupled stiffness on the grid, sticking, sliding, and closed forms."""

import numpy as np
import pytest
import slab_stiffness

import gfmd_numba
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import begin, equilibrate
from gfmd_numba.solvers.iteration import HARD_WALL, Batch, Start
from gfmd_numba.solvers.table import Options

NX = 256
BODIES = [
    ElasticBody(0.2, None).response((NX,)),
    ElasticBody(0.2, 0.1).response((NX,)),
    ElasticBody(0.49, 0.3).response((NX,)),
]
COUPLED = {"half-space": BODIES[0], "slab": BODIES[1], "nearly incompressible": BODIES[2]}


def restored(body, u1, u3):
    """Tractions (tangential, normal) that a displacement calls up on the body, by NumPy's transforms."""
    c1, c3 = grid.coefficients(u1), grid.coefficients(u3)
    f1 = body.elements[0] * c1 + 1j * body.elements[1] * c3
    f3 = body.normal * c3 - 1j * body.elements[1] * c1
    return grid.signal(f1, u1.shape[-1]), grid.signal(f3, u1.shape[-1])


def press(punch, body, load, friction, **numerics):
    interface = Interactions(hard_wall=True, friction=friction)
    result = equilibrate(punch, body, load, Options("verlet", **numerics), interface)
    assert (result.status == 0).all()
    return result


def rough(nx=NX):
    heights = self_affine.SelfAffineWaves(0.8, 2, 32).heights((nx,), 1, range(3))
    return heights.max(axis=1, keepdims=True) - heights


@pytest.mark.parametrize("body", COUPLED.values(), ids=COUPLED)
def test_tractions_are_the_gradient_of_the_energy(body):
    rng = np.random.default_rng(3)
    u1, u3 = rng.normal(size=(2, NX))

    def energy(u1, u3):
        f1, f3 = restored(body, u1, u3)
        return 0.5 * (u1 * f1 + u3 * f3).mean()

    f1, f3 = restored(body, u1, u3)
    direction, h = rng.normal(size=(2, NX)), 1e-4
    slope = (
        energy(u1 + h * direction[0], u3 + h * direction[1]) - energy(u1 - h * direction[0], u3 - h * direction[1])
    ) / (2 * h)
    assert (f1 * direction[0] + f3 * direction[1]).mean() == pytest.approx(slope, rel=1e-9)
    assert energy(u1, u3) > 0.0
    v1, v3 = rng.normal(size=(2, NX))
    g1, g3 = restored(body, v1, v3)  # reciprocity
    assert (v1 * f1 + v3 * f3).mean() == pytest.approx((u1 * g1 + u3 * g3).mean(), rel=1e-12)


@pytest.mark.parametrize("nu", [-0.5, 0.0, 0.3, 0.5])
def test_normal_pressure_draws_the_surface_together(nu):
    """Johnson (1985), 2.25a: the tangential strain under a pressure p is -(1 - 2 nu)(1 + nu) p / E."""
    body, n = ElasticBody(nu, None).response((NX,)), 12
    x = np.arange(NX) / NX
    pressure = np.cos(2 * np.pi * n * x + 0.3)
    c3 = -grid.coefficients(pressure)  # pressure pushes the body down
    q = grid.wavenumbers(NX)
    det = body.elements[0] * body.normal - body.elements[1] ** 2
    with np.errstate(invalid="ignore", divide="ignore"):
        u1 = np.where(q > 0, -1j * body.elements[1] / det * c3, 0.0)
    strain = grid.signal(1j * q * u1, NX)
    young = 1 - nu**2  # in E*
    np.testing.assert_allclose(strain, -(1 - 2 * nu) * (1 + nu) / young * pressure, atol=1e-13)


@pytest.mark.parametrize(("nu", "aspect_ratio"), [(0.2, None), (0.2, 0.1), (0.49, 0.5), (0.5, None)])
@pytest.mark.parametrize("nx", [256, 255])
def test_without_friction_both_components_equal_the_condensed_one(nu, aspect_ratio, nx):
    heights = self_affine.SelfAffineWaves(0.8, 2, 32).heights((nx,), 1, range(3))
    punch, q = heights.max(axis=1, keepdims=True) - heights, grid.wavenumbers(nx)
    both = ElasticBody(nu, aspect_ratio).response((nx,))
    one = stiffness.half_space(q) if aspect_ratio is None else slab_stiffness.slab(q, nu, aspect_ratio)
    np.testing.assert_allclose(both.condensed().normal, one, rtol=1e-13)
    coupled = press(punch, both, 0.05, 0.0, residual=1e-10)
    condensed = equilibrate(punch, SpectralResponse.of_normal(one), 0.05, Options("verlet", residual=1e-10))
    np.testing.assert_array_equal(coupled.touching, condensed.touching)
    np.testing.assert_allclose(coupled.pressure, condensed.pressure, atol=3e-8 * condensed.pressure.max())
    assert abs(coupled.tangential.traction).max() < 1e-10 * condensed.pressure.max()


def test_transforms_are_one_pair_per_component():
    result = press(rough(), BODIES[0], 0.05, 0.3)
    np.testing.assert_array_equal(result.n_transforms, 4 * (result.n_iterations + 1))


@pytest.mark.parametrize("friction", [0.05, 0.2])
def test_coulomb_bounds_the_traction(friction):
    punch = rough()
    result = press(punch, BODIES[1], 0.05, friction)
    traction, pressure = abs(result.tangential.traction[:, 0]), result.pressure
    tolerance = 1e-7 * pressure.max()
    assert (traction <= friction * pressure + tolerance).all()
    f1, f3 = restored(BODIES[1], result.tangential.displacement[:, 0], result.displacement)
    np.testing.assert_allclose(f1, result.tangential.traction[:, 0], atol=tolerance)
    np.testing.assert_allclose(0.05 - f3 + f3.mean(axis=1, keepdims=True), pressure, atol=tolerance)
    slipping = traction[result.touching] > 0.999 * friction * pressure[result.touching]
    assert slipping.any()
    assert not slipping.all()


def flat_punch(nx, nodes):
    punch = np.full((1, nx), 10.0)
    first = (nx - nodes) // 2
    punch[0, first : first + nodes] = 0.0
    return punch, (np.arange(nx) - first - (nodes - 1) / 2) / nx


def flat_punch_error(nx, nodes, nu, friction, pressure, shear, smooth):
    """Largest error of both tractions over the mean contact pressure, in the inner 80 % of the contact.

    The sharp edge of a sticking punch leaves a sawtooth from node to node (the coupling is a spectral derivative),
    so its tractions are compared as means over neighbours.
    """
    punch, x = flat_punch(nx, nodes)
    load, half_width = 0.01, nodes / nx / 2
    result = press(punch, ElasticBody(nu, None).response((nx,)), load, friction)
    assert result.touching.sum() == nodes
    inside = abs(x) < 0.8 * half_width
    scale = load / (2 * half_width)
    errors = []
    for computed, exact in ((result.pressure[0], pressure), (result.tangential.traction[0, 0], shear)):
        error = (computed[inside] - load * exact(x[inside], half_width)) / scale
        errors.append(abs(error[:-2] + 2 * error[1:-1] + error[2:] if smooth else 4 * error).max() / 4)
    return errors


def frictionless(x, a):
    """Row of flat punches at distance 1, per mean pressure: cos(pi x) / sqrt(sin^2(pi a) - sin^2(pi x))."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.cos(np.pi * x) / np.sqrt(np.sin(np.pi * a) ** 2 - np.sin(np.pi * x) ** 2)


def test_a_frictionless_flat_punch_has_its_closed_form():
    errors = [
        flat_punch_error(nx, nx // 8, 0.2, 0.0, frictionless, lambda x, a: 0 * x, smooth=False)[0] for nx in (256, 1024)
    ]
    assert errors[1] < 0.011
    assert np.log(errors[0] / errors[1]) / np.log(4) == pytest.approx(1.0, abs=0.2)  # order 1


def test_a_sticking_flat_punch_has_its_closed_form():
    """Johnson (1985), 2.69 for one punch; these stand in a row, 32 punch widths apart."""
    nu = 0.3
    kappa = 3 - 4 * nu
    eta = np.log(kappa) / (2 * np.pi)

    def amplitude(x, a):
        with np.errstate(invalid="ignore", divide="ignore"):
            return 2 * (1 - nu) / np.sqrt(kappa) / (np.pi * np.sqrt(a**2 - x**2)), eta * np.log((a + x) / (a - x))

    def pressure(x, a):
        size, phase = amplitude(x, a)
        return size * np.cos(phase)

    def shear(x, a):
        size, phase = amplitude(x, a)
        return size * np.sin(phase)

    coarse, fine = (flat_punch_error(nx, nx // 32, nu, np.inf, pressure, shear, smooth=True) for nx in (512, 2048))
    assert fine[0] < 0.015
    assert fine[0] < 0.6 * coarse[0]  # order 1/2 or better
    assert fine[1] < 0.02  # of which the neighbouring punches make about half
    sliding = flat_punch_error(2048, 64, nu, 0.0, pressure, shear, smooth=True)
    assert sliding[0] > 1.5 * fine[0]
    assert sliding[1] > 10 * fine[1]


def sliding_scene(friction, path):
    return {
        "scene": {
            "length": 1e-4,
            "body": {"youngs_modulus": 1e9, "poissons_ratio": 0.3, "aspect_ratio": 0.3},
            "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
            "interface": {"hard_wall": {}, "friction": {"coefficient": friction}},
            "loading": {"reduced_pressure": 0.1},
        },
        "discretisation": {"eps_c": 0.25, "eps_f": 1 / 16, "eps_t": 0.5},
        "path": path,
    }


@pytest.mark.filterwarnings("ignore:the punch has slid")
def test_a_dragged_punch_sticks_then_slides():
    """Small drags are carried elastically and reversibly; far ones slide at friction times load."""
    result = gfmd_numba.solve(sliding_scene(0.3, [{"sliding": s} for s in (1e-10, 2e-10, 1e-6, 2e-6)]))
    assert (result["status"] == 0).all()
    shear = result["tangential_traction"].mean("x").values
    carried = 0.3 * result["mean_pressure"].values
    assert abs(shear[0]) < 0.01 * carried[0]
    assert (shear[2] - shear[1]) == pytest.approx(shear[1] - shear[0], rel=0.1)
    assert shear[3] == pytest.approx(carried[3], rel=0.05)
    assert shear[4] == pytest.approx(carried[4], rel=1e-5)
    pressure, traction = result["pressure"].values, result["tangential_traction"].values
    np.testing.assert_allclose(traction[-1], 0.3 * pressure[-1], atol=1e-6 * pressure.max())


def test_loading_and_unloading_differ_with_friction_only():
    loads = [{"reduced_pressure": p} for p in (0.2, 0.4, 0.2, 0.1)]
    for friction, hysteresis in ((1e-9, False), (0.2, True)):
        result = gfmd_numba.solve(sliding_scene(friction, loads))
        traction = result["tangential_traction"].values
        difference = abs(traction[0] - traction[-1]).max() / float(result["pressure"].max())
        assert (difference > 0.01) == hysteresis


def test_an_absent_component_takes_no_memory():
    """A frictionless step holds displacement, last displacement, wall, result, spectrum and stiffness, which all rows
    share, with friction twice the displacements besides, the anchors, and three elements of the stiffness."""
    punch, rows, nx = rough(), 3, NX
    load, start, free = np.full(rows, 0.05), Start.at_rest(punch), stiffness.half_space(grid.wavenumbers(nx))
    one = begin(Batch(punch, SpectralResponse.of_normal(free), load, HARD_WALL, start), Options("verlet"))
    touching = Interactions(True, friction=0.3)
    both = begin(Batch(punch, BODIES[0].with_mean(0.0), load, touching, start), Options("verlet"))

    def grids(value, seen):
        if isinstance(value, np.ndarray):
            owner = value if value.base is None else value.base
            if id(owner) in seen or value.ndim < 2:
                return 0.0
            seen.add(id(owner))
            return value.nbytes / (rows * nx * 8)
        if isinstance(value, list | tuple):
            return sum(grids(each, seen) for each in value)
        return sum(grids(each, seen) for each in vars(value).values()) if hasattr(value, "__dict__") else 0.0

    assert grids(one, set()) == pytest.approx(5 + 0.5 / 3, abs=0.2)
    assert grids(both, set()) == pytest.approx(2 * 4 + 2 + 0.5, abs=0.3)
