"""A work of adhesion that depends on the place: beside homogeneous contacts, in files and in windows."""

import numpy as np
import pytest
from scipy.optimize import brentq

import gfmd_numba
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.patterned import PatternedLaw
from gfmd_numba.interface.power_laws import LennardJonesLaw
from gfmd_numba.scene import InputError
from support.cases import some_of

N = 64
LAW = {"work_of_adhesion": 1e-4, "range": 0.01}


def solve(folder, pattern, shape, path=(), **changes):
    """Two bumps in each direction on a slab too thin for either half to feel the other."""
    axes = np.meshgrid(*(np.arange(n) / n for n in shape), indexing="ij")
    np.save(folder / "bumps.npy", 0.02 * sum(np.cos(4 * np.pi * x) for x in axes))
    law = dict(LAW)
    if pattern is not None:
        np.save(folder / "pattern.npy", pattern)
        law["pattern"] = str(folder / "pattern.npy")
    scene = {
        "dimension": len(shape),
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.02},
        "roughness": {"method": "measured", "file": str(folder / "bumps.npy")},
        "interface": {"hard_wall": {}, "exponential": law | changes.pop("law", {})},
        "loading": {"displacement": 1e-3},
    }
    found = gfmd_numba.solve({"scene": scene | changes, "path": [{"displacement": each} for each in path]})
    assert (found["status"] == 0).all()
    return found


@pytest.mark.filterwarnings("ignore:contacts are 1 node")
@pytest.mark.parametrize("axis", [-1, 0])
@pytest.mark.parametrize("dimension", [1, 2])
def test_each_half_is_as_if_it_were_everywhere(tmp_path, dimension, axis):
    shape = (N,) if dimension == 1 else (32, 32)
    halves = np.moveaxis(np.ones(shape), axis, -1)
    halves[..., halves.shape[-1] // 2 :] = 0.25
    pattern = np.moveaxis(halves, -1, axis)
    both, strong = solve(tmp_path, pattern, shape), solve(tmp_path, None, shape)
    weak = solve(tmp_path, None, shape, law={"work_of_adhesion": 0.25e-4})
    assert float(both["relative_softening"]) == float(strong["relative_softening"])
    most = abs(strong["pressure"].values).max()
    for alone, first in ((strong, 0), (weak, 1)):
        found, expected = (np.moveaxis(each["pressure"].values, axis, -1) for each in (both, alone))
        n = found.shape[-1]
        inner = slice((4 * first + 1) * n // 8, (4 * first + 3) * n // 8)  # a quarter period around the bump
        np.testing.assert_allclose(found[..., inner], expected[..., inner], atol=1e-4 * most)
    differs = abs(strong["pressure"].values - weak["pressure"].values).max()
    assert differs > 0.1 * most


@pytest.mark.filterwarnings("ignore:the contact reaches the edge")
@pytest.mark.parametrize(("shape", "periodic"), some_of([((N,), True), ((16, 16), False)], 0))
def test_a_uniform_pattern_is_another_work_of_adhesion(tmp_path, shape, periodic):
    changes = {"periodic": periodic, "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5}}
    half = solve(tmp_path, np.full(shape, 0.5), shape, (0.0, -1e-3), **changes)
    weaker = solve(tmp_path, None, shape, (0.0, -1e-3), law={"work_of_adhesion": 0.5e-4}, **changes)
    most = abs(weaker["pressure"].values).max()
    np.testing.assert_allclose(half["pressure"].values, weaker["pressure"].values, atol=1e-7 * most)
    np.testing.assert_allclose(half["energy_lost"].values, weaker["energy_lost"].values, atol=1e-7 * most * 1e-2)


def test_a_patterned_law_is_that_of_each_node():
    pattern, law = np.array([[1.0, 0.0, 0.3, 2.0], [0.5, 1.0, 1.0, 0.1], *np.ones((2, 4))]), ExponentialLaw(-0.3, 0.2)
    patterned, gap = PatternedLaw.of(law, pattern, (8, 8)), np.linspace(0.0, 1.0, 16).reshape(4, 4)
    closing = 0.1 * np.cos(gap)
    for name, more in (("energy", ()), ("traction", ()), ("stiffness", ()), ("energy_change", (closing,))):
        expected = pattern * getattr(law, name)(gap, *more)
        np.testing.assert_allclose(getattr(patterned, name)(gap, *more), expected)
        flat = getattr(patterned, name)(gap.ravel(), *(each.ravel() for each in more))
        np.testing.assert_allclose(flat, expected.ravel())
    around = patterned.traction(np.zeros((1, 8, 8)))
    np.testing.assert_allclose(around[0, :4, :4], pattern * law.traction(np.zeros(1)))
    assert not around[0, 4:].any()
    assert patterned.stiffest(np.inf, hard_wall=True) == pytest.approx(2.0 * law.stiffest(np.inf, hard_wall=True))
    with pytest.raises(ValueError, match="gaps of shape"):
        patterned.traction(np.zeros(5))


def test_the_weakest_node_stiffens_most_under_a_pressure_where_repulsion_grows_fast():
    """Each share of the law of Lennard and Jones takes the gap at which that repels with the whole pressure."""
    law, pressure = LennardJonesLaw((-4.0 / 3.0, 1.0 / 3.0), (2.0, 8.0), 1.0, 0.0, 0.5), 200.0
    shares = np.array([[1.0, 0.0], [0.25, 2.0]])
    stiffest = []
    for share in shares[shares > 0.0]:
        gap = brentq(lambda z, share=share: 8.0 / 3.0 * share * (z**-9 - z**-3) - pressure, 0.51, 1.0)
        stiffest.append(8.0 / 3.0 * share * (9.0 * gap**-10 - 3.0 * gap**-4))
    assert stiffest[1] == max(stiffest)
    found = PatternedLaw.of(law, shares, (2, 2)).stiffest(pressure, hard_wall=False)
    assert found == pytest.approx(max(stiffest), rel=1e-9)


@pytest.mark.parametrize(
    ("pattern", "message"),
    [
        (np.ones(5), r"pattern.npy \(5 values\)'?; gfmd allows one value for each of the 64 nodes"),
        (-np.ones(N), "gfmd allows a number of at least 0 for every node, of which some are above 0"),
        (np.zeros(N), "gfmd allows a number of at least 0 for every node, of which some are above 0"),
        (np.append(np.ones(N - 1), np.nan), r"nan at index 63\)'?; gfmd allows finite numbers of at most"),
    ],
)
def test_a_pattern_that_is_no_share_is_refused(tmp_path, pattern, message):
    with pytest.raises(InputError, match=message):
        solve(tmp_path, pattern, (N,))


def test_a_pattern_is_a_file_and_needs_a_wall(tmp_path):
    with pytest.raises(InputError, match=r"pattern: you gave 'ones'; gfmd allows the name of a .npy or .csv file"):
        solve(tmp_path, None, (N,), law={"pattern": "ones"})
    with pytest.raises(InputError, match="gfmd allows an existing file"):
        solve(tmp_path, None, (N,), law={"pattern": "ones.npy"})
    np.save(tmp_path / "ones.npy", np.ones(N))
    law = {"work_of_adhesion": -1e-4, "range": 0.01, "pattern": str(tmp_path / "ones.npy")}
    with pytest.raises(InputError, match=r"pattern.* a hard_wall with it"):
        solve(tmp_path, None, (N,), interface={"exponential": law})


def test_a_pattern_means_its_strongest_node():
    repels = PatternedLaw.of(ExponentialLaw(-0.3, 0.2), np.array([1.0, 0.0, 0.3, 2.0]), (8,))
    own = repels.law
    assert repels.strength == pytest.approx(2.0 * own.strength)
    assert repels.stiffest(0.2, hard_wall=False) == pytest.approx(
        max(share * own.stiffest(0.2 / share, False) for share in (0.3, 2.0))
    )
    attracts = PatternedLaw.of(ExponentialLaw(0.3, 0.2), np.array([0.5, 2.0]), (4,))
    assert attracts.traction(np.zeros(1)) == pytest.approx(2.0 * attracts.law.traction(np.zeros(1)))


def test_patterns_tell_laws_apart():
    one, other = (PatternedLaw.of(ExponentialLaw(0.3, 0.2), each, (8,)) for each in (np.ones(4), np.full(4, 0.5)))
    assert one != other
    assert repr(one) != repr(other)  # the identity of a problem


@pytest.mark.filterwarnings(
    "ignore:contacts are 1 node", "ignore:the grid has too few nodes", "ignore:the contact reaches"
)
def test_a_pattern_on_a_strip_that_ends_along_one_axis_acts_where_it_is(tmp_path):
    np.save(tmp_path / "half.npy", np.full((32, 32), 0.5))
    wave, found = np.cos(4 * np.pi * np.arange(32) / 32), []
    heights = 0.02 * (wave[:, np.newaxis] + wave)
    for law in (LAW | {"pattern": str(tmp_path / "half.npy")}, LAW | {"work_of_adhesion": 5e-5}):
        scene = {
            "dimension": 2,
            "periodic": "x",
            "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5},
            "roughness": {"method": "measured", "heights": heights, "units": {"z": "L_x"}},
            "interface": {"hard_wall": {}, "exponential": law},
            "loading": {"displacement": 1e-3},
        }
        found.append(gfmd_numba.solve({"scene": scene})["pressure"].values)
    np.testing.assert_allclose(*found, atol=1e-7 * abs(found[0]).max())


def test_the_wall_alone_parts_nodes_under_a_pattern_and_in_full_contact(tmp_path):
    """Where every node touches none is about to leave, however unlike the pressures are, or what pulls."""
    np.save(tmp_path / "wave.npy", 1e-3 * np.cos(2 * np.pi * np.arange(64) / 64))
    np.save(tmp_path / "pattern.npy", np.linspace(0.5, 1.5, 64))
    scene = {"body": {"poissons_ratio": 0.3}, "roughness": {"method": "measured", "file": str(tmp_path / "wave.npy")}}
    law = {"work_of_adhesion": 1e-6, "range": 0.01, "pattern": str(tmp_path / "pattern.npy")}
    for interface in ({"hard_wall": {}}, {"hard_wall": {}, "exponential": law}):
        found = gfmd_numba.solve({"scene": scene | {"interface": interface, "loading": {"reduced_pressure": 1.5}}})
        assert found["contact_area_fraction"] == 1.0
        assert found["kappa_residual_error"] < 1e-6


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")  # of a campaign so small
def test_a_campaign_has_a_pattern_on_its_one_grid(tmp_path):
    """As the work of adhesion it multiplies: half the pattern is half the work."""
    path = tmp_path / "half.csv"
    path.write_text("0.5\n" * 64)
    campaign = {
        "name": "patterned",
        "seed": 1,
        "realisations": 2,
        "scene": {
            "body": {"poissons_ratio": 0.3},
            "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1},
            "interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": 1e-4, "range": 0.05}},
            "loading": {"reduced_pressure": 0.05},
        },
        "reference": {"eps_c": 1 / 4, "eps_f": 1 / 4, "eps_t": 1 / 2},
        "grid": {"work_of_adhesion": [1e-4, 2e-4]},
    }
    plain = gfmd_numba.run(campaign, tmp_path / "plain")
    campaign["scene"]["interface"]["exponential"]["pattern"] = str(path)
    found = gfmd_numba.run(campaign, tmp_path / "patterned")
    np.testing.assert_allclose(found["kappa"][1], plain["kappa"][0], rtol=1e-6)
    assert (found["kappa"][0] != plain["kappa"][0]).all()
    with pytest.raises(InputError, match=r"pattern.*one value for each of the (32|128) nodes"):
        gfmd_numba.run(campaign | {"limits": {"eps_c": [1 / 2, 1 / 4, 1 / 8]}}, tmp_path / "limits")
    campaign["scene"]["interface"]["exponential"]["pattern"] = "none.npy"
    with pytest.raises(InputError, match=r"(?s)pattern.*existing file"):
        gfmd_numba.run(campaign, tmp_path / "none")
