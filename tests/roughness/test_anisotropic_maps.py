"""Maps that are correlated farther along y than along x."""

from dataclasses import replace

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba import fit_tfc, run
from gfmd_numba.analysis import secant_stiffness
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.contact import evaluation, solution
from gfmd_numba.contact.problem import Problem
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine, statistics
from gfmd_numba.roughness.generators import RandomSurface, random_surface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.roughness.surfaces import given_surface
from gfmd_numba.scene import Discretisation, InputError, Scene, load_scene
from gfmd_numba.solvers.table import Options
from support.campaigns import MAPS, campaign

WAVES = self_affine.SelfAffineWaves(0.5, 8, 32)


def maps(count, anisotropy, nx=80):
    return replace(WAVES, anisotropy=anisotropy).heights((nx, nx), 3, range(count))


def pressed(surface, load=0.05):
    numerics = Options("active_set_newton")
    return solution.solve(
        Problem(surface, ElasticBody(None, None), Interactions(hard_wall=True), load, None, numerics), range(1)
    )


def slopes(heights):
    """Mean square gradients along y and along x."""
    along_x = statistics.gradient(heights)
    along_y = statistics.gradient(heights.swapaxes(1, 2))
    return (along_y**2).mean(), (along_x**2).mean()


@pytest.mark.parametrize("anisotropy", [1.0, 2.0, 4.0])
def test_gradients_are_those_of_the_stretched_spectrum(anisotropy):
    """The integrals of q_x^2 and q_y^2 over C(q_x, a q_y) are in the ratio a^2, and here add up to 1."""
    along_y, along_x = slopes(maps(20, anisotropy))
    assert along_x + along_y == pytest.approx(1.0, rel=1e-12)
    assert along_x / along_y == pytest.approx(anisotropy**2, rel=0.04)


def test_every_wave_has_the_share_the_spectrum_gives_it():
    round_map, long_map = (maps(1, a)[0] for a in (1.0, 2.5))
    k_y, k_x = np.fft.fftfreq(80, 1 / 80)[:, np.newaxis], np.arange(41)
    within = (np.hypot(2.5 * k_y, k_x) <= 32) & (k_x > 0)
    ratio = (np.fft.rfft2(long_map)[within] / np.fft.rfft2(round_map)[within]) ** 2
    stretched, own = (np.maximum(np.hypot(a * k_y, k_x), 8)[within] ** -3.0 for a in (2.5, 1.0))
    np.testing.assert_allclose(ratio / ratio[0] * (stretched / own)[0], stretched / own, rtol=1e-9)
    beyond = np.hypot(2.5 * k_y, k_x) > 32
    assert abs(np.fft.rfft2(long_map)[beyond]).max() < 1e-12 * abs(np.fft.rfft2(long_map)).max()


def test_refining_the_grid_keeps_the_map():
    coarse, fine = (maps(2, 3.0, nx) for nx in (80, 160))
    np.testing.assert_allclose(fine[:, ::2, ::2], coarse, atol=1e-15)


def test_one_is_the_isotropic_map_and_problem():
    np.testing.assert_array_equal(maps(1, 1.0), WAVES.heights((80, 80), 3, range(1)))
    eps = Discretisation(eps_c=0.5, eps_f=0.25, eps_t=0.25)
    surfaces = {}
    for a in (None, 1.0, 2.0):
        scene = Scene.model_validate(
            {
                "dimension": 2,
                "body": {"poissons_ratio": 0.3},
                "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1, "anisotropy": a},
                "interface": {"hard_wall": {}},
                "loading": {"reduced_pressure": 0.01},
            }
        )
        surfaces[a] = random_surface(scene.in_periods.roughness, eps, scene.dimension, 1)
    assert surfaces[None] == surfaces[1.0] != surfaces[2.0]


def test_ridges_along_y_are_pressed_like_the_profile_across_them():
    waves = SelfAffineWaves(hurst=0.5, longest_wave_index=8, shortest_wave_index=32, anisotropy=1e3)
    ridges = pressed(RandomSurface(waves, nx=80, seed=3, dimension=2))
    assert np.ptp(ridges.heights, axis=1).max() < 1e-15
    across = pressed(given_surface(ridges.heights[0, 0])[0])
    for area in (evaluation.contact_area_fraction_counted, evaluation.contact_area_fraction):
        assert area(ridges)[0] == pytest.approx(area(across)[0], rel=1e-12)


SCENE = """\
dimension: 2
body: {poissons_ratio: 0.33}
roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01, anisotropy: 2}
interface: {hard_wall: {}}
loading: {reduced_pressure: 0.05}
discretisation: {eps_c: 1/2, eps_f: 1/4, eps_t: 1/4}
"""
CAMPAIGN = f"""\
{MAPS}
reference: {{eps_c: 1/2, eps_f: 1/4, eps_t: 1/4}}
limits: {{eps_c: [1, 1/4]}}
grid: {{anisotropy: [1, 4]}}
"""


@pytest.mark.parametrize(
    ("load", "text", "old", "new", "fault"),
    [
        (
            gfmd_numba.solve,
            SCENE,
            "dimension: 2",
            "dimension: 1",
            "roughness.anisotropy: you gave 2; gfmd allows nothing",
        ),
        (load_scene, SCENE, "anisotropy: 2", "anisotropy: 1/2", "anisotropy: you gave 0.5; gfmd allows a finite"),
        (load_scene, SCENE, "anisotropy: 2", "anisotropy: 5", "you gave 5.0; gfmd allows at most 1/eps_t = 4"),
        (
            load_campaign,
            CAMPAIGN,
            "dimension: 2",
            "dimension: 1",
            "grid.anisotropy: you gave [1, 4]; gfmd allows nothing",
        ),
        (
            load_campaign,
            CAMPAIGN,
            "[1, 4]",
            "[1, 8]",
            "grid.anisotropy[1]: you gave 8.0; gfmd allows at most 1/eps_t = 4",
        ),
        (
            load_campaign,
            CAMPAIGN,
            "eps_c: [",
            "eps_t: [1/2, ",
            "anisotropy[1]: you gave 4.0; gfmd allows at most 1/eps_t = 2",
        ),
    ],
)
def test_anisotropies_that_make_no_sense_are_refused_where_they_stand(tmp_path, load, text, old, new, fault):
    path = tmp_path / "file.yaml"
    assert old in text
    path.write_text(text)
    load(path)
    path.write_text(text.replace(old, new))
    with pytest.raises(InputError) as refused:
        load(path)
    assert fault in str(refused.value)


@pytest.mark.long
def test_a_campaign_over_anisotropies_names_them(tmp_path):
    dataset = run(campaign(tmp_path, CAMPAIGN), output=tmp_path / "out", workers=0)
    assert dataset["anisotropy"].values.tolist() == [1.0] * 3 + [4.0] * 3
    fitted = fit_tfc(dataset, fixed={"eps_c": 1.0})
    assert fitted["anisotropy"].values.tolist() == [1.0, 4.0]
    assert fitted["kappa_tfc"].notnull().all()
    along_y, along_x = slopes(self_affine.SelfAffineWaves(0.8, 4, 16, 4.0).heights((64, 64), 1, range(1)))
    assert along_x > 4.0 * along_y


@pytest.mark.long
def test_isotropic_results_have_no_such_coordinate_and_are_fitted_and_paired(tmp_path):
    path = campaign(tmp_path, CAMPAIGN, **{"anisotropy: [1, 4]": "reduced_pressure: [0.02, 0.05]"})
    dataset = run(path, output=tmp_path / "out", workers=0)
    assert "anisotropy" not in dataset.coords
    assert (fit_tfc(dataset, fixed={"eps_c": 1.0})["kappa_tfc"] > 0).all()
    assert (secant_stiffness(dataset)["stiffness"] > 0).all()
