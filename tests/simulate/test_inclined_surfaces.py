"""Frictionless contact of inclined surfaces at higher orders: finite elements, ridges, and forces that balance."""

import numpy as np
import pytest
from finite_elements import Body, graded
from finite_elements_of_two import on_quadratic_elements, press_together

import gfmd_numba
from gfmd_numba.fourier import grid

NX, COLUMNS = 256, 64
X = np.arange(NX) / NX
OVER = NX // (2 * COLUMNS)
SIZE = 0.01
CREST = -SIZE * np.cos(2 * np.pi * X)
SLAB = {"youngs_modulus": 1.0, "poissons_ratio": 0.2, "aspect_ratio": 1.0}
OTHER = {"youngs_modulus": 0.5, "poissons_ratio": 0.35, "aspect_ratio": 0.5}
DOWN = {"displacement": 0.5 * SIZE}


def wave(x):
    return SIZE * (0.4 * np.cos(6 * np.pi * (x - 0.07)) + 0.3 * np.sin(2 * np.pi * x))


def slope_of_wave(x):
    return SIZE * np.pi * (-2.4 * np.sin(6 * np.pi * (x - 0.07)) + 0.6 * np.cos(2 * np.pi * x))


def heights(values):
    return {"method": "measured", "heights": values, "units": {"z": "L_x"}}


def solved(order, dimension=1, loading=DOWN, residual=1e-9, **parts):
    scene = {"dimension": dimension, "interface": {"hard_wall": {}}, "loading": loading} | parts
    found = gfmd_numba.solve({"scene": scene, "numerics": {"topography_order": order, "residual": residual}})
    assert found["status"] == 0
    return found


def mesh(values, body):
    """Slab of quadratic elements whose nodes are stretched to its topography."""

    def stretched(x, z):
        return 0 * x, values[np.rint(x * NX).astype(int) % NX] * (1.0 + z / body["aspect_ratio"])

    edges = graded(body["aspect_ratio"], 24, 0.5 / COLUMNS)
    return Body(COLUMNS, edges, body["poissons_ratio"], stretched)


def off(found, expected, prefix=""):
    """Largest error of both displacements of a body."""
    names = f"{prefix}tangential_displacement", f"{prefix}displacement"
    return max(abs(found[name].values[::OVER] - each).max() for name, each in zip(names, expected, strict=True))


pytestmark = pytest.mark.filterwarnings("ignore:a deformable surface has an rms gradient")


@pytest.mark.long
def test_a_rough_punch_on_a_rough_body_is_that_of_finite_elements():
    found = [solved(order, body=SLAB | {"roughness": heights(CREST)}, roughness=heights(wave(X))) for order in range(3)]
    body, top = mesh(CREST, SLAB), (CREST + wave(X)).max() - 0.5 * SIZE
    touching = found[2]["pressure"].values[::OVER] > 0.0
    solution = body.press_inclined(lambda x: top - wave(x), lambda x: -slope_of_wave(x), touching)
    expected = body.along_top(solution)
    errors = [off(each, expected) for each in found]
    assert errors[0] > 2e-4
    assert 0.5 < errors[0] / float(found[0]["next_order"]) < 2.0
    assert errors[1] < 0.05 * errors[0]
    assert errors[2] < 1e-5  # the mesh's own error
    modulus = 1.0 / (1.0 - SLAB["poissons_ratio"] ** 2)
    pulled = solution.reaction[body.along_x].sum() * modulus
    assert float(found[2]["tangential_traction"].mean()) == pytest.approx(pulled, rel=2e-2)
    moved = X + found[2]["tangential_displacement"].values
    along = -found[2]["pressure"].values * slope_of_wave(moved)
    np.testing.assert_allclose(found[2]["tangential_traction"], along, atol=1e-6 * abs(along).max())


@pytest.mark.long
def test_two_rough_bodies_are_those_of_finite_elements():
    upper = wave(X) - wave(X).mean()
    bodies = {"body": SLAB | {"roughness": heights(CREST)}, "counter_body": OTHER | {"roughness": heights(upper)}}
    found = [solved(order, **bodies) for order in range(3)]
    compliances = [(1.0 - each["poissons_ratio"] ** 2) / each["youngs_modulus"] for each in (SLAB, OTHER)]
    shares = np.array(compliances) / sum(compliances)
    *expected, force = press_together(mesh(CREST, SLAB), mesh(upper, OTHER), shares, 0.5 * SIZE)
    for prefix, displacements in zip(("", "counter_body_"), expected, strict=True):
        errors = [off(each, displacements, prefix) for each in found]
        assert errors[0] > 5e-5
        assert errors[0] < 3.0 * float(found[0]["next_order"])
        assert errors[1] < 0.25 * errors[0]  # the mesh's own error
        assert errors[2] < 2e-5
    together = float(found[2]["pressure"].mean()) * sum(compliances)
    assert together == pytest.approx(force.sum(), rel=5e-3)


@pytest.mark.long
@pytest.mark.parametrize(("pair", "along"), [("roughness", "x"), ("counter_body", "y")])
def test_ridges_are_profiles(along, pair):
    nx = 16
    x = np.arange(nx) / nx
    own, facing = -0.01 * np.cos(2 * np.pi * x), 0.004 * np.cos(6 * np.pi * (x - 0.07))

    def parts(made):
        own_body = {"body": SLAB | {"roughness": heights(made(own))}}
        return own_body | (
            {"roughness": heights(made(facing))}
            if pair == "roughness"
            else {"counter_body": OTHER | {"roughness": heights(made(facing))}}
        )

    def tiled(profile):
        ridge = np.tile(profile, (nx, 1))
        return ridge if along == "x" else ridge.T.copy()

    profile = solved(2, 1, residual=1e-10, **parts(np.array))
    ridge = solved(2, 2, residual=1e-10, **parts(tiled))
    cut = ridge.isel({"y" if along == "x" else "x": 3})
    suffix = "" if along == "x" else "_y"
    names = ["pressure", "displacement", "tangential_traction", "tangential_displacement"]
    names += [f"counter_body_{name}" for name in names if pair == "counter_body"]
    for name in names:
        scale = float(abs(profile[name]).max())
        of_map = cut[name + suffix * ("tangential" in name)]
        np.testing.assert_allclose(of_map, profile[name], atol=1e-8 * scale, err_msg=name)


def test_a_law_of_the_gap_acts_at_the_places_that_nodes_have_moved_to():
    """Finite elements under the tractions found move as found, and the law of the gap gives the pressure found."""
    work, reach = 2e-5, 2e-3
    law = {"hard_wall": {}, "exponential": {"work_of_adhesion": work, "range": reach}}
    found = solved(2, body=SLAB | {"roughness": heights(CREST)}, roughness=heights(wave(X)), interface=law)
    modulus = 1.0 / (1.0 - SLAB["poissons_ratio"] ** 2)
    body = mesh(CREST, SLAB)
    on_nodes = on_quadratic_elements(X, 2 * COLUMNS).T / NX / modulus
    tractions = [found["tangential_traction"], -found["pressure"]]
    moved = body.compliance() @ np.concatenate([on_nodes @ each.values for each in tractions])
    assert off(found, np.split(moved, 2)) < 4e-5  # edges of contact are known to half a node
    sideways, out = found["tangential_displacement"].values, found["displacement"].values
    gap = (CREST + wave(X)).max() - 0.5 * SIZE - wave(X + sideways) - CREST - out
    np.testing.assert_allclose(gap, found["gap"], atol=1e-9)
    apart = found["gap"].values > 1e-9
    attraction = work / reach * np.exp(-gap / reach)
    np.testing.assert_allclose(found["pressure"].values[apart], -attraction[apart], rtol=1e-5)
    along = -found["pressure"].values * slope_of_wave(X + sideways)
    np.testing.assert_allclose(found["tangential_traction"], along, atol=1e-6 * abs(along).max())


def test_two_bodies_that_change_places_find_the_same():
    """Pressures belong to the nodes of one of them, so that grids differ, but not what they stand for."""
    low, high = SLAB | {"roughness": heights(CREST)}, OTHER | {"roughness": heights(wave(X) - wave(X).mean())}
    one, two = (solved(2, body=a, counter_body=b) for a, b in ((low, high), (high, low)))
    lowest = solved(0, body=low, counter_body=high)
    for name in ("displacement", "tangential_displacement"):
        for first, second in ((name, f"counter_body_{name}"), (f"counter_body_{name}", name)):
            error = abs(one[first] - lowest[first]).max()
            assert abs(one[first] - two[second]).max() < 0.05 * error
    assert float(one["pressure"].mean()) == pytest.approx(float(two["pressure"].mean()), rel=1e-4)


@pytest.mark.long
def test_both_bodies_bear_the_same_forces_and_fields_know_them():
    upper = {"roughness": heights(wave(X) - wave(X).mean())}
    found = solved(2, body=SLAB | {"roughness": heights(CREST)}, counter_body=OTHER | upper)
    assert float(found["counter_body_pressure"].mean()) == pytest.approx(float(found["pressure"].mean()), rel=1e-12)
    pulls = [float(found[f"{prefix}tangential_traction"].mean()) for prefix in ("", "counter_body_")]
    assert pulls[0] == pytest.approx(-pulls[1], rel=1e-12)
    assert abs(pulls[0]) > 1e-3 * float(found["pressure"].mean())
    for body, prefix in (("body", ""), ("counter_body", "counter_body_")):
        inside = gfmd_numba.body_fields(found, [0.0], body).isel(z=0)
        slope = grid.signal(grid.derivative(grid.coefficients(found[f"{body}_height"].values)), NX)
        for component, name in ((1, "tangential_displacement"), (3, "displacement")):
            np.testing.assert_allclose(inside[f"displacement_{component}"], found[prefix + name], atol=1e-12)
        np.testing.assert_allclose(inside["pressure"], found[f"{prefix}pressure"], atol=1e-12)
        shear = inside["stress_5"] - slope * inside["stress_1"] - found[f"{prefix}tangential_traction"].values
        low = np.arange(NX // 2 + 1) < NX // 8
        assert abs(grid.signal(grid.coefficients(shear.values) * low, NX)).max() < 2e-3 * float(found["pressure"].max())
    with pytest.raises(gfmd_numba.InputError, match="a contact that was altered"):
        gfmd_numba.body_fields(found.drop_vars("counter_body_pressure"), [0.0], "counter_body")


@pytest.mark.long
def test_a_smooth_body_below_a_nearly_rigid_one_follows_the_inclined_punch():
    """A rigid punch on a smooth body is the linear theory instead, whose pressure acts along z."""
    stiff, deep = {"youngs_modulus": 1e7, "poissons_ratio": 0.2, "aspect_ratio": 1.0}, 3.0 * SIZE
    facing = stiff | {"roughness": heights(wave(X) - wave(X).mean())}
    found = solved(2, body=SLAB, counter_body=facing, loading={"displacement": deep})
    body, top = mesh(0.0 * X, SLAB), wave(X).max() - deep
    touching = found["pressure"].values[::OVER] > 0.0
    expected = body.along_top(body.press_inclined(lambda x: top - wave(x), lambda x: -slope_of_wave(x), touching))
    linear = solved(None, body=SLAB, roughness=heights(wave(X)), loading={"displacement": deep})
    inside = gfmd_numba.body_fields(linear, [0.0]).isel(z=0)
    by_theory = abs(inside["displacement_1"].values[::OVER] - expected[0]).max()
    assert by_theory > 3e-5
    assert off(found, expected) < 0.05 * by_theory  # the mesh's own error


@pytest.mark.long
@pytest.mark.parametrize("facing", ["roughness", "counter_body"])
def test_a_diagonal_ridge_is_the_profile_seen_at_an_angle(facing):
    """Half-spaces know no length: a diagonal ridge has a period shorter by the root of 2, and all lengths with it."""
    nx, root = 32, np.sqrt(0.5)
    x, diagonal = np.arange(nx) / nx, np.add.outer(np.arange(nx), np.arange(nx)) % nx
    own, above = -0.01 * np.cos(2 * np.pi * x), 0.004 * np.cos(4 * np.pi * (x - 0.07))

    def parts(made):
        other = {"roughness": heights(made(above))}
        bodies = [each | {"aspect_ratio": np.inf} for each in (SLAB, OTHER)]
        lower = {"body": bodies[0] | {"roughness": heights(made(own))}}
        return lower | (other if facing == "roughness" else {"counter_body": bodies[1] | other})

    load = {"reduced_pressure": 0.1}
    profile = solved(2, 1, load, 1e-10, **parts(np.array))
    ridge = solved(2, 2, load, 1e-10, **parts(lambda each: root * each[diagonal]))
    names = {"pressure": 1.0, "displacement": root, "tangential_traction": root, "tangential_displacement": root**2}
    names |= {f"counter_body_{name}": ratio for name, ratio in names.items()} if facing == "counter_body" else {}
    for name, ratio in names.items():
        scale = float(abs(profile[name]).max())
        for suffix in ("", "_y") if "tangential" in name else ("",):
            expected = ratio * profile[name].values[diagonal]
            np.testing.assert_allclose(ridge[name + suffix], expected, atol=1e-5 * scale, err_msg=name + suffix)
