"""Load paths under a cohesive law keep to their branch: jumps of gap and of slip are located, with the energy lost."""

import numpy as np
import pytest
from scipy.optimize import brentq

import gfmd_numba
from gfmd_numba.elasticity.body import ElasticBody
from support.laws import area_of_loop, nearly_flat

WORK, NORMAL, TANGENTIAL = 0.2, 0.03, 0.05
LAW = {"work_of_adhesion": WORK, "normal_length": NORMAL, "tangential_length": TANGENTIAL}
BODY = ElasticBody(0.3, 0.1).response((256,))


def fold(traction, stiffness, between):
    """Distance and position of a rigid punch at which a spring of that stiffness no longer balances a traction."""
    h = 1e-6
    slope = lambda at: 1.0 + (traction(at + h) - traction(at - h)) / (2.0 * h * stiffness)  # noqa: E731
    distance = brentq(slope, *between)
    return distance, distance + traction(distance) / stiffness


def jumps(found, name):
    at = found[name].values
    jumped = ~np.isnan(at)
    return at[jumped], found["energy_lost"].values[jumped]


@pytest.mark.long
@pytest.mark.parametrize(
    ("step", "wall"),
    [(0.02, {"hard_wall": {}}), (0.08, {})],
    ids=["wall", "law alone"],
)
def test_gaps_of_a_flat_punch_jump_where_a_spring_does(tmp_path, step, wall):
    def pull(gap):
        return WORK / NORMAL**2 * gap * np.exp(-gap / NORMAL)

    def energy(gap, position):
        return 0.5 * k * (position - gap) ** 2 - WORK * (1.0 + gap / NORMAL) * np.exp(-gap / NORMAL)

    k = BODY.normal[0]
    (far, closes), (near, opens) = (
        fold(pull, k, between) for between in ((2 * NORMAL, 20 * NORMAL), (NORMAL, 2 * NORMAL))
    )
    near_closing, near_opening = (np.arange(-0.3, 1.0) * step + position for position in (closes, opens))
    path = -np.concatenate([near_closing[::-1], [0.0], near_opening])
    found = nearly_flat(tmp_path, path[1:].tolist(), path[0], cohesive=LAW, **wall)
    assert (found["status"] == 0).all()
    at, lost = jumps(found, "jump_displacement")
    np.testing.assert_allclose(at, [-closes, -opens], atol=5e-4)
    landed = brentq(lambda gap: gap + pull(gap) / k - closes, 0.0, near)
    apart = brentq(lambda gap: gap + pull(gap) / k - opens, far, 2 * opens)
    expected = [energy(far, closes) - energy(landed, closes), energy(near, opens) - energy(apart, opens)]
    np.testing.assert_allclose(lost, expected, rtol=0.02)


@pytest.mark.filterwarnings("ignore:the punch has slid")
@pytest.mark.parametrize("step", [0.05])
def test_a_flat_punch_that_is_dragged_lets_go_where_a_spring_does(tmp_path, step):
    def drag(slip):
        return 2.0 * WORK / TANGENTIAL**2 * slip * np.exp(-((slip / TANGENTIAL) ** 2))

    k = BODY.elements[0][0]
    near, lets_go = fold(drag, k, (0.5 * TANGENTIAL, 1.2 * TANGENTIAL))
    path = [{"sliding": float(sliding)} for sliding in np.arange(lets_go - 0.5 * step, lets_go + step, step)]
    found = nearly_flat(tmp_path, path, 0.02, hard_wall={}, cohesive=LAW)
    assert (found["status"] == 0).all()
    at, lost = jumps(found, "jump_sliding")
    np.testing.assert_allclose(at, [lets_go], atol=1e-3)
    apart = brentq(lambda slip: slip + drag(slip) / k - lets_go, 1.5 * TANGENTIAL, 2 * lets_go)
    energy = [0.5 * k * (lets_go - slip) ** 2 - WORK * np.exp(-((slip / TANGENTIAL) ** 2)) for slip in (near, apart)]
    np.testing.assert_allclose(lost, energy[0] - energy[1], rtol=0.02)
    assert found["jump_displacement"].dropna("step").values == pytest.approx(0.02)


def loop(positions, key):
    """A wave on a slab that is pressed and drawn off, or dragged to and fro."""
    x = np.arange(128) / 128
    scene = {
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 1},
        "roughness": {"method": "measured", "heights": 0.1 * np.cos(2 * np.pi * x)},
        "interface": {
            "hard_wall": {},
            "cohesive": {"work_of_adhesion": 6e-3, "normal_length": 5e-3, "tangential_length": 9e-3},
        },
        "loading": {"displacement": positions[0] if key == "displacement" else 0.02},
    }
    found = gfmd_numba.solve({"scene": scene, "path": [{key: float(position)} for position in positions[1:]]})
    assert (found["status"] == 0).all()
    return found


def drawn_off(step):
    down = np.linspace(-0.06, 0.02, round(0.08 / step) + 1)
    return np.concatenate([down, np.arange(0.02 - step, -0.09, -step)])


def dragged(step):
    return np.concatenate([np.arange(0.0, 0.25, step), np.arange(0.25 - step, -0.05, -step)])


LOOPS = pytest.mark.parametrize(
    ("positions", "steps", "key"),
    [(drawn_off, (2e-2, 4e-3), "displacement"), (dragged, (4e-2, 2e-2), "sliding")],
    ids=["drawn off", "dragged"],
)


@pytest.mark.long
@LOOPS
@pytest.mark.filterwarnings("ignore:an rms gradient of 0.444")
@pytest.mark.filterwarnings("ignore:the grid does not resolve")  # which changes no balance of energy
def test_the_energy_lost_in_a_loop_knows_no_step(positions, steps, key):
    found = [loop(positions(step), key) for step in steps]
    lost = [float(each["energy_lost"].sum()) for each in found]
    assert lost[0] == pytest.approx(lost[1], rel=0.01)
    located = [jumps(each, f"jump_{key}")[0] for each in found]
    assert len(located[0]) == 2
    np.testing.assert_allclose(*located, atol=2e-5)
    if key == "displacement":  # the loop is closed by next to no force
        assert lost[1] == pytest.approx(area_of_loop(positions(steps[1]), found[1]), rel=0.01)
