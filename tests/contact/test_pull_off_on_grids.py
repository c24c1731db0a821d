"""Pull-off of a wave on a grid is off by what the resolution of its law says, and has the known limits."""

import runpy
from pathlib import Path

import numpy as np
import pytest
import slab_stiffness
from scipy.special import ive

import gfmd_numba
from gfmd_numba.contact.relative_softening import COARSEST
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.table import Options

AMPLITUDE, WORK, RANGE = 0.1, 6e-3, 2e-3
OPTIONS = Options("truncated_newton", residual=1e-6)


def pull_off(nodes):
    """Largest tension of a wave on a slab of height 1, drawn back in short steps, and x."""
    law, x = Interactions(True, ExponentialLaw(WORK, 2 * RANGE)), np.arange(nodes) / nodes
    body = slab_stiffness.slab(grid.wavenumbers(nodes), 0.3, 1.0)
    before, most = None, 0.0
    for displacement in np.arange(-0.04, -0.12, -2e-3):
        punch = (AMPLITUDE * (1 - np.cos(2 * np.pi * x)) - displacement)[np.newaxis]
        if before is None:  # on the branch in contact
            punch_in = punch - 0.04
            before = equilibrate(punch_in, SpectralResponse.of_normal(body), None, OPTIONS, law)
        before = equilibrate(punch, SpectralResponse.of_normal(body), None, OPTIONS, law, following(before, punch, 0.0))
        assert before.status[0] == 0
        tension = -before.pressure.mean()
        if tension < 0.5 * most:  # it has let go
            break
        most = max(most, tension)
    return most, law.softening / body[-1]


@pytest.mark.long
def test_pull_off_of_a_wave_is_off_by_what_x_says():
    """Johnson, Int. J. Solids Struct. 32:423 (1995): p = p* sin^2 psi - (2 E* w tan psi / L_x)^(1/2)."""
    psi = np.linspace(1e-3, 0.6, 100001)
    exact = -(np.pi * AMPLITUDE * np.sin(psi) ** 2 - np.sqrt(2 * WORK * np.tan(psi))).min()
    found = {x: tension / exact - 1 for tension, x in map(pull_off, (128, 256, 1280))}
    np.testing.assert_allclose(list(found), [1.865, 0.933, 0.187], rtol=3e-3)
    np.testing.assert_allclose(list(found.values())[:2], [0.93, 0.28], rtol=0.05)
    assert all((abs(error) < 0.01) == (x < COARSEST) for x, error in found.items())


def first_pull_off(nodes, work, tabor):
    """Largest tension on the branch that is drawn back from first touch, and x."""
    stretch = (work**2 / (4 * np.pi**2 * AMPLITUDE)) ** (1 / 3)
    law = ExponentialLaw(work, stretch / tabor)
    body = slab_stiffness.slab(grid.wavenumbers(nodes), 0.3, 1.0)
    punch, before, most = AMPLITUDE * (1 - np.cos(2 * np.pi * np.arange(nodes) / nodes))[np.newaxis], None, 0.0
    while before is None or before.touching.any():
        start = None if before is None else following(before, punch, 0.0)
        before = equilibrate(punch, SpectralResponse.of_normal(body), None, OPTIONS, Interactions(True, law), start)
        assert before.status[0] == 0
        most, punch = max(most, -before.pressure.mean()), punch + min(stretch / 25, law.length / 4)
    return most, law.softening / body[-1]


@pytest.mark.long
@pytest.mark.parametrize(("tabor", "nodes"), [(0.5, 64), (2, 256)])
def test_where_no_warning_is_given_pull_off_is_that_of_a_fine_grid(tabor, nodes):
    (coarse, x), (fine, _) = (first_pull_off(each, WORK, tabor) for each in (nodes, 4 * nodes))
    assert x < COARSEST
    assert coarse == pytest.approx(fine, rel=0.01)


@pytest.mark.long
def test_pull_off_tends_to_that_of_a_short_range():
    """Johnson's closed form is the limit of large Tabor parameters, and is not to be had at small ones."""
    psi = np.linspace(1e-3, 1.2, 100001)
    exact = -(np.pi * AMPLITUDE * np.sin(psi) ** 2 - np.sqrt(2 * WORK * np.tan(psi))).min()
    assert first_pull_off(2048, WORK, 4.9)[0] / exact - 1 == pytest.approx(0.0, abs=2e-3)


def test_pull_off_tends_to_that_of_a_rigid_body():
    """The mean of the law's traction over a wave that touches in one point is a Bessel function."""
    tabor, stretch = 0.02, (WORK**2 / (4 * np.pi**2 * AMPLITUDE)) ** (1 / 3)
    length = stretch / tabor
    exact = WORK / length * ive(0, AMPLITUDE / length)
    assert first_pull_off(128, WORK, tabor)[0] == pytest.approx(exact, rel=1e-3)


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")  # of the grid and of slopes
@pytest.mark.parametrize(
    ("laws", "step", "most"),
    [(["hard_wall", "exponential"], 0.4, 6.105), (["lennard_jones"], 0.2, 6.097)],
)
def test_pull_off_of_a_stiff_tip_does_not_depend_on_the_step(laws, step, most):
    """Without a jump, and of two elastic bodies, whose steps are not divided; in nN, as steps of 0.002 nm find it."""
    interface = {
        name: {"work_of_adhesion": "50 mJ/m^2", "range": "0.2 nm"} if name != "hard_wall" else {} for name in laws
    }
    scene = {
        "periodic": False,
        "dimension": 2,
        "length": "20 nm",
        "body": {"youngs_modulus": "72 GPa", "poissons_ratio": 0.17},
        "counter_body": {"youngs_modulus": "130 GPa", "poissons_ratio": 0.27},
        "form": {"radius": "20 nm", "points": 64},
        "interface": interface,
        "loading": {"displacement": "0.35 nm"},
    }
    path = [{"displacement": f"{each:.2f} nm"} for each in np.arange(0.35 - step, -0.7, -step)]
    found = gfmd_numba.solve({"scene": scene, "path": path})
    assert float(found["pull_off_pressure"]) * (20e-9) ** 2 == pytest.approx(most * 1e-9, rel=0.005)


@pytest.mark.long
@pytest.mark.parametrize(("parameter", "taper"), [(0.5, 0.2)])
def test_pull_off_of_a_ball_under_a_constant_attraction_is_that_of_maugis(parameter, taper):
    """Within 0.5 % of the closed form of Maugis (1992), between Bradley's 2 pi w R and 3/2 pi w R of JKR."""
    benchmark = runpy.run_path(str(Path(__file__).parents[2] / "benchmarks" / "maugis_pull_off.py"))
    force, x, _ = benchmark["pull_off"](64, parameter, taper)
    assert x < COARSEST
    assert force == pytest.approx(benchmark["pull_off_of_closed_form"](parameter)[0], rel=5e-3)
    for limit, expected in ((1e-3, -2.0), (1e2, -1.5)):
        assert benchmark["pull_off_of_closed_form"](limit)[0] == pytest.approx(expected, rel=2e-3)
