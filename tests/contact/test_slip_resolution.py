"""A law of gap and slip whose slip the grid does not resolve is told as one whose gap it does not: by its softening."""

from dataclasses import replace

import numpy as np
import pytest
import yaml

from gfmd_numba.contact.problem import DeformableBody, Problem
from gfmd_numba.contact.relative_softening import COARSEST, REFUSED, softening, warning
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.table import Options
from support.command_line import gfmd, unfolded

LAW = XuNeedlemanLaw(6e-3, 0.0125, 5e-3)


def test_slip_softens_by_the_largest_negative_curvature_of_the_energy():
    """At any gap: of all curvatures by slip, that of closed gaps is the largest."""
    law, h = XuNeedlemanLaw(0.3, 0.2, 0.4), 1e-4
    gap, slip = np.meshgrid(np.linspace(0.0, 1.0, 11), np.linspace(0.0, 2.0, 20001))
    curvature = (law.energy(gap, slip + h) - 2 * law.energy(gap, slip) + law.energy(gap, slip - h)) / h**2
    assert law.slip_softening == pytest.approx(-curvature.min(), rel=1e-5)


def test_both_at_once_soften_little_more_than_either():
    """Of the least curvature in any direction of gap and slip, equally stiff, the larger of the two is 87 % or more."""
    gap, slip = np.meshgrid(np.linspace(0.0, 1.2, 301), np.linspace(0.0, 1.5, 301))
    for ratio in np.geomspace(0.5, 8.0, 25):
        law = XuNeedlemanLaw(0.3, 0.2, 0.2 * ratio)
        tangential, both, normal = law.stiffness(gap, slip[np.newaxis])
        least = (0.5 * (tangential + normal) - np.hypot(0.5 * (tangential - normal), both)).min()
        assert 0.87 < max(law.softening, law.slip_softening) / -least < 1.005


def problem(nodes, law, body=None):
    surface = RandomSurface(SelfAffineWaves(0.8, 2, 32), nodes, 1)
    laws = Interactions(True, cohesive=law)
    return Problem(surface, body or ElasticBody(0.3, None), laws, 0.1, None, Options("truncated_newton"))


@pytest.mark.parametrize("nodes", [256, 257])
@pytest.mark.parametrize("body", [ElasticBody(0.3, None), ElasticBody(0.5, 1e-3), ElasticBody(0.2, 3e-3)])
def test_the_larger_of_gap_and_slip_counts_over_the_stiffness_of_its_own_displacement(body, nodes):
    found = body.response((256,))  # at Nyquist the other displacement is free
    by_slip = 4 * 6e-3 / 5e-3**2 * np.exp(-1.5) / found.elements[0][-1]
    by_gap = 6e-3 / 0.0125**2 * np.exp(-2.0) / found.normal[-1]
    assert softening(problem(nodes, LAW, body)) == pytest.approx(max(by_slip, by_gap))
    assert softening(problem(nodes, XuNeedlemanLaw(6e-3, 0.0125, 1.0), body)) == pytest.approx(by_gap)


@pytest.mark.parametrize("body", [ElasticBody(0.3, None), ElasticBody(0.5, 1e-3)])
def test_the_grid_it_asks_for_resolves_slip(body):
    told = warning(problem(128, LAW, body), None)
    nodes = int(told.rpartition("at least ")[2].split()[0])
    assert "under slip it softens" in told
    assert "or a longer tangential_length" in told
    assert nodes > 128
    assert warning(problem(nodes, LAW, body), None) == ""


@pytest.mark.parametrize("body", [ElasticBody(0.3, None), ElasticBody(0.5, 3e-3), ElasticBody(0.0, 3e-3)])
def test_on_maps_a_wave_that_slips_across_its_direction_counts(body):
    of_map = RandomSurface(SelfAffineWaves(0.8, 2, 16), 64, 1, dimension=2)
    map_ = replace(problem(64, LAW, body), surface=of_map)
    slips_along, _, slips_across, *_ = body.response((64, 64)).elements[:, 0, -1]
    by_slip = LAW.slip_softening / min(slips_along, slips_across)
    assert softening(map_) == pytest.approx(by_slip)
    assert softening(map_) >= softening(problem(64, LAW, body))


@pytest.mark.parametrize("dimension", [1, 2])
def test_between_two_bodies_the_compliances_to_slip_add_up(dimension):
    body, counter = ElasticBody(0.5, 0.02), DeformableBody(ElasticBody(0.0, 3e-3), 0.9)
    surface = RandomSurface(SelfAffineWaves(0.8, 2, 16), 64, 1, dimension=dimension)
    found, facing = (each.response(surface.shape) for each in (body, counter.elastic))
    elements = found.in_series(facing, 0.9).elements
    slips = [np.ravel(element[..., -1])[0] for element in elements]  # at Nyquist along x
    by_slip = LAW.slip_softening / (slips[0] if dimension == 1 else min(slips[0], slips[2]))
    assert softening(replace(problem(64, LAW, body), surface=surface, counter=counter)) == pytest.approx(by_slip)


def test_the_length_that_is_too_short_is_named_as_in_the_scene():
    gap, slip = (problem(128, XuNeedlemanLaw(6e-3, *lengths)) for lengths in ((3e-3, 1.0), (1.0, 5e-3)))
    assert "or a longer normal_length" in warning(gap, None)
    assert "or a longer tangential_length" in warning(slip, None)


def largest_drag(nodes):
    """Largest mean tangential traction of a wave on a slab that is dragged until it lets go, and x."""
    body = ElasticBody(0.3, 1.0).response((nodes,))
    punch, before, most = 0.1 * (1 - np.cos(2 * np.pi * np.arange(nodes) / nodes))[np.newaxis] - 0.02, None, 0.0
    laws, options = Interactions(True, cohesive=LAW), Options("truncated_newton", residual=1e-6)
    for sliding in np.concatenate([np.linspace(0.0, 0.19, 12), np.arange(0.2, 0.26, 2e-3)]):
        start = None if before is None else following(before, punch, sliding)
        before = equilibrate(punch, body, None, options, laws, start, sliding)
        assert before.status[0] == 0
        most = max(most, abs(before.tangential.traction.mean()))
    return most, LAW.slip_softening / body.elements[0][-1]


@pytest.mark.long
def test_the_drag_that_a_wave_bears_is_off_by_what_x_says():
    (exact, _), *others = map(largest_drag, (512, 256, 152))
    found = {x: drag / exact - 1 for drag, x in others}
    np.testing.assert_allclose(list(found), [0.533, 0.897], rtol=3e-3)
    np.testing.assert_allclose(list(found.values()), [0.033, 0.151], atol=6e-3)


def test_a_law_of_too_short_a_slip_is_refused_with_the_shortest_that_may_be(tmp_path):
    law = {"work_of_adhesion": 0.01, "normal_length": 0.02, "tangential_length": 5e-3}
    file = {
        "scene": {
            "body": {"poissons_ratio": 0.3},
            "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1},
            "interface": {"hard_wall": {}, "cohesive": law},
            "loading": {"reduced_pressure": 0.05},
        },
        "discretisation": {"eps_c": 0.5, "eps_f": 0.03125, "eps_t": 1.0},
    }
    nodes = 2 * 2 * 32  # of the discretisation
    path, shortest = tmp_path / "slip.yaml", np.sqrt(4 * 0.01 * np.exp(-1.5) / (np.pi * nodes / 2) / REFUSED)

    def check(length):
        law["tangential_length"] = float(length)
        path.write_text(yaml.safe_dump(file))
        return gfmd("check", path)

    refused = check(5e-3)
    assert refused.exit_code == 2
    told = (
        f"scene.interface.cohesive.tangential_length: you gave 0.005; gfmd allows at least {shortest:.3g} on this grid"
    )
    assert told in unfolded(refused.stderr)
    for factor, warns in ((1.01, True), (1.01 * np.sqrt(REFUSED / COARSEST), False)):
        checked = check(factor * shortest)
        assert checked.exit_code == 0
        assert ("under slip it softens" in unfolded(checked.stderr)) == warns
