"""The balance of energy along a path, compared with what slipping nodes take and with the energy of a branch."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.contact import solution
from gfmd_numba.contact.contact_input import read_contact
from gfmd_numba.contact.energy_balance import EnergyBalance
from gfmd_numba.contact.load_path import PathRecord, solve_path
from gfmd_numba.contact.validity import _coarse_steps
from gfmd_numba.fourier import grid
from gfmd_numba.scene import load_scene
from support.cases import some_of
from support.friction_losses import slipping_losses

SCENE = {
    "body": {"poissons_ratio": 0.0},
    "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
    "interface": {"hard_wall": {}, "friction": {"coefficient": 0.2}},
    "loading": {"reduced_pressure": 0.02},
}
LAW = {"work_of_adhesion": -1e-6, "range": 1e-3}
FILE = {"scene": SCENE, "discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1 / 2}, "seed": 1}


@pytest.mark.long
def test_a_cycle_of_pressure_on_a_half_space_loses_what_slips():
    """No energy of the mean displacement is known there; the work of the pressure makes up for it."""
    steps = 3
    rise = np.linspace(0.02, 0.1, steps + 1)
    loads = np.concatenate([rise[1:], rise[-2::-1], rise[1:], rise[-2::-1]])
    path = gfmd_numba.solve(FILE | {"path": [{"reduced_pressure": float(load)} for load in loads]})
    cycle = slice(-2 * steps, None)
    taken = slipping_losses(path, 0.2)[cycle].sum()
    assert float(path["energy_lost"][cycle].sum()) == pytest.approx(taken, rel=1e-3)
    assert taken > 0.0


@pytest.mark.parametrize(
    ("there", "back", "law"), some_of([(1, 3, {}), (6, 3, {"exponential": LAW})], 1), ids=["wall", "law"]
)
def test_every_step_of_a_pressure_loses_what_slips_and_no_more(there, back, law):
    """Also where the way back has other steps: what only repels takes no energy, however long the steps are."""
    loads = [*np.linspace(0.02, 0.1, there + 1)[1:], *np.linspace(0.1, 0.02, back + 1)[1:]]
    scene = SCENE | {"interface": SCENE["interface"] | law}
    path = gfmd_numba.solve(FILE | {"scene": scene, "path": [{"reduced_pressure": float(load)} for load in loads]})
    assert (path["status"] == 0).all()
    repelled = -LAW["work_of_adhesion"] / LAW["range"] * np.exp(-path["gap"] / LAW["range"]) if law else 0.0
    taken = slipping_losses(path, 0.2, path["pressure"] - repelled)
    np.testing.assert_allclose(path["energy_lost"][1:], taken, atol=1e-3 * taken.sum())
    assert float(path["hysteresis"]) == pytest.approx(taken.sum(), rel=1e-3)
    assert taken.sum() > 0.0


@pytest.mark.long
@pytest.mark.parametrize(
    ("dimension", "law"),
    [(1, {"exponential": LAW}), (2, {"exponential": LAW})],
)
def test_slip_that_reverses_within_a_step_loses_as_much_as_in_short_steps(dimension, law):
    """Slip loses its friction, wherever in the step it turns round, but for pressures that change in the step."""
    scene = SCENE | {"body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5}, "loading": {"reduced_pressure": 0.05}}
    scene |= {"dimension": dimension, "interface": SCENE["interface"] | law}
    eps = {"eps_c": 1 / 4, "eps_f": 1 / 8 if dimension == 1 else 1 / 4, "eps_t": 1 / 2}
    lost = []
    for steps in (1, 4):
        way = np.concatenate([np.linspace(0.0, 5e-4, steps + 1)[1:], np.linspace(5e-4, -5e-4, steps + 1)[1:]])
        path = [{"sliding": float(sliding)} for sliding in way]
        found = gfmd_numba.solve({"scene": scene, "discretisation": eps, "seed": 1, "path": path})
        assert (found["status"] == 0).all()
        lost.append(found["energy_lost"].values[1:].reshape(2, steps).sum(axis=1))
    once, finely = lost
    np.testing.assert_allclose(once, finely, rtol=0.05)
    assert (finely > 0.0).all()


@pytest.mark.parametrize(
    ("loading", "path"),
    [
        ({"displacement": 1e-4}, [{"displacement": 5e-4}, {"displacement": -1e-4}]),
        ({"reduced_pressure": 0.02}, [{"reduced_pressure": 0.05}, {"reduced_pressure": 0.01}]),
    ],
)
def test_the_energy_is_that_of_the_waves_without_friction(loading, path):
    """Here the waves of the displacement add up; the balance has tractions times displacements (Clapeyron)."""
    law = {"exponential": {"work_of_adhesion": 2e-5, "range": 1e-3}}
    scene = SCENE | {"body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5}, "interface": {"hard_wall": {}} | law}
    whole, _ = read_contact(*load_scene(FILE | {"scene": scene | {"loading": loading}, "path": path})).reduced
    for problem, contact in zip(whole.at_each_load, solve_path(whole, 0), strict=True):
        balance, u, p = (
            EnergyBalance.of(problem, contact),
            contact.equilibrium.displacement[0],
            contact.equilibrium.pressure[0],
        )
        stiffness = solution.condensed_stiffness(problem, grid.magnitudes(u.shape))
        if problem.mean_pressure is not None:
            stiffness[0] = 0.0
        waves = np.abs(grid.coefficients(u)) ** 2 * grid.multiplicity(u.size)
        energy = 0.5 * np.vdot(stiffness, waves) + problem.interface.normal_law.energy(contact.punch[0] - u).mean()
        assert balance.potential == pytest.approx(energy - (problem.mean_pressure or 0.0) * u.mean(), rel=1e-6)
        assert balance.force == pytest.approx(-u.mean() if problem.displacement is None else p.mean())


def test_energy_that_a_later_step_gives_back_was_not_lost():
    record = PathRecord()
    record.steps["energy_lost"], record._certain = [0.0, 2.0, -1.0, 3.0, -0.5, np.nan], [0.0] * 6
    np.testing.assert_array_equal(record.of_steps()["energy_lost"], [0.0, 1.0, 0.0, 2.5, 0.0, np.nan])
    record.steps["energy_lost"], record._certain = [0.0, 0.25, -0.75], [0.0] * 3
    np.testing.assert_array_equal(record.of_steps()["energy_lost"], 0.0)


@pytest.mark.parametrize("seed", [1])
def test_a_closed_cycle_in_few_steps_under_attraction_never_loses_less_than_nothing(seed):
    load = [1e-3, 1e-2, 0.1, 1e-2, 1e-3]
    scene = {
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05},
        "interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": 2e-6, "range": 1e-3}},
        "loading": {"reduced_pressure": load[0]},
    }
    path = [{"reduced_pressure": each} for each in load[1:]]
    eps = {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1 / 2}
    found = gfmd_numba.solve({"scene": scene, "path": path, "discretisation": eps, "seed": seed})
    assert (found["status"] == 0).all()
    assert (found["energy_lost"] >= 0.0).all()
    assert float(found["hysteresis"]) == pytest.approx(float(found["energy_lost"].sum()), abs=1e-18)


@pytest.mark.long
def test_a_ball_that_is_drawn_off_loses_little_down_the_tail_of_its_attraction():
    """In steps of 10 nm it loses 15 uJ/m^2 in all; forces linear over 300 nm of the tail would lose 245 more."""
    attraction = {"work_of_adhesion": "20 mJ/m^2", "range": "100 nm"}
    scene = {
        "periodic": False,
        "dimension": 2,
        "length": "20 um",
        "body": {"youngs_modulus": "3 MPa", "poissons_ratio": 0.5},
        "form": {"radius": "50 um", "points": 32},
        "interface": {"hard_wall": {}, "exponential": attraction},
        "loading": {"displacement": 0.0},
    }
    path = [{"displacement": f"{d} nm"} for d in (-160, -200, -500, -1000)]
    found = gfmd_numba.solve({"scene": scene, "path": path})
    assert (found["status"] == 0).all()
    assert 0.0 <= float(found["energy_lost"][3:].sum()) < 10e-6


def test_a_loss_where_nothing_jumps_is_warned_of():
    scene = {
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.1},
        "form": {"radius": 5.0, "points": 32},
        "interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": 1e-6, "range": 0.02}},
        "loading": {"displacement": 1e-3},
    }
    dataset = gfmd_numba.solve({"scene": scene, "path": [{"displacement": -2e-3}]})
    found = {name: variable.values for name, variable in dataset.variables.items()}
    spoilt = found | {"energy_lost": np.array([0.0, 1e-6]), "jump_displacement": np.array([np.nan, np.nan])}
    given = read_contact(*load_scene({"scene": scene}))
    assert "lies in steps without a jump" in _coarse_steps(given, spoilt)
    assert _coarse_steps(given, spoilt | {"jump_displacement": np.array([np.nan, 0.0])}) == ""
    unfelt = {name: np.zeros(2) for name in ("energy_lost", "mean_pressure")}  # the surfaces are too far apart
    assert _coarse_steps(given, spoilt | unfelt) == ""
