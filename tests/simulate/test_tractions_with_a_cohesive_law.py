"""Tractions prescribed on a body before a punch with a cohesive law comes: gap and slip count from the loaded body."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw

NX, MAP = 64, (28, 28)
X = np.arange(NX) / NX
Y2, X2 = np.indices(MAP) / MAP[0]
LAW = {"work_of_adhesion": 1e-4, "normal_length": 4e-3, "tangential_length": 4e-3}
COHESIVE, BODY = {"cohesive": LAW}, {"poissons_ratio": 0.3, "aspect_ratio": 0.5}
GIVEN = {
    1: {
        "tangential_traction": 3e-3 * np.sin(4 * np.pi * X) + 1e-3,
        "normal_traction": 2e-3 * np.cos(6 * np.pi * X + 0.2),
    },
    2: {
        "tangential_traction": 3e-3 * np.sin(4 * np.pi * X2) + 1e-3,
        "tangential_traction_y": 2e-3 * np.cos(2 * np.pi * (X2 + Y2)),
        "normal_traction": 4e-3 * np.cos(4 * np.pi * X2 + 0.2) * np.cos(2 * np.pi * Y2),
    },
}
HEIGHTS = {
    1: sum(3e-3 / k * np.cos(2 * np.pi * k * X + k * k) for k in range(1, 9)),
    2: 3e-3 * np.cos(2 * np.pi * X2) * np.cos(2 * np.pi * Y2) + 1e-3 * np.cos(2 * np.pi * (3 * X2 - 2 * Y2) + 1.0),
}
PATHS = {
    "pressure": ({"pressure": 2e-3}, [{"sliding": 2e-3}, {"pressure": 8e-4}]),
    "displacement": ({"displacement": 5e-3}, [{"sliding": 2e-3}, {"displacement": -4e-3}]),
}
OF_THE_PUNCH = ("pressure", "gap", "mean_pressure", "elastic_energy", "tangential_traction")
FRICTION = {"hard_wall": {}, "friction": {"coefficient": 0.2}}


def boundary(folder, dimension=1):
    for name, values in GIVEN[dimension].items():
        np.save(folder / f"{name}.npy", values)
    return {name: str(folder / f"{name}.npy") for name in GIVEN[dimension]}


def deflected(dimension):
    """Displacements of the loaded body, along the surface `[(component, y,) x]` and out of it."""
    tractions = np.stack([*GIVEN[dimension].values()])
    *along, out = ElasticBody(0.3, 0.5).response(tractions.shape[1:]).apply(tractions)
    return along[0] if dimension == 1 else np.stack(along), out


def solved(heights, loading, path, interface=COHESIVE, **scene):
    units = {"length": 1.0, "roughness": {"units": {"z": "m"}}}
    scene |= units | {"body": BODY | {"youngs_modulus": 1 - 0.3**2}, "interface": interface, "loading": loading}
    found = gfmd_numba.solve({"scene": scene, "path": path, "numerics": {"residual": 1e-9}}, heights=heights)
    assert (found["status"] == 0).all()
    return found


def close(found, expected, tolerance=1e-7):
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=tolerance * float(abs(np.asarray(expected)).max()))


@pytest.mark.parametrize(
    ("dimension", "control", "interface"),
    [
        (1, "pressure", FRICTION),
        pytest.param(1, "displacement", COHESIVE | {"hard_wall": {}}, marks=pytest.mark.long),
        pytest.param(2, "pressure", COHESIVE, marks=pytest.mark.long),
    ],
)
def test_the_punch_meets_the_shape_that_the_tractions_have_given_the_body(tmp_path, dimension, control, interface):
    """The same as on an unloaded body under a punch from which that shape is taken, in every step of a path."""
    heights, (along, out) = HEIGHTS[dimension], deflected(dimension)
    loading, path = PATHS[control]
    if interface == FRICTION:
        path = [path[0], {"sliding": 0.0}]  # nothing holds a punch without attraction that is drawn off
    found = solved(heights, loading, path, interface, boundary=boundary(tmp_path, dimension))
    higher = (heights + out).max() - heights.max()  # first touch counts from the highest point
    moved = [
        {key: value + higher * (key == "displacement") for key, value in step.items()} for step in (loading, *path)
    ]
    other = solved(heights + out, moved[0], moved[1:], interface)
    for name in OF_THE_PUNCH:
        close(found[name], other[name])
    loss = 1e-8 * float(other["elastic_energy"].max())
    np.testing.assert_allclose(found["energy_lost"], other["energy_lost"], rtol=1e-6, atol=loss)
    assert interface != FRICTION or abs(found["energy_lost"]).max() > 100 * loss
    close(found["displacement"], other["displacement"] + out)
    close(found["tangential_displacement"], other["tangential_displacement"] + (along if dimension == 1 else along[0]))
    assert abs(found["tangential_traction"]).max() > 1e-3


def test_all_tractions_of_law_and_boundary_balance(tmp_path):
    """Total displacements and tractions obey the stiffness of the body and the law, written out once more."""
    sliding = 1.5e-3
    found = solved(
        HEIGHTS[1], {"pressure": 2e-3}, [{"sliding": sliding}], boundary=boundary(tmp_path)
    ).isel(step=-1)  # fmt: skip
    law, k = XuNeedlemanLaw(*LAW.values()), ElasticBody(0.3, 0.5).response((NX,))
    u1, u3 = found["tangential_displacement"].values, found["displacement"].values
    slip, gap = sliding - (u1 - deflected(1)[0]), found["gap"].values
    drag, pull = law.tangential_traction(gap, slip), law.normal_traction(gap, slip)
    c1, c3 = grid.coefficients(u1), grid.coefficients(u3)
    along, normal = k.elements[0] * c1 + 1j * k.elements[1] * c3, k.normal * c3 - 1j * k.elements[1] * c1
    close(grid.signal(along, NX), drag + GIVEN[1]["tangential_traction"])
    held = pull + GIVEN[1]["normal_traction"]
    close(grid.signal(normal, NX)[1:] - grid.signal(normal, NX)[:-1], held[1:] - held[:-1], 1e-6)
    assert pull.mean() == pytest.approx(-2e-3, rel=1e-8)


def test_the_energy_lost_is_that_of_the_loaded_body(tmp_path):
    """Work of the punch less the gain in energy of the whole: body, law and what the prescribed tractions still do."""
    path = [{"sliding": 4e-4}, {"displacement": 5.4e-3}]
    found = solved(HEIGHTS[1], {"displacement": 5e-3}, path, boundary=boundary(tmp_path))
    law = XuNeedlemanLaw(*LAW.values())
    sliding, way = np.array([0.0, 4e-4, 4e-4]), np.array([5e-3, 5e-3, 5.4e-3])
    potential = np.zeros(3)
    for i, step in enumerate(found.transpose("step", "x").to_array().step.values):
        one = found.isel(step=step)
        u1, u3 = one["tangential_displacement"].values, one["displacement"].values
        t1, t3 = GIVEN[1].values()
        q1, q3 = t1 + one["tangential_traction"].values, t3 - one["pressure"].values
        energy = law.energy(one["gap"].values, sliding[i] - (u1 - deflected(1)[0]))
        potential[i] = (0.5 * (q1 * u1 + q3 * u3) + energy - t1 * u1 - t3 * u3).mean()
    forces = found["mean_pressure"].values, found["mean_tangential_traction"].values
    work = sum(0.5 * (f[1:] + f[:-1]) * np.diff(s) for f, s in zip(forces, (way, sliding), strict=True))
    close(found["energy_lost"].sum(), (work - np.diff(potential)).sum(), 1e-5)
    assert abs(found["energy_lost"]).max() > 1e-10
