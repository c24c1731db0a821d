"""Layers, prescribed tractions, a hardness and a cohesive law on rough bodies, to higher orders in their slope."""

from functools import cache

import numpy as np
import pytest
from finite_elements import Body, graded

import gfmd_numba
from gfmd_numba.elasticity import topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw

pytestmark = pytest.mark.filterwarnings("ignore:a deformable surface has an rms gradient")
NX, COLUMNS, HEIGHT = 512, 128, 0.5
OVER = NX // (2 * COLUMNS)
X = np.arange(NX) / NX
HEIGHTS = -0.02 * np.cos(2 * np.pi * X) + 0.002 * np.cos(6 * np.pi * X + 1)
DEPTH, HARDNESS = 0.006, 0.018
WALL = {"hard_wall": {}}
SLAB = {"poissons_ratio": 0.33, "aspect_ratio": HEIGHT}
TRACTIONS = {
    "normal_traction": 2e-3 * np.cos(6 * np.pi * X + 0.2),
    "tangential_traction": 3e-3 * np.sin(4 * np.pi * X) + 1e-3,
}
LAW = {"work_of_adhesion": 4e-5, "normal_length": 4e-3, "tangential_length": 4e-3}
SLIDING = 2e-3


def measured(heights):
    return {"method": "measured", "heights": heights, "units": {"z": "L_x"}}


def boundary(folder, tractions=TRACTIONS):
    for name, values in tractions.items():
        np.savetxt(folder / f"{name}.csv", values, delimiter=",")
    return {name: str(folder / f"{name}.csv") for name in tractions}


def solved(order, loading=None, path=(), heights=HEIGHTS, numerics=None, **parts):
    """A rough slab under a level rigid punch, at the last step of a path."""
    scene = {"body": SLAB, "interface": WALL, "loading": loading or {"displacement": DEPTH}} | parts
    scene["body"] = scene["body"] | {"roughness": measured(heights)}
    file = {"scene": scene, "numerics": {"topography_order": order, "residual": 1e-10} | (numerics or {})}
    found = gfmd_numba.solve(file | ({"path": list(path)} if path else {}))
    assert (found["status"] == 0).all()
    return found.isel(step=-1) if path else found


@cache
def mesh():
    def stretched(x, z):
        return 0 * x, HEIGHTS[np.rint(x * NX).astype(int) % NX] * (z / HEIGHT + 1.0)

    return Body(COLUMNS, graded(HEIGHT, 24, 0.5 / COLUMNS), 0.33, stretched)


def off(found, tangential, normal):
    """Largest differences of the displacements of a contact from those of finite elements."""
    moved = found["tangential_displacement"], found["displacement"]
    return [abs(a.values[::OVER] - b).max() for a, b in zip(moved, (tangential, normal), strict=True)]


CLEARANCE = (HEIGHTS.max() - HEIGHTS - DEPTH)[::OVER]


@pytest.mark.long
@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_prescribed_tractions_act_on_the_true_surface_as_on_finite_elements(friction, tmp_path):
    rubbing = {"interface": WALL | {"friction": {"coefficient": friction}}, "path": [{"sliding": 0.1}]}
    parts = {"boundary": boundary(tmp_path)} | (rubbing if friction else {})
    found = [solved(order, **parts) for order in (0, 1, 2)]
    given = np.array([TRACTIONS["tangential_traction"], TRACTIONS["normal_traction"]])[:, ::OVER]
    solution = mesh().press(CLEARANCE, found[2]["pressure"].values[::OVER] > 0.0, friction=friction, tractions=given)
    errors = [max(off(each, *mesh().along_top(solution))) for each in found]
    assert errors[0] > 1e-4
    for error, each in zip(errors[:2], found, strict=False):
        assert 0.5 < error / float(each["next_order"]) < 2.0
    assert errors[2] < 8e-6  # half of it the mesh's own error
    assert float(found[2]["pressure"].mean()) == pytest.approx(-mesh().traction(solution).mean(), rel=2e-3)


@pytest.mark.long
def test_tractions_that_pull_the_surface_out_of_reach_leave_what_they_alone_do(tmp_path):
    """No node touches: the response of the true surface to the tractions, from finite elements."""
    away = {name: values - 0.02 * (name == "normal_traction") for name, values in TRACTIONS.items()}
    found = [solved(order, {"displacement": 0.0}, boundary=boundary(tmp_path, away)) for order in (0, 1, 2)]
    given = np.array([away["tangential_traction"], away["normal_traction"]])[:, ::OVER]
    nowhere = np.zeros(2 * COLUMNS, dtype=bool)
    solution = mesh().press(CLEARANCE + DEPTH, nowhere, tractions=given)
    assert not solution.touching.any()
    for each in found:
        assert not each["pressure"].any()
    errors = [max(off(each, *mesh().along_top(solution))) for each in found]
    for error, each in zip(errors, found, strict=True):
        assert 0.5 < error / float(each["next_order"]) < 2.0


def test_a_node_sticks_where_the_tractions_had_brought_it_on_the_true_surface(tmp_path):
    """Slip counts from the surface that the tractions deflect, at the order that is followed."""
    parts = {"interface": WALL | {"friction": {"coefficient": 0.9}}, "boundary": boundary(tmp_path)}
    found = solved(2, {"displacement": DEPTH / 50}, **parts)
    held = (found["pressure"].values > 0.0) & (found["slip"].values == 0.0)
    assert held.sum() > 3
    tractions = np.stack((TRACTIONS["tangential_traction"], TRACTIONS["normal_traction"]))
    body = ElasticBody(0.33, HEIGHT)
    alone = body.response((NX,)).apply(tractions)
    response = topography.respond(-tractions[1], HEIGHTS - HEIGHTS.mean(), body, 2, tractions[:1])
    np.testing.assert_allclose(
        found["tangential_displacement"].values[held], (alone[0] + response.along[0])[held], atol=1e-9
    )


@pytest.mark.long
def test_a_hardness_bounds_the_pressure_of_the_true_surface_as_on_finite_elements():
    found = [solved(order, interface={"hard_wall": {"hardness": HARDNESS}}) for order in (0, 1, 2)]
    solution = mesh().press(CLEARANCE, found[2]["pressure"].values[::OVER] > 0.0, hardness=HARDNESS)
    pressure = -mesh().traction(solution)
    assert (pressure <= HARDNESS * (1 + 1e-8)).all()
    assert (pressure > 0.999 * HARDNESS).sum() > 10
    errors = [off(each, *mesh().along_top(solution))[0] for each in found]
    assert 0.5 < errors[0] / float(found[0]["next_order"]) < 2.0
    assert 0.5 < errors[1] / float(found[1]["next_order"]) < 2.0
    assert errors[2] < 5e-6
    assert float(found[2]["pressure"].mean()) == pytest.approx(pressure.mean(), rel=5e-3)  # 2e-3 on twice the columns
    assert float(found[2]["plastic_area_fraction"]) == pytest.approx((pressure > 0.999 * HARDNESS).mean(), abs=0.01)


@pytest.mark.long
def test_a_cohesive_law_acts_on_the_true_surface_as_on_finite_elements():
    """Dragged by the punch, so that slip counts where the topography carries the nodes along x."""
    law = XuNeedlemanLaw(*LAW.values())
    path = [{"sliding": SLIDING}]
    found = [solved(order, path=path, interface={"cohesive": LAW}) for order in (0, 1, 2)]
    start = [found[2][name].values[::OVER] for name in ("tangential_displacement", "displacement")]
    tangential, normal, along, out = mesh().under_law(CLEARANCE, SLIDING, law, start)
    errors = [max(off(each, tangential, normal)) for each in found]
    assert 0.4 < errors[0] / float(found[0]["next_order"]) < 2.0
    assert 0.4 < errors[1] / float(found[1]["next_order"]) < 2.0
    assert errors[2] < 2e-6
    drag = [each["tangential_traction"].values[::OVER] for each in found]
    lost = [abs(each - along).max() / abs(along).max() for each in drag]
    assert lost[0] > 0.03
    assert lost[2] < 1e-3
    np.testing.assert_allclose(found[2]["pressure"].values[::OVER], -out, atol=1e-3 * abs(out).max())


@pytest.mark.long
def test_damped_dynamics_finds_the_same_cohesive_contact():
    coarse = HEIGHTS[::8]
    parts = {"heights": coarse, "interface": WALL | {"cohesive": LAW}, "path": [{"sliding": SLIDING}]}
    newton = solved(2, **parts)
    dynamics = solved(2, numerics={"solver": "verlet", "residual": 1e-8}, **parts)
    for name in ("pressure", "tangential_traction", "tangential_displacement"):
        np.testing.assert_allclose(dynamics[name], newton[name], atol=1e-6 * float(abs(newton[name]).max()))
