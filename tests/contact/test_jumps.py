"""Load paths keep to their branch: jumps are located by division, and the energy they lose is that of the loop."""

import numpy as np
import pytest
import slab_stiffness

import gfmd_numba
from gfmd_numba.fourier import grid
from support.laws import area_of_loop, nearly_flat

WORK, LENGTH = 0.2, 0.05
LAW = {"work_of_adhesion": WORK, "range": LENGTH}


def flat_energy(u, position, body):
    """Energy per area of a flat punch at a height above a slab that it moves by u."""
    return 0.5 * body * u * u - WORK * np.exp(-(position - u) / LENGTH)


def test_jumps_of_a_flat_punch_are_those_of_the_closed_form_however_long_the_step(tmp_path):
    """On approach the surface jumps where the law's gradient reaches the stiffness; it lets go at full traction."""
    step, body = 0.08, slab_stiffness.uniform(0.3, 0.1)
    gap = LENGTH * np.log(WORK / (LENGTH**2 * body))
    jump_in, pull_off = -(gap + LENGTH), -WORK / (LENGTH * body)
    path = np.concatenate([np.arange(jump_in - 2.5 * step, 0.0, step), np.arange(0.0, pull_off - 2.5 * step, -step)])
    found = nearly_flat(tmp_path, path[1:].tolist(), path[0], hard_wall={}, exponential=LAW)
    assert (found["status"] == 0).all()
    at = found["jump_displacement"].values
    jumped = np.flatnonzero(~np.isnan(at))
    assert len(jumped) == 2
    np.testing.assert_allclose(at[jumped], [jump_in, pull_off], atol=2e-4)
    # the slab jumps from where its stiffness equals the law's gradient to the wall, and back to where tractions balance
    apart = _apart(-pull_off, body)
    lost = [
        flat_energy(-jump_in - gap, -jump_in, body) - flat_energy(-jump_in, -jump_in, body),
        flat_energy(-pull_off, -pull_off, body) - flat_energy(apart, -pull_off, body),
    ]
    np.testing.assert_allclose(found["energy_lost"].values[jumped], lost, rtol=0.02)
    assert found["energy_lost"].units == "1"
    # of the softest wave, as long as the surfaces are apart
    loose = np.flatnonzero(path[: jumped[0]] < jump_in)
    gaps = found["gap"].mean("x").values[loose]
    softest = slab_stiffness.slab(grid.wavenumbers(256), 0.3, 0.1).min()
    expected = 1.0 - WORK / LENGTH**2 * np.exp(-gaps / LENGTH) / softest
    np.testing.assert_allclose(found["stability"].values[loose], expected, atol=1e-4)


def test_jumps_from_gap_to_gap_are_located_where_no_node_ever_touches(tmp_path):
    """A Maugis-Dugdale traction stretches the slab by two fifths of its range, and is all at once gone, or there."""
    body, taper = slab_stiffness.uniform(0.3, 0.1), 0.2
    work, stretched = 0.4 * body * LENGTH**2, 0.4 * LENGTH
    pull_off, jump_in = -(1.0 - taper / 2) * LENGTH - stretched, -(1.0 + taper / 2) * LENGTH
    law = {"work_of_adhesion": work, "range": LENGTH, "taper": taper}
    path = [-0.5 * LENGTH, -2.0 * LENGTH, -0.5 * LENGTH]
    found = nearly_flat(tmp_path, path[1:], path[0], hard_wall={}, maugis_dugdale=law)
    assert (found["contact_area_fraction_counted"] == 0).all()
    np.testing.assert_allclose(found["jump_displacement"].values[1:], [pull_off, jump_in], atol=1e-3 * LENGTH)
    # the stretched slab less what the law still pulls while it fades; or the law's work less the slab's
    np.testing.assert_allclose(found["energy_lost"].values[1:], 0.1 * work, rtol=0.01)
    assert "without a jump" not in found.validity


def _apart(position, body):
    """Displacement of the slab at which it balances the law, off the punch at a height above it."""
    u = 0.0
    for _ in range(500):
        u = WORK / LENGTH * np.exp(-(position - u) / LENGTH) / body
    return u


def wave(path, solver="auto"):
    x = np.arange(256) / 256
    scene = {
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 1},
        "roughness": {"method": "measured", "heights": 0.1 * np.cos(2 * np.pi * x)},
        "interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": 6e-3, "range": 9e-3}},
        "loading": {"displacement": path[0]},
    }
    steps = [{"displacement": value} for value in path[1:].tolist()]
    return gfmd_numba.solve({"scene": scene, "path": steps, "numerics": {"solver": solver}})


def loop(step):
    down = np.linspace(-0.06, 0.02, round(0.08 / step) + 1)
    return np.concatenate([down, np.arange(0.02 - step, -0.09, -step)])


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:an rms gradient of 0.444")  # of a wave for Johnson's closed form
def test_the_area_of_a_loop_is_the_energy_lost_and_knows_no_step():
    """The loop is open where the surfaces are apart, and closed by next to no force."""
    paths = [loop(step) for step in (8e-3, 2e-3)]
    found = [wave(path) for path in paths]
    assert all((each["status"] == 0).all() for each in found)
    for each in found:
        assert float(each["energy_lost"].sum()) == pytest.approx(area_of_loop(paths[1], found[1]), rel=0.01)
    located = [each["jump_displacement"].dropna("step").values for each in found]
    np.testing.assert_allclose(*located, atol=2e-5)


@pytest.mark.filterwarnings("ignore:an rms gradient of 0.444")
def test_steps_of_the_reference_solver_are_not_divided():
    assert not {"stability", "jump_displacement"} & wave(np.array([-0.06, -0.03]), "verlet").keys()


def test_paths_without_attraction_are_not_divided(tmp_path):
    repulsion = {"work_of_adhesion": -1e-3, "range": LENGTH}
    assert "energy_lost" not in nearly_flat(tmp_path, [0.02], 0.01, exponential=repulsion)


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:waves longer than two fifths")
def test_a_wall_that_nothing_reaches_changes_no_jump():
    """Under a law that leaves a gap a hard wall is never touched, so the work of adhesion gained is the law's own."""
    x = np.arange(112) / 112
    heights = 2e-3 * np.cos(2 * np.pi * x) + 2e-4 * np.cos(18 * np.pi * x + 1)
    law = {"lennard_jones": {"work_of_adhesion": 2.6e-7, "range": 1e-4}}
    body = {"poissons_ratio": 0.3, "aspect_ratio": 1}
    path = [2e-3, 0.0, -2e-3]
    without, with_a_wall = (
        gfmd_numba.solve(
            {
                "scene": {"body": body, "interface": each, "loading": {"displacement": path[0]}},
                "path": [{"displacement": one} for one in path[1:]],
            },
            heights,
        )
        for each in (law, {"hard_wall": {}} | law)
    )
    jumped = ~np.isnan(without["jump_displacement"].values)
    assert jumped.any()
    assert (without["energy_lost"].values[jumped] > 1e-10).all()
    for name in ("jump_displacement", "energy_lost"):
        np.testing.assert_allclose(with_a_wall[name], without[name], rtol=1e-6)
