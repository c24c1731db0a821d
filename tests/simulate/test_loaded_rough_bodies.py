"""Rough bodies loaded without a punch: displacements against finite elements, and fields on the true surface."""

import numpy as np
import pytest
import yaml
from finite_elements import Body, graded
from scipy.sparse.linalg import splu

import gfmd_numba
from gfmd_numba.elasticity import fields
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.scene import InputError
from support.command_line import gfmd

pytestmark = pytest.mark.usefixtures("undrawn")

NX, N, NU, HEIGHT = 128, 12, 0.3, 0.5
X = np.arange(NX) / NX
X2, Y2 = np.meshgrid(np.arange(N) / N, np.arange(N) / N)
BUMPY = np.cos(2 * np.pi * (X2 - Y2)) + 0.5 * np.sin(2 * np.pi * Y2)
ALONG, NORMAL = ("tangential", "tangential", "normal"), ("", "_y", "")


def surface(x):
    return 0.005 * np.cos(2 * np.pi * x) + 0.0015 * np.sin(4 * np.pi * x)


def tractions(x):
    return np.stack((2e-3 * np.sin(2 * np.pi * x) + 1e-3, 3e-3 * np.cos(4 * np.pi * x + 0.3) - 1e-3))


def saved(folder, **arrays):
    for name, array in arrays.items():
        np.save(folder / f"{name}.npy", array)
    return {name: str(folder / f"{name}.npy") for name in arrays}


def measured(folder, heights):
    return {"method": "measured", "units": {"z": "L_x"}, "file": saved(folder, heights=heights)["heights"]}


def solved(folder, heights, order, body=(), **boundary):
    given = {"poissons_ratio": NU, "aspect_ratio": HEIGHT, "roughness": measured(folder, heights)} | dict(body)
    scene = {"body": given, "boundary": saved(folder, **boundary)}
    found = gfmd_numba.solve({"scene": scene, "numerics": {"topography_order": order, "residual": 1e-9}})
    assert int(found["status"]) == 0
    return found


@pytest.fixture(scope="module")
def finite_elements():
    """Displacements `[component, x]` of the top nodes of a slab whose top is rough, under tractions per length of x."""
    columns, edge = NX // 2, np.array([[4, 2, -1], [2, 16, 2], [-1, 2, 4]]) / 30
    body = Body(
        columns,
        graded(HEIGHT, columns // 2, 1 / columns),
        NU,
        lambda x, z: (np.zeros_like(x), surface(x) * (1.0 + z / HEIGHT)),
    )
    force, rows = np.zeros(body.stiffness.shape[0]), (body._partners(), body.top)
    for first in range(0, NX, 2):
        nodes = np.arange(first, first + 3)
        for row, of_nodes in zip(rows, tractions(nodes / NX), strict=True):
            force[row[nodes % NX]] += edge @ of_nodes / columns
    free = np.flatnonzero(body.owned_label[1] > -HEIGHT + 1e-9)
    moved = np.zeros_like(force)
    moved[free] = splu(body.stiffness[free][:, free].tocsc()).solve(force[free])
    return np.stack([moved[row] for row in rows])


def displacements(found):
    names = ("tangential_displacement", "tangential_displacement_y", "normal_displacement")
    return np.stack([found[name].values for name in names if name in found])


@pytest.mark.long
@pytest.mark.parametrize(("order", "off"), [(0, 5e-5), (2, 3e-8)])
def test_tractions_on_a_rough_slab_displace_it_as_finite_elements_say(finite_elements, tmp_path, order, off):
    along, normal = tractions(X)
    found = solved(tmp_path, surface(X), order, tangential_traction=along, normal_traction=normal)
    error = float(abs(displacements(found) - finite_elements).max())
    assert error < off
    assert 0.3 * error < float(found["next_order"]) < 2.0 * error
    np.testing.assert_allclose(found["normal_traction"], normal, atol=1e-12)
    np.testing.assert_allclose(found["body_height"], surface(X), atol=1e-12)


@pytest.mark.long
@pytest.mark.parametrize(("order", "off"), [(0, 5e-1), (2, 2e-3)])
def test_a_rough_slab_that_is_displaced_bears_the_tractions_of_finite_elements(finite_elements, tmp_path, order, off):
    """Where a third of the nodes is put where the tractions carry them, these have to come out."""
    held, (along, normal) = (X > 0.3) & (X < 0.6), tractions(X)
    given = {
        "tangential_traction": np.where(held, np.nan, along),
        "normal_traction": np.where(held, np.nan, normal),
        "tangential_displacement": np.where(held, finite_elements[0], np.nan),
        "normal_displacement": np.where(held, finite_elements[1], np.nan),
    }
    found = solved(tmp_path, surface(X), order, **given)
    np.testing.assert_array_equal(displacements(found)[:, held], finite_elements[:, held])
    borne = np.stack([found["tangential_traction"], found["normal_traction"]])
    assert abs(borne - tractions(X)).max() < off * abs(normal).max()


def on_true_surface(size):
    """Heights, and tractions and displacements `[component, y, x]` on them, of a field in a slab whose top is flat."""
    heights = size * BUMPY
    highest = heights.max()
    flat = ElasticBody(NU, HEIGHT + highest)
    waves = np.cos(2 * np.pi * X2), np.sin(2 * np.pi * (X2 + Y2)), 1.0 + np.cos(2 * np.pi * Y2)
    top = fields.surface_under_tractions(1e-3 * np.stack(waves), flat)
    names = ("stress1", "stress6", "stress2", "stress5", "stress4", "stress3", "u1", "u2", "u3")
    found = np.empty((len(names), N, N))
    for i, j in np.ndindex(N, N):
        depth = heights[i, j : j + 1] - highest
        found[:, i, j] = fields.Inside((top,), flat).section(depth, names, "y", i / N)[:, 0, j]
    s1, s6, s2, s5, s4, s3, *moved = found
    in_x = -2 * np.pi * size * np.sin(2 * np.pi * (X2 - Y2))
    in_y = -in_x + np.pi * size * np.cos(2 * np.pi * Y2)
    rows = ((s5, s1, s6), (s4, s6, s2), (s3, s5, s4))
    return heights, np.stack([s - in_x * along - in_y * across for s, along, across in rows]), np.stack(moved)


def keys(quantity):
    return [f"{name}_{quantity}{end}" for name, end in zip(ALONG, NORMAL, strict=True)]


@pytest.mark.long
def test_every_order_brings_a_loaded_map_nearer_to_the_field_on_its_true_surface(tmp_path):
    errors = []
    for size in (0.004, 0.002):
        heights, traction, moved = on_true_surface(size)
        given = dict(zip(keys("traction"), traction, strict=True))
        found = [displacements(solved(tmp_path, heights, order, **given)) for order in (0, 1, 2)]
        errors.append([abs(each - moved).max() for each in found])
    assert (np.log2(np.divide(*errors)) > np.array([0.8, 1.7, 2.6])).all(), errors
    assert errors[1][2] < 1e-4 * abs(moved).max()


@pytest.mark.long
def test_a_displaced_map_bears_the_tractions_of_the_field_on_its_true_surface(tmp_path):
    heights, traction, moved = on_true_surface(0.004)
    held, worst = np.hypot(X2 - 0.5, Y2 - 0.5) < 0.3, []
    for order in (0, 1, 2):
        given = {}
        for names, values, at in ((keys("traction"), traction, ~held), (keys("displacement"), moved, held)):
            given |= {name: np.where(at, each, np.nan) for name, each in zip(names, values, strict=True)}
        found = solved(tmp_path, heights, order, **given)
        worst.append(max(float(abs(found[name] - each).max()) for name, each in zip(given, traction, strict=False)))
    assert worst[1] < 0.1 * worst[0]
    assert worst[2] < 1e-3 * abs(traction).max()


@pytest.mark.parametrize("order", [0, 2])
def test_fields_inside_a_loaded_rough_body_end_in_its_surface(tmp_path, order):
    along, normal = tractions(X)
    found = solved(tmp_path, surface(X), order, tangential_traction=along, normal_traction=normal)
    inside = gfmd_numba.body_fields(found, z=[0.0, -0.1]).isel(z=0)
    scale = float(abs(found["normal_displacement"]).max())
    for name, of_surface in (("displacement_1", "tangential"), ("displacement_3", "normal")):
        np.testing.assert_allclose(inside[name], found[f"{of_surface}_displacement"], atol=1e-9 * scale)
    np.testing.assert_allclose(inside["formed_3"], surface(X), atol=1e-12)


def test_fields_below_a_loaded_rough_map_are_those_of_a_flat_one_at_labels(tmp_path):
    given = dict(zip(keys("traction"), 1e-3 * np.stack([BUMPY, -BUMPY, BUMPY**2]), strict=True))
    rough = gfmd_numba.body_fields(solved(tmp_path, 0.004 * BUMPY, 0, **given), z=[0.0, -0.2], y=0.25)
    flat = {"scene": {"body": {"poissons_ratio": NU, "aspect_ratio": HEIGHT}, "boundary": saved(tmp_path, **given)}}
    plain = gfmd_numba.body_fields(
        gfmd_numba.solve(flat | {"scene": flat["scene"] | {"dimension": 2}}), z=[0, -0.2], y=0.25
    )
    np.testing.assert_allclose(rough["stress_5"], plain["stress_5"], atol=1e-12)
    np.testing.assert_allclose(rough["formed_3"].isel(z=0), 0.004 * BUMPY[3], atol=1e-12)


def test_units_and_a_random_topography_are_those_of_scenes(tmp_path):
    """The body of a contact has the same topography, and 100 um times the displacements of the one in L_x."""
    psd = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}
    eps = {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1 / 2}
    body, drawn = {"poissons_ratio": NU, "aspect_ratio": HEIGHT, "roughness": psd}, {"seed": 3, "realisation": 2}
    wave = np.cos(2 * np.pi * X)
    one = gfmd_numba.solve(
        {"scene": {"body": body, "boundary": saved(tmp_path, normal_traction=wave)}, "discretisation": eps} | drawn
    )
    pressed = {"body": body, "interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.01}}
    contact = gfmd_numba.solve({"scene": pressed, "discretisation": eps} | drawn)
    np.testing.assert_array_equal(one["body_height"], contact["body_height"])
    young = 70e9 * (1 - NU**2)
    scene = {"length": 1e-4, "body": body | {"youngs_modulus": young}}
    scene["boundary"] = saved(tmp_path, normal_traction=70e9 * wave)
    two = gfmd_numba.solve({"scene": scene, "discretisation": eps} | drawn)
    assert two["next_order"].units == two["body_height"].units == "m"
    for name in ("normal_displacement", "body_height", "next_order"):
        np.testing.assert_allclose(two[name], 1e-4 * one[name], rtol=1e-9, atol=1e-18)
    assert two["forming_traction"].units == "Pa"


ROUGH = {"body": {"poissons_ratio": NU, "aspect_ratio": HEIGHT}, "boundary": {"tangential_traction": 1e-3}}
PSD = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01, "points": 64, "roll_off": 0.5, "cut_on": 0.1}
LAYERED = {"layers": [{"height": 0.1, "youngs_modulus": 1.0, "poissons_ratio": 0.3}], "base": "rigid"}


@pytest.mark.parametrize(
    ("body", "more", "said"),
    [
        (
            {"roughness": PSD},
            {"points": 64},
            "points: you gave 64; gfmd allows nothing here, as the surfaces have a grid",
        ),
        (
            {"roughness": PSD | {"rms_gradient": 9.0}},
            {},
            "scene.body.roughness: you gave a topography from .*; gfmd allows one",
        ),
        ({"roughness": PSD | {"points": None, "cut_on": None, "roll_off": None}}, {}, "discretisation: you gave"),
        (
            {},
            {"points": 8, "numerics": {"topography_order": 1}},
            "topography_order: you gave 1; gfmd allows nothing where no",
        ),
        ({}, {"points": 8, "seed": 3}, "seed: you gave 3; gfmd allows nothing, as no surface"),
        (
            {"roughness": PSD | {"anisotropy": 2.0}},
            {},
            "body.roughness.anisotropy: you gave 2.0; gfmd allows nothing with dim",
        ),
    ],
)
def test_what_a_loaded_rough_body_cannot_be_is_said_with_its_place(body, more, said):
    with pytest.raises(InputError, match=said):
        gfmd_numba.solve({"scene": ROUGH | {"body": ROUGH["body"] | body}} | more)


@pytest.mark.parametrize("order", [0, 2])
def test_layers_of_nearly_one_material_are_a_slab_of_it(tmp_path, order):
    """But for rounding: layers of exactly one material are taken for a slab from the start."""
    stiffness = {0.2: 2.0, HEIGHT - 0.2: 2.0 + 2e-10}
    layers = [{"height": z, "youngs_modulus": modulus, "poissons_ratio": NU} for z, modulus in stiffness.items()]
    wave = dict(zip(("tangential_traction", "normal_traction"), tractions(X), strict=True))
    boundary, roughness = saved(tmp_path, **wave), measured(tmp_path, surface(X))
    bodies = {"youngs_modulus": 2.0, "poissons_ratio": NU, "aspect_ratio": HEIGHT}, {"layers": layers, "base": "rigid"}
    numerics = {"topography_order": order}
    plain, layered = (
        gfmd_numba.solve(
            {"scene": {"body": body | {"roughness": roughness}, "boundary": boundary}, "numerics": numerics}
        )
        for body in bodies
    )
    for name in ("normal_displacement", "tangential_displacement"):
        np.testing.assert_allclose(layered[name], plain[name], atol=1e-8 * float(abs(plain[name]).max()))


def test_valleys_through_the_topmost_layer_are_refused_above_order_0():
    layered = {"scene": {"body": LAYERED | {"roughness": PSD}, "boundary": {"tangential_traction": 1e-3}}}
    thin = LAYERED["layers"][0] | {"height": 1e-6, "youngs_modulus": 2.0}
    deep = {"layers": [thin, *LAYERED["layers"]], "base": "rigid", "roughness": PSD}
    order_1 = {"numerics": {"topography_order": 1}}
    assert int(gfmd_numba.solve(layered | order_1)["status"]) == 0
    with pytest.raises(InputError, match=r"gfmd allows valleys above the lower side of the topmost layer"):
        gfmd_numba.solve({"scene": layered["scene"] | {"body": deep}} | order_1)


def test_steep_bodies_are_doubted():
    steep = {"scene": ROUGH | {"body": ROUGH["body"] | {"roughness": PSD | {"rms_gradient": 0.1}}}}
    with pytest.warns(UserWarning, match="above 0.03: "):
        assert "above 0.03: " in gfmd_numba.solve(steep).attrs["validity"]


@pytest.mark.long
def test_commands_check_solve_and_draw_a_loaded_rough_body(tmp_path):
    saved(tmp_path, heights=surface(X), wave=tractions(X)[0])
    body = ROUGH["body"] | {"roughness": {"method": "measured", "units": {"z": "L_x"}, "file": "heights.npy"}}
    scene = {"body": body, "boundary": {"tangential_traction": "wave.npy"}}
    (tmp_path / "rough.yaml").write_text(yaml.safe_dump({"scene": scene}))
    contact, fields = tmp_path / "rough.nc", tmp_path / "fields.nc"
    for command in (
        ("check", tmp_path / "rough.yaml"),
        ("solve", tmp_path / "rough.yaml", "-o", contact),
        ("plot", contact),
    ):
        done = gfmd(*command)
        assert done.exit_code == 0, done.output
    assert gfmd("fields", contact, "-o", fields).exit_code == 0
    assert {"rough.png", "fields.png"} <= {path.name for path in tmp_path.iterdir()}
