"""Friction that depends on the slip rate, or is a function of the user's: closed forms, and what is refused."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.interface.slip_rate import SlipRateFriction, UserFunction
from gfmd_numba.scene import InputError

pytestmark = pytest.mark.filterwarnings("ignore")  # coarse steps and strains are enough here
STRENGTHENING = {"coefficient": 0.3, "velocity_strengthening": 0.02, "reference_velocity": "1 um/s"}
TABLE = {"coefficient": 0.3, "slip_rates": ["1 um/s", "100 um/s"], "coefficients": [0.2, 0.5]}
SCENE = {
    "body": {"youngs_modulus": "1 GPa", "poissons_ratio": 0.3, "aspect_ratio": 0.2},
    "length": "1 mm",
    "form": {"radius": "1 mm", "points": 64},
    "loading": {"pressure": "2 MPa", "duration": "1 s"},
}


def scene(friction, **changes):
    return SCENE | {"interface": {"hard_wall": {}, "friction": friction}} | changes


def dragged(friction, *path, **changes):
    found = gfmd_numba.solve({"scene": scene(friction, **changes), "path": list(path)})
    assert (found["status"] == 0).all()
    return found


def rate_of_all(found, duration):
    """The slip rate of a punch that drags all nodes, whose body gives way as the mean traction has changed."""
    touching = found["pressure"][-1] > 0.0
    slip = found["slip"].values[-1][touching.values]
    assert (slip > 0.0).all()
    return slip / duration, touching.values


def function(gap, pressure, rate):
    assert (gap == 0.0).all()
    return (0.2 + 0.02 * np.log1p(rate / 1e-6)) * pressure


@pytest.mark.parametrize(
    ("friction", "coefficient", "duration"),
    [
        (STRENGTHENING, lambda v: 0.3 + 0.02 * np.log(1.0 + v / 1e-6), 0.01),
        (TABLE, lambda v: np.interp(v, [0.0, 1e-6, 1e-4], [0.3, 0.2, 0.5]), 1.0),
        ({"coefficient": 1.0, "function": function}, lambda v: 0.2 + 0.02 * np.log(1.0 + v / 1e-6), 100.0),
    ],
)
def test_a_block_that_slides_bears_the_coefficient_of_its_speed_times_the_pressure(friction, coefficient, duration):
    steps = {"sliding": "50 um", "duration": 1.0}, {"sliding": "200 um", "duration": duration}
    found = dragged(friction, *steps)
    rate, touching = rate_of_all(found, duration)
    np.testing.assert_allclose(rate, 150e-6 / duration, rtol=0.02)  # less what the body gives way by
    traction, pressure = (found[name].values[-1][touching] for name in ("tangential_traction", "pressure"))
    np.testing.assert_allclose(traction, coefficient(rate) * pressure, atol=1e-7 * pressure.max())
    assert found["time"].values[-1] == pytest.approx(2.0 + duration)


@pytest.mark.parametrize("dimension", [1, pytest.param(2, marks=pytest.mark.long)])
def test_slow_slip_is_that_of_coulomb_and_faster_slip_meets_more_resistance(dimension):
    """A ball on a slab in partial slip, as Cattaneo's and Mindlin's, dragged by 0.2 um in one second and in 1e12."""
    changes = {"dimension": dimension, "form": {"radius": "1 mm", "points": 32}, "loading": SCENE["loading"]}
    slow, fast, still = (
        dragged(friction, {"sliding": "1 um"} | duration, **changes | {"loading": {"pressure": "20 MPa"} | duration})
        for friction, duration in (
            (STRENGTHENING, {"duration": 1e12}),
            (STRENGTHENING, {"duration": 1e-3}),
            ({"coefficient": 0.3}, {}),
        )
    )
    peak = float(still["pressure"].max())
    for name in ("pressure", "tangential_traction"):
        np.testing.assert_allclose(slow[name], still[name], atol=1e-6 * peak)
    assert 0.0 < still["stick_fraction"].values[-1] < 1.0
    assert fast["mean_tangential_traction"].values[-1] > 1.001 * still["mean_tangential_traction"].values[-1]


def test_the_slopes_of_what_is_held_are_those_of_differences():
    pressure, slip = np.array([0.0, 0.3, 2.0, 1.0]), np.array([0.1, 0.0, 3.0, 40.0])
    film = UserFunction(lambda gap, p, v: 1.0 + 0.1 * p + np.sqrt(1.0 + v), 2.0, 3.0)
    for law in (
        SlipRateFriction(0.3, 0.05, 2.0),
        SlipRateFriction(0.3, 0.05, 2.0, shear_strength=0.2, shear_rise=0.01),
        SlipRateFriction(0.3, rates=(0.0, 1.0, 5.0), coefficients=(0.3, 0.2, 0.4)),
        SlipRateFriction(0.9, shear_strength=film),
    ):
        law = law.lasting(1.5)
        held, by_pressure, by_slip = law.limit_and_slopes(pressure, slip)
        for i, slope in enumerate((by_pressure, by_slip)):
            step = 1e-7 * np.array([[1.0], [0.0]])[[i, 1 - i]]
            more = law.friction_limit(pressure + step[0], slip + step[1])
            np.testing.assert_allclose((more - held) / 1e-7, slope, atol=1e-5)
        assert held[0] == 0.0


@pytest.mark.parametrize("found", [-1.0, np.nan, [1.0, 2.0], "much"])
def test_a_function_that_returns_no_traction_is_named(found):
    with pytest.raises(InputError, match=r"friction.function.*finite traction"):
        gfmd_numba.solve({"scene": scene({"coefficient": 0.3, "function": lambda *given: found})})


@pytest.mark.parametrize(
    ("friction", "changes", "path", "told"),
    [
        (STRENGTHENING, {"loading": {"pressure": "2 MPa"}}, [], r"duration.*where friction depends on the slip rate"),
        (STRENGTHENING, {}, [{"sliding": "1 um"}], r"path\[0\].*duration.*here, too"),
        ({"coefficient": 0.3, "velocity_strengthening": 0.01}, {}, [], "both of velocity_strengthening"),
        (STRENGTHENING | {"coefficient": np.inf}, {}, [], "finite coefficient"),
        (STRENGTHENING | {"velocity_strengthening": -0.01}, {}, [], "velocity_strengthening"),
        (TABLE | {"slip_rates": ["2 um/s", "1 um/s"]}, {}, [], "slip rates that rise"),
        (TABLE | {"coefficients": [0.2]}, {}, [], "as many coefficients as slip_rates"),
        (TABLE | STRENGTHENING, {}, [], "one of velocity_strengthening and a table"),
        ({"coefficient": 0.3, "function": "mu(v)"}, {}, [], "in Python a function"),
        ({"coefficient": 0.3, "function": lambda pressure: pressure}, {}, [], "a function of three arrays"),
        ({"coefficient": 0.3, "function": function, "limit": "1 MPa"}, {}, [], "one of limit and function"),
        ({"coefficient": 0.3}, {}, [], r"nothing.*friction that depends on the slip rate"),
    ],
)
def test_what_makes_no_sense_is_refused(friction, changes, path, told):
    with pytest.raises(InputError, match=f"(?s){told}"):
        gfmd_numba.solve({"scene": scene(friction, **changes), "path": path})


def test_fields_below_a_contact_need_no_function_again():
    found = gfmd_numba.solve({"scene": scene({"coefficient": 1.0, "function": function})})
    assert "function" in found.attrs["scene"]
    assert np.isfinite(gfmd_numba.body_fields(found, [-1e-5])["stress_2"]).all()


def test_the_dynamics_does_not_know_slip_rates():
    with pytest.raises(
        InputError, match=r"'frictional_newton' or 'auto' with a friction that depends on the slip rate"
    ):
        gfmd_numba.solve({"scene": scene(STRENGTHENING), "numerics": {"solver": "verlet"}})
