"""Friction and cohesive laws between inclined surfaces at higher orders: finite elements, ridges, laws at each node."""

import numpy as np
import pytest
from finite_elements import Body, graded
from finite_elements_of_two import on_quadratic_elements

import gfmd_numba
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw

NX, COLUMNS = 256, 64
X = np.arange(NX) / NX
OVER = NX // (2 * COLUMNS)
SIZE = 0.01
CREST = -SIZE * np.cos(2 * np.pi * X)
SLAB = {"youngs_modulus": 1.0, "poissons_ratio": 0.2, "aspect_ratio": 1.0}
MODULUS = 1.0 / (1.0 - 0.2**2)
OTHER = {"youngs_modulus": 0.5, "poissons_ratio": 0.35, "aspect_ratio": 0.5}
DOWN = {"displacement": 0.5 * SIZE}
NAMES = ("tangential_displacement", "displacement")
FRICTION = {"hard_wall": {}, "friction": {"coefficient": 0.3}}
LAW = {"work_of_adhesion": 2e-3 * SIZE, "normal_length": 0.2 * SIZE, "tangential_length": 0.3 * SIZE}
COHESION = {"cohesive": LAW}

pytestmark = pytest.mark.filterwarnings("ignore:a deformable surface has an rms gradient")


def wave(x):
    return SIZE * (0.4 * np.cos(6 * np.pi * (x - 0.07)) + 0.3 * np.sin(2 * np.pi * x))


def slope_of_wave(x):
    return SIZE * np.pi * (-2.4 * np.sin(6 * np.pi * (x - 0.07)) + 0.6 * np.cos(2 * np.pi * x))


def heights(values):
    return {"roughness": {"method": "measured", "heights": values, "units": {"z": "L_x"}}}


def solved(order, interface=FRICTION, path=(), loading=DOWN, residual=1e-9, dimension=1, **parts):
    scene = {"dimension": dimension, "interface": interface, "loading": loading} | parts
    numerics = {"topography_order": order, "residual": residual}
    found = gfmd_numba.solve({"scene": scene, "numerics": numerics} | ({"path": list(path)} if path else {}))
    assert (found["status"] == 0).all()
    return found


def under_punch(order, **more):
    return solved(order, body=SLAB | heights(CREST), **heights(wave(X)), **more)


def mesh():
    """Slab of quadratic elements whose nodes are stretched to the crest."""

    def stretched(x, z):
        return 0 * x, CREST[np.rint(x * NX).astype(int) % NX] * (1.0 + z)

    return Body(COLUMNS, graded(1.0, 24, 0.5 / COLUMNS), 0.2, stretched)


def errors(found, expected):
    return max(abs(found[name].values[::OVER] - each).max() for name, each in zip(NAMES, expected, strict=True))


@pytest.mark.long
def test_a_punch_that_slides_on_a_rough_body_is_that_of_finite_elements():
    sliding, friction = 0.6 * SIZE, 0.3
    found = [under_punch(order, path=[{"sliding": sliding}]).isel(step=1) for order in range(3)]
    body, top = mesh(), (CREST + wave(X)).max() - DOWN["displacement"]
    touching = found[2]["pressure"].values[::OVER] > 0.0
    solution = body.press_inclined(lambda x: top - wave(x), lambda x: -slope_of_wave(x), touching, sliding, friction)
    expected = body.along_top(solution)
    off = [errors(each, expected) for each in found]
    assert off[0] > 3e-4
    assert 0.5 < off[0] / float(found[0]["next_order"]) < 2.0
    assert off[1] < 0.03 * off[0]
    assert off[2] < 1e-5  # the mesh's own error
    for each in found:
        assert float(each["stick_fraction"]) == 0.0
    dragged = -solution.reaction[body.along_x].sum() / solution.reaction[body.top].sum()
    assert float(found[2]["mean_tangential_traction"] / found[2]["mean_pressure"]) == pytest.approx(dragged, rel=2e-3)


@pytest.mark.long
def test_nodes_stick_and_slip_where_they_have_moved_to():
    """Finite elements under the tractions found move as found, and each node obeys Coulomb's law on its slope."""
    path = [{"sliding": 2e-4}, {"sliding": 1e-3}, {"displacement": 3e-3}]
    found = under_punch(2, path=path)
    body = mesh()
    compliance, on_nodes = body.compliance(), on_quadratic_elements(X, 2 * COLUMNS).T / NX / MODULUS
    before, touched = np.zeros(NX), np.zeros(NX, bool)
    for i in range(4):
        step = found.isel(step=i)
        slid, depth = (float(step[name]) for name in ("sliding", "punch_displacement"))
        tractions = [step["tangential_traction"], -step["pressure"]]
        moved = compliance @ np.concatenate([on_nodes @ each.values for each in tractions])
        assert errors(step, np.split(moved, 2)) < 4e-5  # edges of contact are known to half a node
        sideways, out = (step[name].values for name in NAMES)
        places = X + sideways - slid
        gap = (CREST + wave(X)).max() - depth - wave(places) - CREST - out
        np.testing.assert_allclose(gap, step["gap"], atol=1e-8 * SIZE)
        slope, along, pressure = (
            -slope_of_wave(places),
            step["surface_traction"].values,
            step["surface_pressure"].values,
        )
        largest = pressure.max()
        np.testing.assert_allclose(step["tangential_traction"], along + slope * pressure, atol=1e-6 * largest)
        np.testing.assert_allclose(step["pressure"], pressure - slope * along, atol=1e-6 * largest)
        touching = pressure > 0.0
        assert (abs(along) <= 0.3 * pressure + 1e-6 * largest).all()
        slipped = (sideways - slid) - before
        sticks = abs(along) < 0.3 * pressure - 1e-6 * largest
        assert abs(slipped[sticks & touched]).max(initial=0.0) < 1e-8 * SIZE
        drags = touching & ~sticks & (abs(slipped) > 1e-8 * SIZE)
        assert (np.sign(along[drags]) == -np.sign(slipped[drags])).all()
        assert 0 < sticks.sum() < touching.sum()
        before, touched = sideways - slid, touching


@pytest.mark.long
def test_a_cohesive_law_along_inclined_surfaces_is_that_of_finite_elements():
    """Forces are the derivatives of one energy, of the gap and of the slip along the surface that parts."""
    depth, sliding = 0.3 * SIZE, 0.1 * SIZE
    loading = {"loading": {"displacement": depth}, "path": [{"sliding": sliding}], "interface": COHESION}
    body_of_1 = SLAB | {"youngs_modulus": 1.0 - 0.2**2}
    found = [solved(order, body=body_of_1 | heights(CREST), **heights(wave(X)), **loading) for order in range(3)]
    top, guess = (CREST + wave(X)).max() - depth, [found[2].isel(step=1)[name].values[::OVER] for name in NAMES]
    expected = mesh().under_inclined_law(
        lambda x: top - wave(x), lambda x: -slope_of_wave(x), sliding, XuNeedlemanLaw(*LAW.values()), guess
    )
    off = [errors(each.isel(step=1), expected) for each in found]
    assert off[0] > 2e-5
    assert off[1] < 0.05 * off[0]
    assert off[2] < 2e-6  # the mesh's own error


@pytest.mark.long
@pytest.mark.parametrize("interface", [FRICTION, COHESION], ids=["friction", "cohesion"])
def test_a_nearly_rigid_counter_body_is_a_rigid_punch(interface):
    facing = (wave(X) - wave(X).mean())[::4]
    path = [{"sliding": 1e-3}, {"displacement": 3e-3}]
    stiff = {"youngs_modulus": 1e7, "poissons_ratio": 0.2, "aspect_ratio": 1.0}
    above = heights(facing), {"counter_body": stiff | heights(facing)}
    body = SLAB | heights(CREST[::4])
    rigid, elastic = (solved(2, interface=interface, path=path, body=body, **parts) for parts in above)
    for name in ("pressure", "tangential_traction", "tangential_displacement", "displacement"):
        np.testing.assert_allclose(elastic[name], rigid[name], atol=1e-5 * float(abs(rigid[name]).max()), err_msg=name)


@pytest.mark.long
@pytest.mark.parametrize("interface", [FRICTION, COHESION], ids=["friction", "cohesion"])
def test_two_bodies_that_change_places_find_the_same(interface):
    """What one slides to the right, the other does to the left; tractions are per area of one, so strains are left."""
    low, high = SLAB | heights(CREST), OTHER | heights(wave(X) - wave(X).mean())
    one, two, lowest = (
        solved(order, interface=interface, path=[{"sliding": way}], body=a, counter_body=b).isel(step=1)
        for order, way, a, b in ((2, 1e-3, low, high), (2, -1e-3, high, low), (0, 1e-3, low, high))
    )
    for name in NAMES:
        for first, second in ((name, f"counter_body_{name}"), (f"counter_body_{name}", name)):
            error = abs(one[first] - lowest[first]).max()
            assert abs(one[first] - two[second]).max() < (0.1 if interface is FRICTION else 0.2) * error, first
    for name in ("mean_pressure", "mean_tangential_traction"):
        sign = 1.0 if name == "mean_pressure" else -1.0
        assert float(one[name]) == pytest.approx(sign * float(two[name]), rel=2e-3 if interface is FRICTION else 1e-2)


@pytest.mark.parametrize(
    ("pair", "along", "interface", "nx"),
    [
        pytest.param("punch", "x", FRICTION, 16, id="friction", marks=pytest.mark.long),
        pytest.param("counter body", "y", COHESION, 28, id="cohesion", marks=pytest.mark.long),
    ],
)
def test_ridges_are_profiles(pair, along, interface, nx):
    x = np.arange(nx) / nx
    own, facing = -0.01 * np.cos(2 * np.pi * x), 0.004 * np.cos(6 * np.pi * (x - 0.07))
    suffix = "" if along == "x" else "_y"

    def parts(made, suffix):
        above = heights(made(facing))
        path = [{f"sliding{suffix}": 3e-4}, {f"sliding{suffix}": -1e-3, "displacement": 4e-3}]
        return {"body": SLAB | heights(made(own)), "path": path} | (
            above if pair == "punch" else {"counter_body": OTHER | above}
        )

    def tiled(profile):
        ridge = np.tile(profile, (nx, 1))
        return ridge if along == "x" else ridge.T.copy()

    profile = solved(2, interface, residual=1e-10, **parts(np.array, ""))
    ridge = solved(2, interface, residual=1e-10, dimension=2, **parts(tiled, suffix))
    cut = ridge.isel({"y" if along == "x" else "x": 3})
    names = ["pressure", "displacement", "tangential_traction", "tangential_displacement"]
    names += [f"counter_body_{name}" for name in names if pair == "counter body"]
    for name in (*names, "surface_pressure", "surface_traction"):
        scale = float(abs(profile[name]).max())
        of_map = cut[name + suffix * ("tangential" in name or name == "surface_traction")]
        np.testing.assert_allclose(of_map, profile[name], atol=1e-7 * scale, err_msg=name)


@pytest.mark.long
@pytest.mark.parametrize("facing", ["punch", "counter body"])
def test_a_load_is_borne_along_z(facing):
    """What rubs along inclined surfaces bears a part of the load."""
    above = heights(wave(X) - wave(X).mean())
    parts = above if facing == "punch" else {"counter_body": OTHER | above}
    path = [{"sliding": -2e-3, "reduced_pressure": 0.1}]
    loading = {"reduced_pressure": 0.05}
    found = solved(1, path=path, loading=loading, body=SLAB | heights(CREST), **parts)
    load = found["reduced_pressure"].values / 0.05 * float(found["mean_pressure"][0])
    np.testing.assert_allclose(found["mean_pressure"], load, rtol=1e-8)
    np.testing.assert_allclose(found["pressure"].mean("x"), load, rtol=1e-8)
    assert abs(found["surface_pressure"].mean("x") / load - 1.0).max() > 1e-3
    np.testing.assert_allclose(found["mean_tangential_traction"], found["tangential_traction"].mean("x"), rtol=1e-12)


@pytest.mark.parametrize("interface", [FRICTION, COHESION], ids=["friction", "cohesion"])
def test_fields_inside_bear_each_traction_once(interface, tmp_path):
    np.save(tmp_path / "shear.npy", 1e-3 * np.cos(2 * np.pi * X))
    boundary = {"tangential_traction": str(tmp_path / "shear.npy")}
    found = under_punch(1, interface=interface, boundary=boundary)
    inside = gfmd_numba.body_fields(found, [0.0]).isel(z=0)
    for component, name in ((1, "tangential_displacement"), (3, "displacement")):
        np.testing.assert_allclose(inside[f"displacement_{component}"], found[name], atol=1e-12)


@pytest.mark.long
def test_what_slips_across_the_slope_is_expected_to_be_off_by_half_its_square():
    """Coulomb compares forces on the surface; a slab of shear modulus 0.35 E* moves along y by the rest."""
    nx, size = 64, 0.02
    x = np.arange(nx) / nx

    def ridge(profile):
        return heights(np.tile(profile, (nx, 1)))

    own, facing = -size * np.cos(2 * np.pi * x), 0.5 * size * np.cos(4 * np.pi * (x - 0.13))
    body = {"poissons_ratio": 0.3, "aspect_ratio": 0.5} | ridge(own)
    dragged = {"dimension": 2, "loading": {"displacement": 0.4 * size}, "path": [{"sliding_y": 0.5 * size}]}
    found = solved(3, body=body, **ridge(facing), **dragged).isel(step=1, y=3)
    assert float(found["stick_fraction"]) == 0.0
    places = x + found["tangential_displacement"].values
    square = (2 * np.pi * size * np.sin(4 * np.pi * (places - 0.13))) ** 2
    pressure = found["surface_pressure"].values
    rubbing = np.hypot(found["surface_traction"], found["surface_traction_y"])  # nearly all of it along y
    np.testing.assert_allclose(rubbing, 0.3 * pressure, atol=1e-6 * pressure.max())
    q = 2 * np.pi * np.arange(nx // 2 + 1)
    stiffness = 0.35 * np.append(2.0, q[1:] / np.tanh(0.5 * q[1:]))
    off = np.fft.irfft(np.fft.rfft(0.3 * pressure * (np.sqrt(1.0 + square) - 1.0)) / stiffness, nx)
    assert float(found["next_order"]) == pytest.approx(abs(off).max(), rel=0.05)
