"""A hardness in scenes and campaigns: its unit, its errors, its observables, and its absence."""

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

import gfmd_numba
from gfmd_numba.campaign.axes import AXES
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.work_precision import study_of
from gfmd_numba.cli import main
from gfmd_numba.contact import evaluation
from gfmd_numba.contact.area_correction import HALF_SPACE
from gfmd_numba.contact.observables import OBSERVABLES
from gfmd_numba.contact.reduction import reduce
from gfmd_numba.contact.rough_surfaces import FacingSurfaces
from gfmd_numba.contact.state import Contact
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.scene import InputError, Numerics, Scene
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options

EPS = {"eps_c": 1 / 8, "eps_f": 1 / 16, "eps_t": 1 / 4}


def scene(hardness=None, load=0.1, dimension=1, **others):
    wall = {} if hardness is None else {"hardness": hardness}
    return {
        "body": {"poissons_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1},
        "interface": {"hard_wall": wall},
        "loading": {"reduced_pressure": load},
        "dimension": dimension,
    } | others


def solve(*args, numerics=None, eps=None, **others):
    eps = eps or EPS | ({} if others.get("dimension", 1) == 1 else {"eps_f": 1 / 4})
    return gfmd_numba.solve({"scene": scene(*args, **others), "numerics": numerics or {}, "discretisation": eps})


def problem(**wall):
    asked = Scene.model_validate(scene() | {"interface": {"hard_wall": wall}})
    return reduce(asked, FacingSurfaces(RandomSurface(SelfAffineWaves(0.8, 2, 32), 128, 0), 0.1), Numerics())[0]


def test_no_hardness_is_no_part_of_a_problem():
    assert problem().identity == problem(hardness=None).identity
    assert problem().identity != problem(hardness=0.1).identity
    assert problem(hardness=0.2).identity != problem(hardness=0.1).identity
    assert "plastic_area_fraction" not in solve()
    assert OBSERVABLES["plastic_area_fraction"].needs == "hardness"


def test_a_hardness_counts_in_pascals_or_in_units_of_the_contact_modulus():
    young, nu = 200e9, 0.3
    modulus = young / (1 - nu**2)
    plain = solve(0.03, 0.2)
    stated = solve(0.03 * modulus, 0.2, body={"poissons_ratio": nu, "youngs_modulus": young}, length=1e-3)
    assert stated["pressure"].units == "Pa"
    assert float(stated["pressure"].max()) == pytest.approx(0.03 * modulus, rel=1e-14)
    assert float(plain["pressure"].max()) == pytest.approx(0.03, rel=1e-14)
    for name in ("kappa", "plastic_area_fraction", "contact_area_fraction"):
        assert float(stated[name]) == pytest.approx(float(plain[name]), rel=1e-9), name
    assert 0.0 < float(plain["plastic_area_fraction"]) < float(plain["contact_area_fraction_counted"])


@pytest.mark.parametrize("dimension", [1, 2])
def test_the_area_of_a_plastic_contact_is_the_load_over_the_hardness(dimension):
    found = solve(1e-6, 4e-6, dimension=dimension)
    nodes, share = found["pressure"].size, 4e-6 * 0.1 / 1e-6
    for name in ("contact_area_fraction_counted", "plastic_area_fraction"):
        assert float(found[name]) == pytest.approx(share, abs=2.5 / nodes), name
    # a last elastic node without open neighbours may be left to carry the rest of the load
    assert float(found["contact_area_fraction"]) == pytest.approx(share, abs=1.0 / nodes)
    assert float(found["kappa"]) == pytest.approx(float(found["rms_gradient"]) / 1e-6, rel=2.5 / nodes / share)
    if dimension == 1:
        assert float(found["kappa_edges"]) == pytest.approx(float(found["kappa"]), rel=2.5 / nodes / share)


@pytest.mark.parametrize("dimension", [1, 2])
def test_edges_of_plastic_nodes_are_not_corrected(dimension):
    """A node between plastic and open ones counts for p / p_H, the other elastic ones at an edge less than one."""
    found = solve(0.05, 0.1, dimension=dimension)
    pressure, now = found["pressure"].values, found["pressure"].values > 0.0
    plastic = pressure > 0.05 * (1 - 1e-12)
    moves = [(side, axis) for axis in range(dimension) for side in (1, -1)]
    fringe = now & ~plastic & np.any([np.roll(plastic, *move) for move in moves], axis=0)
    fringe &= np.any([np.roll(~now, *move) for move in moves], axis=0)
    elastic = now & ~plastic & ~fringe
    sides = [sum(int((elastic & ~np.roll(now, *move)).sum()) for move in moves if move[1] == i) for i in (0, 1)]
    assert fringe.any()
    assert plastic.any()
    assert sum(sides) > 0
    bias = (
        HALF_SPACE.excess
        if dimension == 1
        else HALF_SPACE.perimeter_bias(np.array([sides[1]]), np.array([sides[0]]))[0]
    )
    counted = (now & ~fringe).sum() + pressure[fringe].sum() / 0.05
    expected = (counted - bias * sum(sides)) / now.size
    assert float(found["contact_area_fraction"]) == pytest.approx(expected, rel=1e-12)
    assert float(found["plastic_area_fraction"]) == pytest.approx(plastic.sum() / now.size)


def flattened(nx, dimension, load, hardness, shifts):
    """Area of sinusoidal contacts from many places of their nodes, and its error against counted nodes."""
    along = (np.arange(nx) + np.array(shifts)[:, np.newaxis]) / nx
    wave = (1.0 - np.cos(2.0 * np.pi * along)) / np.pi
    punch = wave if dimension == 1 else 0.5 * (wave[:, np.newaxis, :] + wave[:, :, np.newaxis])
    wall = Interactions(hard_wall=True, hardness=hardness)
    body = stiffness.half_space(grid.magnitudes(punch.shape[1:]))
    pressed = Contact(
        -punch, punch, equilibrate(punch, SpectralResponse.of_normal(body), load, Options("active_set_newton"), wall)
    )
    assert (pressed.equilibrium.status == Status.ok).all()
    return pressed


@pytest.mark.long
@pytest.mark.parametrize(("dimension", "shares"), [(1, (0.1, 0.3, 0.5, 0.85)), (2, (0.2, 0.4, 1.0))])
def test_the_area_of_a_flattened_sinusoid_does_not_depend_on_the_grid(dimension, shares):
    """Fringes far below, near and above a node: at most half of the error of counted nodes is left."""
    load = 0.02
    shifts = (np.arange(16) + 0.5) / 16
    fine, coarse = ((2**14, 128), (512, 64))[dimension - 1]
    for share in shares:
        hardness = share * 2.0 * np.sqrt(load) if dimension == 1 else 0.5 * share
        exact = evaluation.contact_area_fraction(flattened(fine, dimension, load, hardness, [0.3])).mean()
        made = flattened(coarse, dimension, load, hardness, shifts)
        counted = evaluation.contact_area_fraction_counted(made).mean() - exact
        corrected = evaluation.contact_area_fraction(made).mean() - exact
        assert counted > 0.0
        assert abs(corrected) < 0.5 * counted, share


def test_the_gap_of_plastic_nodes_is_zero():
    found = solve(0.05, 0.1)
    touching = found["pressure"].values > 0.0
    assert (found["gap"].values[touching] == 0.0).all()
    assert (found["gap"].values >= 0.0).all()
    assert float(found["mean_gap"]) == pytest.approx(float(found["gap"].mean()))
    elastic = solve(None, 0.1)
    assert float(found["mean_gap"]) < float(elastic["mean_gap"])
    assert float(found["contact_area_fraction"]) > float(elastic["contact_area_fraction"])


def test_a_hardness_out_of_reach_changes_nothing_in_the_dataset():
    elastic, hard = solve(None, 0.1), solve(1e3, 0.1)
    assert float(hard["plastic_area_fraction"]) == 0.0
    for name in set(elastic) - {"wall_time"}:
        np.testing.assert_array_equal(elastic[name].values, hard[name].values, name)


def written(tmp_path, text):
    file = tmp_path / "scene.yaml"
    file.write_text(text)
    return CliRunner().invoke(main, ["check", str(file)])


SCENE = """\
scene:
  body: {poissons_ratio: 0.3}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.1}
  interface: {hard_wall: {hardness: 0.05}}
  loading: {reduced_pressure: PRESSURE}
discretisation: {eps_c: 0.125, eps_f: 0.0625, eps_t: 0.25}
"""
CAMPAIGN = """\
name: hard
seed: 1
realisations: 1
scene:
  body: {youngs_modulus: 200e9, poissons_ratio: 0.3}
  roughness: {method: psd, hurst: 0.8, ROUGHNESS}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.01}
  length: 1e-3
reference: {eps_c: 0.25, eps_f: 0.25, eps_t: 0.25}
grid:
  hardness: [8e9, 2e9]
  reduced_pressure: [0.01, PRESSURE]
"""


def test_a_mean_pressure_that_reaches_the_hardness_is_an_error_with_its_place(tmp_path):
    for pressure, told in (("0.49999", False), ("0.5", True), ("0.6", True)):
        said = written(tmp_path, SCENE.replace("PRESSURE", pressure))
        assert said.exit_code == (2 if told else 0), said.output
        if told:
            assert "scene.yaml:5:31: scene.loading.reduced_pressure: you gave 0" in said.output
            assert "gfmd allows below 0.5" in said.output


def test_a_campaign_s_pressures_are_held_against_its_least_hardness(tmp_path):
    most = 2e9 / (0.1 * 200e9 / (1 - 0.3**2))
    text = CAMPAIGN.replace("ROUGHNESS", "rms_gradient: 0.1")
    assert written(tmp_path, text.replace("PRESSURE", f"{0.999 * most}")).exit_code == 0
    said = written(tmp_path, text.replace("PRESSURE", f"{1.001 * most}"))
    assert said.exit_code == 2
    assert ": grid.reduced_pressure[1]: you gave" in said.output
    by_height = text.replace("rms_gradient: 0.1", "rms_height: 1e-5").replace("PRESSURE", "0.9")
    (tmp_path / "scene.yaml").write_text(by_height)
    with pytest.raises(InputError, match=r"grid\.reduced_pressure\[1\]: you gave 0\.9; gfmd allows below"):
        gfmd_numba.run(tmp_path / "scene.yaml", tmp_path / "out")


@pytest.mark.parametrize(
    ("others", "place"),
    [
        ({"numerics": {"solver": "verlet"}}, "numerics.solver"),
        ({"numerics": {"solver": "fire"}}, "numerics.solver"),
        ({"friction": {"coefficient": 0.3}}, "scene.interface.friction"),
        (
            {"cohesive": {"work_of_adhesion": 1e-5, "normal_length": 0.02, "tangential_length": 0.02}},
            "scene.interface.cohesive",
        ),
    ],
)
def test_what_cannot_have_a_hardness_is_refused(others, place):
    asked = {"scene": scene(0.05, 0.1), "discretisation": EPS}
    asked |= {name: others[name] for name in ("numerics", "path") if name in others}
    asked["scene"]["interface"] |= {name: others[name] for name in ("friction", "cohesive") if name in others}
    with pytest.raises(InputError, match=rf"(^|\n){place}: you gave .*; gfmd allows "):
        gfmd_numba.solve(asked)


def test_auto_is_a_solver_that_can():
    assert solve(0.05).attrs["solver"] == "active_set_newton"
    found = solve(0.05, numerics={"solver": "conjugate_gradients"})
    assert float(found["contact_area_fraction"]) == pytest.approx(float(solve(0.05)["contact_area_fraction"]))


@pytest.mark.long
def test_a_campaign_varies_the_hardness(tmp_path):
    text = CAMPAIGN.replace("ROUGHNESS", "rms_gradient: 0.1").replace("PRESSURE", "0.05")
    (tmp_path / "campaign.yaml").write_text(text)
    found = gfmd_numba.run(tmp_path / "campaign.yaml", tmp_path / "out")
    assert (found["status"] == 0).all()
    assert found["hardness"].attrs["units"] == "Pa"
    soft, hard = (found.isel(case=found["hardness"].values == value) for value in (2e9, 8e9))
    assert (soft["plastic_area_fraction"].values > hard["plastic_area_fraction"].values).all()
    with xr.open_dataset(next((tmp_path / "out").glob("*.nc"))) as kept:
        assert kept["plastic_area_fraction"].attrs["long_name"] == "nodes at the hardness over all nodes"


IN_PASCALS = """
scene:
  length: 1 mm
  body: {youngs_modulus: 200 GPa, poissons_ratio: 0.3}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.1}
  interface: {hard_wall: {hardness: 6 GPa}}
  loading: {pressure: 100 MPa}
path: [{pressure: 300 MPa}]
discretisation: {eps_t: 1/2, eps_f: 1/8, eps_c: 1/4}
"""


@pytest.mark.parametrize("roughness", ["rms_gradient: 0.1", "rms_height: 2 um"])
def test_a_pressure_in_pascals_needs_no_gradient_to_be_held_against_the_hardness(tmp_path, roughness):
    text = IN_PASCALS.replace("rms_gradient: 0.1", roughness)
    assert written(tmp_path, text).exit_code == 0
    for given, place in (("100 MPa", "scene.loading.pressure"), ("300 MPa", "path[0].pressure")):
        said = written(tmp_path, text.replace(given, "6 GPa"))
        assert said.exit_code == 2
        assert f"{place}: you gave '6 GPa'; gfmd allows below 6 GPa, at which the mean pressure is the" in said.output


def test_the_axis_stands_in_the_scene():
    axis = next(axis for axis in AXES if axis.name == "hardness")
    asked = Scene.model_validate(scene(0.05))
    assert axis.value(asked, None) == 0.05
    assert axis.value(Scene.model_validate(scene()), None) is None


@pytest.mark.long
def test_a_study_of_solvers_runs_those_that_can():
    whole = scene() | {"interface": {"hard_wall": {"hardness": 0.1}}}
    campaign = {"name": "hard", "seed": 1, "realisations": 1, "scene": whole, "reference": EPS}
    names = {point.curve for point in study_of(plan(campaign), 1).solvers()}
    assert names == {"active set newton", "conjugate gradients", "truncated newton"}
