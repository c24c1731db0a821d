"""Layers in a scene: what a file may say, what it reduces to, and that every solver, campaigns and fields know them."""

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

import gfmd_numba
from gfmd_numba.analysis import plot_body
from gfmd_numba.analysis.forms import by_layer
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.cli import main
from gfmd_numba.contact import reduction
from gfmd_numba.contact.rough_surfaces import FacingSurfaces
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.layers import Stack
from gfmd_numba.roughness.generators import random_surface
from gfmd_numba.scene import InputError, load_scene
from gfmd_numba.solvers.table import SOLVERS, able
from support.layered_scenes import HARD_ON_SOFT, INCOMPRESSIBLE, SOFT, SOFT_ON_HARD, TOP, scene

pytestmark = pytest.mark.usefixtures("undrawn")


def reduced(body, **changes):
    file = load_scene(scene(body, **changes))[0]
    surface, gradient = random_surface(file.scene.in_periods.roughness, file.discretisation, file.scene.dimension, 0)
    return reduction.reduce(file.scene, FacingSurfaces(surface, gradient), file.numerics)


YAML = """\
body:
  layers:
    - {height: 0.2e-3, youngs_modulus: 400e9, poissons_ratio: 0.2}
    - {height: 1e-3, youngs_modulus: 3e9, poissons_ratio: 0.5}
  base: %s
roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
interface: {hard_wall: {}, friction: {coefficient: 0.3}}
loading: {reduced_pressure: 0.05}
length: 0.01
discretisation: {eps_c: 1/4, eps_f: 1/8, eps_t: 1/2}
"""


@pytest.mark.parametrize(
    "base", [pytest.param("rigid", marks=pytest.mark.long), "{youngs_modulus: 200e9, poissons_ratio: 0.3}"]
)
def test_a_file_with_layers_is_checked_solved_and_looked_into(tmp_path, base):
    (tmp_path / "scene.yaml").write_text(YAML % base)
    contact, inside = tmp_path / "contact.nc", tmp_path / "fields.nc"
    for arguments in (
        ["check", str(tmp_path / "scene.yaml")],
        ["solve", str(tmp_path / "scene.yaml"), "-o", str(contact)],
        ["fields", str(contact), "-o", str(inside)],
    ):
        result = CliRunner().invoke(main, arguments)
        assert result.exit_code == 0, result.output
    assert result.output.count("layer ") == (2 if base == "rigid" else 3)  # each has its largest stress printed
    with xr.open_dataset(contact) as solved, xr.open_dataset(inside) as fields:
        assert solved["status"] == 0
        modulus = 400e9 / (1 - 0.2**2)
        assert solved.attrs["effective_modulus"].endswith("E* is that of the topmost layer")
        assert float(solved.attrs["effective_modulus"].split()[0]) == pytest.approx(modulus)
        assert solved["mean_pressure"] == pytest.approx(0.05 * 0.01 * modulus)
        assert fields["z"].min() == pytest.approx(-1.2e-3 if base == "rigid" else -0.01)
        on_top = fields.isel(z=int(fields["z"].values.argmax()))
        np.testing.assert_allclose(on_top["stress_3"], -solved["pressure"], atol=1e-6 * float(solved["pressure"].max()))
        shift = solved["displacement"] - on_top["displacement_3"]
        if base == "rigid":
            np.testing.assert_allclose(shift, 0.0, atol=1e-7 * float(abs(solved["displacement"]).max()))
        else:
            np.testing.assert_allclose(shift, float(shift.mean()), atol=1e-7 * float(abs(solved["displacement"]).max()))


def test_fields_of_a_python_contact_change_at_the_interface_where_they_may():
    contact = gfmd_numba.solve(scene(HARD_ON_SOFT))
    inside = gfmd_numba.body_fields(contact, [-0.02, -0.0200001])
    above, below = inside.isel(z=0), inside.isel(z=1)
    for name in ("displacement_1", "displacement_3", "stress_3", "stress_5"):
        np.testing.assert_allclose(above[name], below[name], atol=1e-3 * float(abs(above[name]).max()))
    assert float(abs(above["stress_1"]).max()) > 10 * float(abs(below["stress_1"]).max())
    with pytest.raises(InputError, match=r"you gave -0\.13; gfmd allows .* -0\.12 \(the base\) to 0"):
        gfmd_numba.body_fields(contact, [-0.13])


@pytest.mark.long
def test_levels_show_both_sides_of_each_interface():
    """Stresses jump there; each layer is drawn on its own."""
    contact = gfmd_numba.solve(scene(HARD_ON_SOFT | {"base": SOFT_ON_HARD["base"]}))
    inside = gfmd_numba.body_fields(contact)
    layers = by_layer(inside["z"].values)
    bottoms = np.cumsum([layer["height"] for layer in HARD_ON_SOFT["layers"]])
    np.testing.assert_allclose([-inside["z"].values[layer[-1]] for layer in layers[: len(bottoms)]], bottoms)
    of_layers = [inside["von_mises"].isel(z=layer).max("x") for layer in layers]
    assert float(of_layers[0][-1]) > 2.0 * float(of_layers[1][0])
    assert plot_body(inside).axes


@pytest.mark.parametrize("nu", [0.3, 0.5])
def test_equal_layers_are_one_problem_with_the_slab_and_give_the_same_kappa(nu):
    part = {"youngs_modulus": 7.0, "poissons_ratio": nu}
    two = {"layers": [part | {"height": 0.1}, part | {"height": 0.2}], "base": "rigid"}
    slab = part | {"aspect_ratio": 0.3}
    assert reduced(two)[0].identity == reduced(slab)[0].identity
    found, expected = (gfmd_numba.solve(scene(body)) for body in (two, slab))
    assert found["kappa"] == expected["kappa"]
    np.testing.assert_array_equal(found["pressure"], expected["pressure"])


def test_layers_on_their_own_material_are_one_problem_with_the_half_space():
    part = {"youngs_modulus": 7.0, "poissons_ratio": 0.3}
    stack = {"layers": [part | {"height": 0.1}], "base": part}
    assert reduced(stack)[0].identity == reduced(part)[0].identity
    friction = {"interface": {"hard_wall": {}, "friction": {"coefficient": 0.3}}}
    assert reduced(stack, **friction)[0].identity == reduced(part, **friction)[0].identity


def test_heights_are_in_metres_with_a_length_and_only_ratios_of_moduli_matter():
    plain = reduced(HARD_ON_SOFT)[0]
    in_metres = [
        layer | {"height": 0.5 * layer["height"], "youngs_modulus": 4e9 * layer["youngs_modulus"]}
        for layer in HARD_ON_SOFT["layers"]
    ]
    scaled = reduced({"layers": in_metres, "base": "rigid"}, length=0.5)[0]
    assert scaled.body == plain.body
    assert scaled.identity == plain.identity
    assert reduced(HARD_ON_SOFT, length=0.5)[0].identity != plain.identity


def test_layers_in_plane_stress_are_those_of_other_poissons_ratios_in_plane_strain():
    stress = reduced({"layers": [TOP, SOFT], "base": "rigid", "state": "plane_stress"})[0].body
    strain = [
        layer
        | {"poissons_ratio": (nu := layer["poissons_ratio"] / (1 + layer["poissons_ratio"])), "youngs_modulus": 0}
        | {"youngs_modulus": layer["youngs_modulus"] * (1 - nu**2)}
        for layer in (TOP, SOFT)
    ]
    expected = reduced({"layers": strain, "base": "rigid"})[0].body
    q = np.array([0.0, 1.0, 100.0])
    np.testing.assert_allclose(stress.condensed_stiffness(q), expected.condensed_stiffness(q), rtol=1e-13)


def test_what_is_deeper_than_any_wave_feels_is_dropped():
    deep = {"layers": [TOP | {"height": 6.0}], "base": {"youngs_modulus": 1.0, "poissons_ratio": 0.3}}
    found, effects = reduced(deep)
    assert found.body == ElasticBody(None, None)
    assert {effect.name: effect.state for effect in effects}["1 layer on a half-space"] == "dropped"
    shallow, effects = reduced(deep | {"layers": [TOP | {"height": 0.5}]})
    assert shallow.body.stack is not None
    assert {effect.name: effect.state for effect in effects}["1 layer on a half-space"] == "on"
    whole, _ = reduced(deep, numerics={"effects": "exact"}, loading={"reduced_pressure": 0.05})
    assert whole.body == ElasticBody(None, None)  # below double precision


@pytest.mark.parametrize(
    "body", [pytest.param(HARD_ON_SOFT, marks=pytest.mark.long), INCOMPRESSIBLE], ids=["hard", "incompressible"]
)
def test_all_solvers_find_the_same_contact_on_layers(body):
    found = {}
    for solver in SOLVERS:
        contact = gfmd_numba.solve(scene(body, numerics={"solver": solver}))
        assert contact["status"] == 0, solver
        found[solver] = np.flatnonzero(contact["pressure"])
    assert 0 < len(found["verlet"]) < 256
    for solver, touching in found.items():
        np.testing.assert_array_equal(touching, found["verlet"], err_msg=solver)


@pytest.mark.long
def test_all_solvers_find_the_same_contact_at_a_given_displacement():
    found = {}
    for solver in able(["dimension 1", "hard wall"]):
        contact = gfmd_numba.solve(
            scene(HARD_ON_SOFT, loading={"displacement": 2e-3}, numerics={"solver": solver, "residual": 1e-9})
        )
        assert contact["status"] == 0, solver
        found[solver] = np.flatnonzero(contact["pressure"])
    assert 5 < len(found["verlet"]) < 256
    for solver, touching in found.items():
        np.testing.assert_array_equal(touching, found["verlet"], err_msg=solver)


@pytest.mark.long
def test_all_solvers_of_maps_find_the_same_contact_on_layers():
    found = {}
    for solver in able(["dimension 2"]):
        contact = gfmd_numba.solve(scene(SOFT_ON_HARD, dimension=2, numerics={"solver": solver}))
        assert contact["status"] == 0, solver
        found[solver] = contact["pressure"].values > 0
    first, *others = found.values()
    assert 0 < first.sum() < first.size
    for other in others:
        np.testing.assert_array_equal(first, other)


def test_incompressible_layers_on_a_rigid_base_keep_their_volume():
    inside = gfmd_numba.solve(scene(INCOMPRESSIBLE, loading={"displacement": 7.5e-4}))
    assert inside["status"] == 0
    assert abs(float(inside["displacement"].mean())) < 1e-12
    with pytest.raises(InputError, match="an incompressible body has no room for more"):
        gfmd_numba.solve(scene(INCOMPRESSIBLE, loading={"displacement": 0.05}))
    sticking = {"hard_wall": {}, "friction": {"coefficient": float("inf")}}
    stuck = gfmd_numba.solve(scene(INCOMPRESSIBLE, loading={"displacement": 7.5e-4}, interface=sticking))
    assert stuck["status"] == 0
    assert abs(float(stuck["displacement"].mean())) < 1e-12


def test_friction_on_layers_converges_and_keeps_coulombs_law():
    contact = gfmd_numba.solve(
        scene(HARD_ON_SOFT, interface={"hard_wall": {}, "friction": {"coefficient": 0.2}}, path=[{"sliding": 1e-2}])
    )
    assert (contact["status"] == 0).all()
    pressure, traction = contact["pressure"].values, abs(contact["tangential_traction"].values)
    assert (traction <= 0.2 * pressure + 1e-6 * pressure.max()).all()
    assert traction[0].sum() < 0.195 * pressure[0].sum()
    np.testing.assert_allclose(traction[1], 0.2 * pressure[1], atol=1e-6 * pressure.max())  # it slides everywhere


def test_adhesion_on_layers_converges():
    law = {"hard_wall": {}, "exponential": {"work_of_adhesion": 1e-5, "range": 0.02}}
    assert gfmd_numba.solve(scene(SOFT_ON_HARD, interface=law))["status"] == 0


def test_a_loaded_stack_moves_by_the_sum_of_its_layers():
    file = {"body": HARD_ON_SOFT, "boundary": {"normal_traction": -0.1, "tangential_traction": 0.02}, "points": 16}
    loaded = gfmd_numba.solve(file)
    shear = [layer["youngs_modulus"] / 2 / (1 + layer["poissons_ratio"]) for layer in (TOP, SOFT)]
    lateral = [2 * g * (1 - nu) / (1 - 2 * nu) for g, nu in zip(shear, (0.2, 0.45), strict=True)]
    np.testing.assert_allclose(loaded["normal_displacement"], -0.1 * (0.02 / lateral[0] + 0.1 / lateral[1]), rtol=1e-6)
    np.testing.assert_allclose(loaded["tangential_displacement"], 0.02 * (0.02 / shear[0] + 0.1 / shear[1]), rtol=1e-6)
    inside = gfmd_numba.body_fields(loaded, [-0.01, -0.07])
    for i, left in ((0, 0.01 / lateral[0] + 0.1 / lateral[1]), (1, 0.05 / lateral[1])):
        at = inside.isel(z=i)
        np.testing.assert_allclose(at["displacement_3"], -0.1 * left, rtol=1e-6)
        np.testing.assert_allclose(at["strain_3"], -0.1 / lateral[i], rtol=1e-6)
        np.testing.assert_allclose(at["strain_5"], 0.02 / shear[i], rtol=1e-6)
        np.testing.assert_allclose(at["stress_1"], -0.1 * (0.25, 9 / 11)[i], rtol=1e-6)
    assert "topmost" in loaded.attrs["effective_modulus"]
    with pytest.raises(InputError, match="or base rigid or a normal_displacement"):
        gfmd_numba.solve(file | {"body": SOFT_ON_HARD})


@pytest.mark.long
def test_a_campaign_with_layers_runs(tmp_path):
    campaign = {
        "name": "coated",
        "seed": 1,
        "realisations": 3,
        "scene": scene(HARD_ON_SOFT)["scene"],
        "reference": {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1 / 2},
        "limits": {"eps_c": [1 / 2]},
        "grid": {"hurst": [0.3, 0.8]},
    }
    results = gfmd_numba.run(campaign, tmp_path / "coated")
    assert (results["status"] == 0).all()
    assert "topmost" in results.attrs["effective_modulus"]
    assert not {"poissons_ratio", "aspect_ratio"} & set(results.coords)
    one = gfmd_numba.solve(scene(HARD_ON_SOFT) | {"seed": 1})
    same = (results["hurst"] == 0.8) & (results["eps_c"] == 0.25)
    assert float(one["kappa"]) == pytest.approx(float(results["kappa"].values[same.values][0, 0]), rel=1e-6)
    for axis in ("poissons_ratio", "aspect_ratio"):
        with pytest.raises(InputError, match=rf"grid\.{axis}\[0\]: you gave 0\.3; gfmd allows nothing with layers"):
            load_campaign(campaign | {"grid": {axis: [0.3]}})


def test_a_stack_holds_heights_over_the_period():
    assert isinstance(reduced(HARD_ON_SOFT)[0].body.stack, Stack)
    assert reduced(HARD_ON_SOFT)[0].body.aspect_ratio == pytest.approx(0.12)


@pytest.mark.parametrize("pressure", [0.01, 0.2])
def test_newton_needs_no_successor_below_a_stiff_coating(pressure):
    coated = {"layers": [TOP], "base": {"youngs_modulus": 1.0, "poissons_ratio": 0.4}}
    file = scene(coated, loading={"reduced_pressure": pressure})
    file["discretisation"]["eps_f"] = 1 / 64
    contact = gfmd_numba.solve(file)
    assert contact["status"] == 0
    assert contact.attrs["solver"] == "active_set_newton"
    assert contact["n_iterations"] < 20
