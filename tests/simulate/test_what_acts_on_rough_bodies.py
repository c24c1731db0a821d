"""Whatever acts on a smooth body under a rough punch acts on a rough body at order 0, and between two bodies."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.scene import InputError
from support.cases import some_of

ROUGH = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}
EPS = {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1 / 2}
NX = 256
X = np.arange(NX) / NX
WALL = {"hard_wall": {}}
SLAB = {"youngs_modulus": 1.0, "poissons_ratio": 0.3, "aspect_ratio": 0.5}
STIFF = {"youngs_modulus": 1e9, "poissons_ratio": 0.2, "aspect_ratio": 1.0}
LAYERED = {
    "layers": [
        {"height": 0.05, "youngs_modulus": 1.5, "poissons_ratio": 0.2},
        {"height": 0.3, "youngs_modulus": 0.3, "poissons_ratio": 0.45},
    ],
    "base": "rigid",
}
COHESIVE = {"cohesive": {"work_of_adhesion": 1e-6, "normal_length": 4e-4, "tangential_length": 4e-4}}
SLIDING = [{"sliding": 3e-4}]
ACTING = {
    "friction": ({"interface": WALL | {"friction": {"coefficient": 0.3}}}, SLIDING),
    "sticking": ({"interface": WALL | {"friction": {"coefficient": np.inf}}}, [{"sliding": 1e-5}]),
    "friction and a law of the gap": (
        {
            "interface": WALL
            | {"friction": {"coefficient": 0.3}, "exponential": {"work_of_adhesion": 1e-6, "range": 5e-3}}
        },
        [],
    ),
    "cohesive law": ({"interface": COHESIVE, "loading": {"displacement": 3e-4}}, SLIDING),
    "hardness": ({"interface": {"hard_wall": {"hardness": 0.005}}}, []),
    "layers and friction": ({"body": LAYERED, "interface": WALL | {"friction": {"coefficient": 0.3}}}, SLIDING),
    "tractions and friction": ({"boundary": True, "interface": WALL | {"friction": {"coefficient": 0.3}}}, SLIDING),
    "tractions and a cohesive law": (
        {"boundary": True, "interface": COHESIVE, "loading": {"displacement": 3e-4}},
        SLIDING,
    ),
}
TRACTIONS = {
    "normal_traction": 2e-4 * np.cos(6 * np.pi * X + 0.2),
    "tangential_traction": 3e-4 * np.sin(4 * np.pi * X) + 1e-4,
}


def solved(path=(), order=None, folder=None, **parts):
    scene = {"body": SLAB, "interface": WALL, "loading": {"reduced_pressure": 0.05}} | parts
    if scene.pop("boundary", False):
        for name, values in TRACTIONS.items():
            np.savetxt(folder / f"{name}.csv", values)
        scene["boundary"] = {name: str(folder / f"{name}.csv") for name in TRACTIONS}
    numerics = {"residual": 1e-9} | ({} if order is None else {"topography_order": order})
    file = {"scene": scene, "numerics": numerics, "discretisation": EPS}
    found = gfmd_numba.solve(file | ({"path": list(path)} if path else {}))
    assert (found["status"] == 0).all()
    return found


def close(found, expected, tolerance=1e-7):
    scale = float(abs(expected).max())
    np.testing.assert_allclose(found.values, expected.values, atol=tolerance * scale, err_msg=str(expected.name))


@pytest.mark.filterwarnings("ignore:the roughness of a deformable body changes")  # 1 % of the topmost layer
@pytest.mark.parametrize("case", some_of(ACTING, 2, 7))
def test_a_rough_body_and_a_nearly_rigid_one_feel_it_like_a_smooth_one_under_a_rough_punch(case, tmp_path):
    parts, path = ACTING[case]
    body, order = parts.get("body", SLAB), None
    punched = solved(path, folder=tmp_path, roughness=ROUGH, **parts)
    own = solved(path, order, tmp_path, **parts | {"body": body | {"roughness": ROUGH}})
    pair = solved(path, order, tmp_path, **parts | {"body": body, "counter_body": STIFF | {"roughness": ROUGH}})
    names = ["pressure", "gap", "mean_pressure", "contact_area_fraction"]
    names += [name for name in ("slip", "tangential_traction", "tangential_displacement") if name in punched]
    names += [name for name in ("plastic_area_fraction", "stick_fraction") if name in punched]
    for name in names:
        close(own[name], punched[name])
        close(pair[name], punched[name], 1e-6)
    if "energy_lost" in punched:  # a difference of energies as large as the work of the load
        work = float((abs(punched["mean_pressure"]) * abs(punched["displacement"]).max("x")).max())
        np.testing.assert_allclose(own["energy_lost"], punched["energy_lost"], atol=1e-9 * work)
        np.testing.assert_allclose(pair["energy_lost"], punched["energy_lost"], atol=1e-7 * work)
    close(own["displacement"], punched["displacement"], 1e-6)
    close(pair["displacement"], punched["displacement"], 1e-6)
    assert (own["next_order"] > 1e-4 * abs(own["displacement"]).max()).all()
    if "plastic_area_fraction" not in punched:  # which allows order 0 alone
        between = solved(path, 1, tmp_path, **parts | {"body": body, "counter_body": STIFF | {"roughness": ROUGH}})
        change = abs(between["gap"] - pair["gap"]).max()
        assert 0.5 * change < pair["next_order"].max() < 2.0 * change


def test_tractions_on_one_of_two_bodies_move_that_one(tmp_path):
    """The gap follows from the displacements of both, which the fields of each flat body give."""
    other, law = (
        {"youngs_modulus": 0.5, "poissons_ratio": 0.45, "aspect_ratio": 0.2},
        {"friction": {"coefficient": 0.3}},
    )
    found = solved(
        body=SLAB | {"roughness": ROUGH}, counter_body=other, interface=WALL | law, boundary=True, folder=tmp_path
    )
    gap = -(found["height"] + found["displacement"] + found["counter_body_displacement"]).values
    gap -= gap[found["pressure"].values > 0.0].mean()
    np.testing.assert_allclose(gap, found["gap"], atol=1e-7 * np.ptp(found["height"].values))
    close(found["mean_pressure"], found["pressure"].mean())
    bare = solved(body=SLAB | {"roughness": ROUGH}, counter_body=other, interface=WALL | law)
    assert abs(bare["pressure"] - found["pressure"]).max() > 0.1 * found["pressure"].max()
    shear_modulus, held = 0.5 / 1.3, 1e-4 + float(found["tangential_traction"].mean())
    assert float(found["tangential_displacement"].mean()) == pytest.approx(held * 0.5 / shear_modulus, rel=1e-8)


def test_a_hardness_bounds_the_pressure_between_two_bodies_as_on_one_of_both_moduli():
    half = {"youngs_modulus": 2.0, "poissons_ratio": 0.3}
    hard = {"hard_wall": {"hardness": 0.004}}
    two = solved(body=half | {"roughness": ROUGH}, counter_body=half, interface=hard)
    one = solved(body=half | {"youngs_modulus": 1.0}, roughness=ROUGH, interface=hard)
    assert float(one["plastic_area_fraction"]) > 0.0
    for name in ("pressure", "gap", "plastic_area_fraction", "kappa"):
        close(two[name], one[name])


def test_layers_of_either_body_tell_what_their_modulus_is():
    found = solved(body=LAYERED, counter_body=SLAB | {"roughness": ROUGH})
    modulus = 1.0 / ((1 - 0.3**2) / 1.0 + (1 - 0.2**2) / 1.5)
    said, sentence = found.attrs["effective_modulus"].split(" Pa: ")
    assert float(said) == pytest.approx(modulus, rel=1e-12)
    assert sentence == "E* is that of both bodies together, of layers the topmost"


def test_a_topography_deeper_than_all_layers_is_refused():
    thin = LAYERED | {"layers": [LAYERED["layers"][0] | {"height": 1e-4}], "roughness": ROUGH}
    with pytest.raises(
        InputError, match=r"body.roughness: you gave a topography .* within the height of the body, 0.0001"
    ):
        solved(body=thin)


def test_a_slab_so_deep_that_it_is_solved_as_a_half_space_is_told_of_either_body():
    deep = {"youngs_modulus": 2.0, "poissons_ratio": 0.3, "aspect_ratio": 1.3}
    half_space = {"youngs_modulus": 1.0, "poissons_ratio": 0.1}
    below = solved(body=deep | {"roughness": ROUGH}, counter_body=half_space)
    above = solved(body=half_space | {"roughness": ROUGH}, counter_body=deep)
    assert below.attrs["dropped_effects"].startswith("slab of aspect ratio 1.3, Poisson's ratio 0.3: it stiffens")
    assert above.attrs["dropped_effects"].startswith(
        "slab of aspect ratio 1.3, Poisson's ratio 0.3, of the counter_body"
    )
