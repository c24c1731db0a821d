"""A rough layered body, whose interfaces are flat: contact and fields inside compared with finite elements."""

import numpy as np
import pytest
from finite_elements import Body, graded

import gfmd_numba
from gfmd_numba.elasticity import topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.scene import InputError

pytestmark = [
    pytest.mark.filterwarnings("ignore:a deformable surface has an rms gradient"),
    pytest.mark.filterwarnings("ignore:the roughness of a deformable body changes"),
]
TOP, BELOW = 0.1, 0.4
NX, COLUMNS = 512, 128
X = np.arange(NX) / NX
EPS = {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1 / 2}
BODIES = {
    "hard on soft": ElasticBody.layered((TOP, BELOW), (Material(1.0, 0.3), Material(0.1, 0.4)), None),
    "soft on hard": ElasticBody.layered((TOP, BELOW), (Material(1.0, 0.4), Material(10.0, 0.2)), None),
}


def layers_of(body):
    """Layers of a scene whose topmost one has the modulus E* = 1."""
    return {
        "layers": [
            {
                "height": height,
                "youngs_modulus": material.modulus * (1 - material.poissons_ratio**2),
                "poissons_ratio": material.poissons_ratio,
            }
            for height, material in zip(body.stack.heights, body.stack.materials, strict=True)
        ],
        "base": "rigid",
    }


def solved(body, heights, depth, order):
    rough = {"method": "measured", "heights": heights, "units": {"z": "L_x"}}
    made = layers_of(body) if body.stack else {"youngs_modulus": 0.91, "poissons_ratio": 0.3, "aspect_ratio": 0.5}
    scene = {
        "body": made | {"roughness": rough},
        "interface": {"hard_wall": {}},
        "loading": {"displacement": depth},
    }
    found = gfmd_numba.solve({"scene": scene, "numerics": {"topography_order": order, "residual": 1e-9}})
    assert found["status"] == 0
    return found


def finite_elements(body, heights, depth, guess):
    """Mesh and contact; its nodes are moved by u'', so that their labels are those of the fields inside."""

    def formed(x, z):
        levels, row = np.unique(np.round(z, 12), return_inverse=True)
        moved = topography.formed_at(heights, np.minimum(levels, 0.0), body, 1, ("u1", "u3"))
        return moved[:, row, np.rint(x * NX).astype(int) % NX]

    def materials(depth):
        found = body.material(depth)
        return found.modulus, found.poissons_ratio

    edges = np.concatenate((graded(BELOW, 12, 0.02)[:-1] - TOP, graded(TOP, 14, 0.5 / COLUMNS)))
    mesh, over = Body(COLUMNS, edges, None, formed, materials=materials), NX // (2 * COLUMNS)
    return mesh, mesh.press((heights.max() - heights - depth)[::over], guess[::over].copy())


@pytest.mark.long
def test_a_rough_layered_body_is_that_of_finite_elements_with_flat_interfaces():
    body, over, worst = BODIES["hard on soft"], NX // (2 * COLUMNS), []
    for amplitude in (0.01, 0.005):
        heights, depth = -amplitude * np.cos(2 * np.pi * X), 0.5 * amplitude
        found = [solved(body, heights, depth, order) for order in (0, 1, 2)]
        mesh, solution = finite_elements(body, heights, depth, found[2]["pressure"].values > 0.0)
        tangential, normal = mesh.along_top(solution)
        errors = [
            max(
                abs(each["tangential_displacement"].values[::over] - tangential).max(),
                abs(each["displacement"].values[::over] - normal).max(),
            )
            for each in found
        ]
        assert 0.2 < errors[0] / float(found[0]["next_order"]) < 2.0
        assert 0.5 < errors[1] / float(found[1]["next_order"]) < 2.0
        assert errors[2] < 3e-6  # the mesh's own error
        worst.append(errors)
        pressures = [float(each["pressure"].mean()) / -mesh.traction(solution).mean() - 1.0 for each in found]
        assert abs(pressures[0]) > 3.0 * amplitude
        assert abs(pressures[2]) < 3e-3
    assert worst[0][0] / worst[1][0] > 3.0  # as slope times load
    assert worst[0][1] / worst[1][1] > 5.5
    levels = np.unique(np.round(mesh.inside(solution)[1], 12))
    lowest, _, second = (gfmd_numba.body_fields(each, levels) for each in found)
    x, z, _, _, *stresses = mesh.inside(solution)
    row, column = np.searchsorted(levels, np.round(z, 12)), np.rint(x * NX).astype(int) % NX
    for component, expected in zip((1, 3, 5), stresses, strict=True):
        for where in ((z < -0.02) & (z > -TOP), z < -TOP):
            off = [
                np.sqrt(((each[f"stress_{component}"].values[row, column] - expected)[where] ** 2).mean())
                for each in (lowest, second)
            ]
            assert off[1] < 1e-3 * abs(expected[where]).max(), component
            assert off[1] < 0.1 * off[0], component


def test_labels_meet_the_rough_surface_and_the_flat_interface():
    heights, body = 0.01 * np.cos(2 * np.pi * X), BODIES["soft on hard"]
    found = solved(body, heights, 2e-3, 2)
    inside = gfmd_numba.body_fields(found, [0.0, -0.5 * TOP, -TOP, -1.5 * TOP])
    np.testing.assert_allclose(inside["formed_3"].values[0], heights, atol=1e-14)
    assert abs(inside["formed_3"].values[1]).max() > 1e-3
    assert abs(inside["formed_3"].values[2:]).max() < 1e-30
    np.testing.assert_allclose(inside["displacement_3"].values[0], found["displacement"], atol=1e-12)
    np.testing.assert_allclose(inside["displacement_1"].values[0], found["tangential_displacement"], atol=1e-12)


def test_the_field_is_continuous_through_a_flat_interface_and_bears_the_same_tractions():
    body = BODIES["hard on soft"]
    found = solved(body, -0.01 * np.cos(2 * np.pi * X), 5e-3, 2)
    inside = gfmd_numba.body_fields(found, [-TOP + 1e-9, -TOP - 1e-9])
    for name in ("displacement_1", "displacement_3", "stress_3", "stress_5"):
        above, below = inside[name].values
        np.testing.assert_allclose(above, below, atol=1e-6 * abs(above).max(), err_msg=name)
    above, below = inside["stress_1"].values
    assert abs(above - below).max() > 0.1 * abs(above).max()


@pytest.mark.parametrize("order", [1, 2])
def test_layers_of_almost_one_material_are_a_slab(order):
    alike = ElasticBody.layered((TOP, BELOW), (Material(1.0, 0.3), Material(1.0 + 1e-9, 0.3)), None)
    heights = 0.01 * np.cos(2 * np.pi * X)
    layered, uniform = (solved(body, heights, 2e-3, order) for body in (alike, ElasticBody(0.3, TOP + BELOW)))
    for name in ("pressure", "displacement", "tangential_displacement", "next_order"):
        np.testing.assert_allclose(layered[name], uniform[name], atol=1e-7 * float(abs(uniform[name]).max()))


def test_order_0_is_doubted_where_the_topmost_layer_changes_its_thickness_and_higher_ones_are_not():
    body, heights = BODIES["soft on hard"], -0.004 * np.cos(2 * np.pi * X)
    doubted, followed = (solved(body, heights, 1e-3, order) for order in (0, 1))
    assert "changes the thickness of its topmost layer by up to 0.04 of it, which order 0" in doubted.attrs["validity"]
    assert followed.attrs["validity"] == ""
    off = float(doubted["pressure"].mean()) / float(followed["pressure"].mean()) - 1.0
    assert 0.5 < off / 0.04 < 2.0
    thick = ElasticBody.layered((2.0, BELOW), body.stack.materials, None)
    assert solved(thick, heights, 1e-3, 0).attrs["validity"] == ""


def test_valleys_through_the_topmost_layer_are_refused_at_higher_orders_alone():
    body = ElasticBody.layered((0.02, BELOW), BODIES["hard on soft"].stack.materials, None)
    heights = 0.03 * np.cos(2 * np.pi * X)
    allowed = (
        r"scene.body.roughness: you gave a topography from -0.03 to 0.03 L_x; gfmd allows valleys above the lower "
        r"side of "
        r"the topmost layer, -0.02 L_x, or a numerics.topography_order of 0"
    )
    with pytest.raises(InputError, match=allowed):
        solved(body, heights, 1e-3, 1)
    assert solved(body, heights, 1e-3, 0)["status"] == 0
