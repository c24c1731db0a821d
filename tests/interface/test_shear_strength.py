"""Friction that holds at most a shear strength, which may rise with the pressure, in both solvers."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.contact.contact_input import read_contact
from gfmd_numba.contact.energy_balance import EnergyBalance
from gfmd_numba.contact.load_path import solve_path
from gfmd_numba.kernels import ContactLimits
from gfmd_numba.scene import InputError
from gfmd_numba.scene.scene_file import load_scene
from gfmd_numba.solvers.friction.friction_guess import Found, FrictionGuess

pytestmark = pytest.mark.filterwarnings("ignore")  # coarse steps and strains are enough here
BODY = {"youngs_modulus": 1e9, "poissons_ratio": 0.3}
SCENE = {
    "body": BODY | {"aspect_ratio": 0.2},
    "length": "1 mm",
    "form": {"radius": "1 mm", "points": 64},
    "interface": {"hard_wall": {}, "friction": {"coefficient": 0.3, "limit": "5 MPa"}},
    "loading": {"pressure": "2 MPa"},
}


@pytest.mark.parametrize(
    ("numerics", "rise"), [({"solver": "verlet"}, 0.05), ({"solver": "frictional_newton", "max_iterations": 60}, 0.0)]
)
def test_a_punch_that_slides_bears_the_smaller_one_of_both_at_each_node(numerics, rise):
    path = [{"sliding": "0.5 um"}, {"sliding": "200 um"}]
    rubs = {"coefficient": 0.3, "limit": "5 MPa"} | ({"pressure_coefficient": rise} if rise else {})
    scene = SCENE | {"interface": {"hard_wall": {}, "friction": rubs}}
    found = gfmd_numba.solve({"scene": scene, "path": path, "numerics": numerics})
    assert (found["status"] == 0).all()
    pressure, traction = found["pressure"].values[-1], found["tangential_traction"].values[-1]
    assert (0.3 - rise) * pressure.max() > 1.2 * 5e6  # the limit counts
    held = np.minimum(0.3 * pressure, 5e6 + rise * pressure)
    np.testing.assert_allclose(abs(traction), held, atol=1e-6 * pressure.max())


def test_a_half_space_without_a_drag_bears_no_more_than_the_shear_strength():
    scene = SCENE | {
        "body": BODY | {"poissons_ratio": 0.0},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1},
        "interface": {"hard_wall": {}, "friction": {"coefficient": 0.1, "limit": "4 MPa"}},
        "loading": {"pressure": "20 MPa"},
    }
    del scene["form"]
    numerics = {"solver": "frictional_newton", "max_iterations": 100}
    file = {"scene": scene, "seed": 1, "path": [{"pressure": "10 MPa"}], "numerics": numerics}
    found = gfmd_numba.solve(file | {"discretisation": {"eps_c": 0.25, "eps_f": 1 / 16, "eps_t": 0.5}})
    assert (found["status"] == 0).all()
    traction = abs(found["tangential_traction"].values)
    assert np.isclose(traction, 4e6, rtol=1e-6).any()
    assert traction.max() <= 4e6 * (1 + 1e-6)


def revised(limit, unsure=0.01):
    """What is revised of a node that slips under a falling pressure and of one that touches down."""
    contact, along = np.array([True, False]), np.array([[1.0, 0.0]])
    tractions = np.array([[-0.3, 0.0], [1.0, 0.0]])
    guess = FrictionGuess(contact, along, np.zeros(2), tractions, np.zeros(2), np.zeros(2, dtype=bool), np.zeros(2))
    moved, found = np.array([[0.2, 0.3], [0.0, 1.0]]), np.array([[-0.2, 0.0], [0.4, 0.0]])
    limits = ContactLimits(friction=0.5, shear_strength=limit)
    return guess.revision(Found(moved, found, np.zeros(2), np.zeros((1, 2))), limits, 1e-12, unsure)


def test_a_node_whose_friction_falls_below_the_shear_strength_was_guessed_wrong():
    """It slides on, but under another law; unless both are so close that rounding may tell."""
    assert revised(0.3).wrong.tolist() == [0, 1]
    assert revised(0.1).wrong.tolist() == [1]  # the limit still counts
    assert revised(0.3, unsure=0.5).wrong.tolist() == [1]
    assert revised(np.inf).wrong.tolist() == [1]
    assert revised(0.3).slip_compliance[0] == pytest.approx(0.2 / (0.5 * 0.4))


def test_the_shear_strength_does_not_tell_whether_a_node_that_touches_down_slips():
    """Its trial traction is as stiff along the surface as across, and friction alone is compared with it."""
    for limit in (0.1, np.inf):
        assert revised(limit).joins.tolist() == [False, True]
        assert not revised(limit).direction[:, 1].any()


def test_the_balance_of_energy_knows_the_shear_strength():
    problem, _ = read_contact(*load_scene({"scene": SCENE})).reduced
    (found,) = solve_path(problem, 0)
    limit = EnergyBalance.of(problem, found).frictional.limit
    assert limit.max() == pytest.approx(problem.interface.shear_strength)


@pytest.mark.parametrize("rubs", [{}, {"limit": "5 MPa", "coefficient": 0.1}])
def test_a_strength_that_rises_is_a_limit_that_rises_less_than_the_coefficient(rubs):
    scene = SCENE | {
        "interface": {"hard_wall": {}, "friction": {"coefficient": 0.3, "pressure_coefficient": 0.1} | rubs}
    }
    with pytest.raises(InputError, match=r"(?s)pressure_coefficient.*less than the coefficient"):
        load_scene({"scene": scene})


@pytest.mark.parametrize(("limit", "residual"), [(200.0, 1e-8), (20e3, 1e-6)])
def test_a_shear_strength_that_the_residual_hides_is_warned_of(limit, residual):
    def validity(limit, residual):
        laws = {"hard_wall": {}, "friction": {"coefficient": 0.3, "limit": limit}}
        file = {"scene": SCENE | {"interface": laws}, "path": [{"sliding": "0.5 um"}]}
        return gfmd_numba.solve(file | {"numerics": {"residual": residual}}).validity

    said = validity(limit, residual)
    assert "times the limit of friction: take a numerics.residual of at most" in said
    enough = float(said.rpartition("at most ")[2])
    assert "limit of friction" not in validity(limit, 0.9 * enough)
