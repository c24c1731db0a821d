"""Friction between two elastic bodies: closed forms, rigid limits, the exchange of the bodies, and fields inside."""

import numpy as np
import pytest

import gfmd_numba

ROUGH = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}
EPS = {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1 / 2}
MU = 0.3
WALL, FRICTION = {"hard_wall": {}}, {"hard_wall": {}, "friction": {"coefficient": MU}}
SLAB = {"youngs_modulus": 1.0, "poissons_ratio": 0.3, "aspect_ratio": 0.5}
OTHER = {"youngs_modulus": 2.0, "poissons_ratio": -0.1, "aspect_ratio": 0.3}
COATED = {
    "layers": [
        {"height": 0.03, "youngs_modulus": 4.0, "poissons_ratio": 0.1},
        {"height": 0.2, "youngs_modulus": 1.0, "poissons_ratio": 0.4},
    ],
    "base": "rigid",
}
PULLED_SKIN = {
    "layers": [{"height": 0.05, "youngs_modulus": 0.5, "poissons_ratio": 0.0}],
    "base": {"youngs_modulus": 2.0, "poissons_ratio": 0.3},
}


def solved(path=(), numerics=None, discretisation=EPS, **parts):
    scene = {"interface": FRICTION, "loading": {"reduced_pressure": 0.05}} | parts
    numerics = {"residual": 1e-9} | (numerics or {})
    file = {"scene": scene, "numerics": numerics} | ({"path": list(path)} if path else {})
    found = gfmd_numba.solve(file | ({"discretisation": discretisation} if discretisation else {}))
    assert (found["status"] == 0).all()
    return found


def rough(body):
    return body | {"roughness": ROUGH}


def close(found, expected, tolerance=1e-7):
    scale = float(abs(expected).max())
    np.testing.assert_allclose(found.values, expected.values, atol=tolerance * scale)


def slid(*ways):
    return [{"sliding": way} for way in ways]


@pytest.mark.filterwarnings("ignore:the roughness .* thickness of its topmost layer:UserWarning")
def test_nothing_changes_but_the_sign_of_the_traction_if_the_bodies_change_places():
    below = solved(slid(2e-4), body=rough(COATED), counter_body=OTHER)
    above = solved(slid(-2e-4), body=OTHER, counter_body=rough(COATED))
    close(above["pressure"], below["pressure"])
    close(above["tangential_traction"], -below["tangential_traction"])
    for name in ("displacement", "tangential_displacement"):
        close(above[f"counter_body_{name}"], below[name])
        close(above[name], below[f"counter_body_{name}"])
    close(above["energy_lost"], below["energy_lost"])


@pytest.mark.long
def test_against_a_nearly_rigid_body_the_other_rubs_as_under_a_rigid_punch():
    stiff = {"youngs_modulus": 1e9, "poissons_ratio": 0.2, "aspect_ratio": 1.0}
    way = 3e-4
    punched = solved(slid(way), body=SLAB, roughness=ROUGH)
    below = solved(slid(way), body=SLAB, counter_body=stiff | {"roughness": ROUGH})
    above = solved(slid(-way), body=stiff, counter_body=rough(SLAB))
    for found, prefix, sign in ((below, "", 1.0), (above, "counter_body_", -1.0)):
        close(found["pressure"], punched["pressure"])
        close(sign * found["tangential_traction"], punched["tangential_traction"])
        close(found[f"{prefix}tangential_displacement"], punched["tangential_displacement"])
    assert abs(below["counter_body_tangential_displacement"]).max() < 1e-8 * abs(below["displacement"]).max()


def test_between_equal_half_spaces_friction_has_nothing_to_do():
    half_space = {"youngs_modulus": 1.0, "poissons_ratio": 0.2}
    rubbed = solved(body=rough(half_space), counter_body=half_space)
    assert "Dundurs' beta is 0" in rubbed.attrs["dropped_effects"]
    smooth = solved(body=rough(half_space), counter_body=half_space, interface=WALL, numerics={"topography_order": 0})
    np.testing.assert_array_equal(rubbed["pressure"], smooth["pressure"])
    softer = half_space | {"poissons_ratio": 0.4}
    for below, above in ((half_space, softer), (softer, half_space)):  # beta has either sign
        unlike = solved(body=rough(below), counter_body=above)
        assert unlike.attrs["dropped_effects"] == ""
        assert abs(unlike["tangential_traction"]).max() > 0.05 * MU * unlike["pressure"].max()


@pytest.mark.long
def test_two_equal_deep_slabs_rub_like_one_incompressible_slab():
    """Their couplings cancel, and in E* all waves are as stiff; one slab is as deep as holds the mean equally."""
    nu, depth = 0.2, 4.0
    slab = {"youngs_modulus": 2.0 * (1 - nu**2), "poissons_ratio": nu, "aspect_ratio": depth}
    two = solved(slid(5e-4, 2e-4), body=rough(slab), counter_body=slab)
    alone = {"youngs_modulus": 0.75, "poissons_ratio": 0.5, "aspect_ratio": depth * 0.5 / (1 - nu)}
    one = solved(slid(5e-4, 2e-4), body=alone, roughness=ROUGH)
    close(two["pressure"], one["pressure"])
    close(two["tangential_traction"], one["tangential_traction"])
    close(two["tangential_displacement"] - two["counter_body_tangential_displacement"], one["tangential_displacement"])
    close(two["tangential_displacement"][0], two["counter_body_tangential_displacement"][0])
    close(two["hysteresis"], one["hysteresis"])


def wave_pressure(x, share):
    """Pressure of Westergaard's wave over that of full contact (Johnson 1985, 13.2)."""
    share = max(share, 0.0)
    return 2.0 * np.cos(np.pi * x) * np.sqrt(np.maximum(share - np.sin(np.pi * x) ** 2, 0.0))


def partial_slip_of_a_wave(nx):
    """Largest error of the traction over its largest as two unlike bodies whose beta is 0 are dragged, and Q/(mu P)."""
    ratios, shares, height, share = (0.2, 0.4), (4 / 13, 9 / 13), 0.005, 0.2
    assert shares[0] * (1 - 2 * 0.2) / (1 - 0.2) == pytest.approx(shares[1] * (1 - 2 * 0.4) / (1 - 0.4))
    body, counter = (
        {"youngs_modulus": (1 - nu**2) / part, "poissons_ratio": nu, "aspect_ratio": 4.0}
        for nu, part in zip(ratios, shares, strict=True)
    )
    x, full = np.arange(nx) / nx - 0.5, np.pi * height
    wave = {"method": "measured", "heights": height * np.cos(2 * np.pi * x), "units": {"z": "L_x"}}
    softness = sum(4.0 * 2 * part / (1 - nu) for nu, part in zip(ratios, shares, strict=True))
    ways = np.array([0.3, 0.6, 0.9]) * MU * share * full * softness
    found = solved(
        [{"sliding": float(way)} for way in ways],
        body=body | {"roughness": wave},
        counter_body=counter,
        loading={"reduced_pressure": share * full / (height * np.pi * np.sqrt(2))},
        discretisation=None,
    )
    exact = full * wave_pressure(x, share)
    errors, drags = [abs(found["pressure"].values - exact).max() / exact.max()], []
    for traction in found["tangential_traction"].values[1:]:
        drags.append(traction.mean() / (MU * share * full))
        expected = MU * (exact - full * wave_pressure(x, share * (1 - drags[-1])))
        errors.append(abs(traction - expected).max() / (MU * exact.max()))
    return max(errors), drags


def test_partial_slip_of_a_wave_between_unlike_bodies_has_its_closed_form():
    """Ciavarella and Jaeger, as Cattaneo and Mindlin for spheres: without beta a difference of two normal solutions."""
    (coarse, _), (fine, drags) = partial_slip_of_a_wave(128), partial_slip_of_a_wave(1024)
    assert 0.2 < drags[0] < drags[1] < drags[2] < 0.98
    assert fine < 0.018  # of order 1/2: edges lie between nodes
    assert fine < 0.5 * coarse


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:the roughness .* thickness of its topmost layer:UserWarning")
@pytest.mark.parametrize("counter", [OTHER, PULLED_SKIN])
def test_stresses_inside_both_bodies_meet_and_sticking_nodes_stay_together(counter):
    """By the fields inside, which know nothing of the stiffness of both."""
    drags = "aspect_ratio" in counter or counter["base"] == "rigid"
    path = slid(1e-4, 1.5e-4) if drags else [{"reduced_pressure": 0.08}, {"reduced_pressure": 0.081}]
    found = solved(path, body=rough(COATED), counter_body=counter)
    below, above = (gfmd_numba.body_fields(found, [0.0], body).isel(z=0) for body in ("body", "counter_body"))
    peak = float(found["pressure"].max())
    np.testing.assert_allclose(below["stress_3"], -found["pressure"], atol=1e-8 * peak)
    np.testing.assert_allclose(above["stress_3"], -found["pressure"], atol=1e-8 * peak)
    np.testing.assert_allclose(below["stress_5"], found["tangential_traction"], atol=1e-8 * peak)
    np.testing.assert_allclose(above["stress_5"], -found["tangential_traction"], atol=1e-8 * peak)
    touching = found["pressure"].values > 0.0
    gap = -(found["height"] + below["displacement_3"] + above["displacement_3"]).values
    gap -= np.where(touching, gap, 0.0).sum(axis=1, keepdims=True) / touching.sum(axis=1, keepdims=True)
    scale = float(np.ptp(found["height"].values))
    np.testing.assert_allclose(gap, found["gap"], atol=1e-7 * scale)
    apart = (below["displacement_1"] - above["displacement_1"]).values
    stuck = touching[2] & touching[1] & (found["slip"].values[2] == 0.0)
    assert 5 < stuck.sum() < touching[2].sum()
    moved = (apart[2] - apart[1])[stuck]
    expected = 0.5e-4 if drags else moved.mean()  # a half-space has no mean
    np.testing.assert_allclose(moved, expected, atol=1e-7 * scale)


MAP = 16


@pytest.mark.long
@pytest.mark.parametrize("axis", ["x", "y"])
def test_two_bodies_of_a_ridge_rub_like_those_of_its_profile(axis):
    x = np.arange(MAP) / MAP
    heights = 0.003 * (np.cos(2 * np.pi * x) + 0.4 * np.sin(6 * np.pi * x))
    ridge = np.tile(heights, (MAP, 1)) if axis == "x" else np.tile(heights[:, np.newaxis], (1, MAP))
    profile, found = (
        solved(
            [{key: 6e-4}],
            numerics={"residual": 1e-10},
            dimension=dimension,
            body=SLAB | {"roughness": {"method": "measured", "heights": given, "units": {"z": "L_x"}}},
            counter_body=COATED,
            loading={"reduced_pressure": 0.2},
            discretisation=None,
        )
        for key, dimension, given in (("sliding", 1, heights), ("sliding" + "_y" * (axis == "y"), 2, ridge))
    )
    across = {"x": "y", "y": "x"}[axis]
    suffix = "_y" * (axis == "y")
    names = ["pressure", "displacement", "counter_body_displacement", "gap"]
    tangential = ["tangential_traction", "tangential_displacement", "counter_body_tangential_displacement"]
    for name, of_map in [*zip(names, names, strict=True), *((each, each + suffix) for each in tangential)]:
        scale = float(abs(profile[name]).max())
        values = found[of_map].isel({across: 5}).values
        np.testing.assert_allclose(values, profile[name].values, atol=1e-7 * scale, err_msg=name)
    idle = "tangential_displacement" + "_y" * (axis == "x")
    assert abs(found[idle]).max() < 1e-9 * abs(profile["displacement"]).max()
    assert 0.0 < float(found["next_order"][1]) <= float(profile["next_order"][1])


@pytest.mark.long
def test_cattaneo_and_mindlin_are_exact_for_equal_bodies_that_do_not_contract():
    """With nu = 0 and beta = 0 waves give way alike in all directions, and the traction is a difference of pressures.

    Of rough maps too (Ciavarella, Jaeger): mu (p(P) - p(P - Q/mu)) along the drag, node by node.
    """
    slab = {"youngs_modulus": 2.0, "poissons_ratio": 0.0, "aspect_ratio": 4.0}
    bodies = {"dimension": 2, "body": rough(slab), "counter_body": slab}
    coarse = {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1 / 2}
    way = {"sliding": 1.2e-3 * np.sqrt(0.75), "sliding_y": 0.6e-3}
    rubbed = solved([way], discretisation=coarse, **bodies)
    traction = np.array([rubbed[f"tangential_traction{axis}"].values[1] for axis in ("", "_y")])
    drag = np.hypot(*traction.mean(axis=(1, 2)))
    load = float(rubbed["mean_pressure"][1])
    assert 0.3 < drag / (MU * load) < 0.9
    held, stuck = (
        solved(discretisation=coarse, **bodies, interface=WALL, loading={"pressure": pressure})["pressure"].values
        for pressure in (load, load - drag / MU)
    )
    size = MU * (held - stuck)
    expected = np.array([np.sqrt(0.75) * size, 0.5 * size])
    np.testing.assert_allclose(traction, expected, atol=1e-6 * MU * held.max())
    touching = held > 0.0
    np.testing.assert_array_equal(rubbed["slip"].values[1][touching] == 0.0, stuck[touching] > 0.0)
