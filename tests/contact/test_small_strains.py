"""Where strains are no longer small in part of a contact, the result says so with the share and the largest values."""

import numpy as np
import pytest

import gfmd_numba

N = 256
MODULUS = 3e9 / (1.0 - 0.3**2)
SCENE = {
    "length": "100 um",
    "body": {"youngs_modulus": "3 GPa", "poissons_ratio": 0.3},
    "roughness": {"units": {"z": "um"}},
    "interface": {"hard_wall": {}},
}


def wave(slope, number=1):
    """Heights in um of a wave of a largest slope."""
    return 100.0 * slope / (2.0 * np.pi * number) * np.cos(2.0 * np.pi * number * np.arange(N) / N)


def solve(heights, pressure):
    """Solve at a mean pressure in E*."""
    return gfmd_numba.solve({"scene": SCENE | {"loading": {"pressure": f"{pressure * MODULUS} Pa"}}}, heights)


def shares(found):
    """Share of the contact beyond 0.2 E* or a slope of 0.3, largest pressure in E* and largest slope, node by node."""
    touching = found["gap"].values == 0.0
    pressure = found["pressure"].values / MODULUS
    slopes = abs(np.roll(found["height"], -1) - np.roll(found["height"], 1)) / (2.0 * 1e-4 / N)
    beyond = (pressure > 0.2) | (slopes > 0.3)
    return (beyond & touching).sum() / touching.sum(), pressure.max(), slopes[touching].max()


@pytest.mark.filterwarnings("ignore:waves longer than")
@pytest.mark.parametrize(
    ("heights", "pressure"),
    [
        (wave(0.4), 0.19),  # steep sides touch
        (wave(0.25) + wave(0.25, 16), 0.05),  # narrow peaks
        (wave(0.01), 0.5),  # flat, but half the modulus
    ],
)
def test_the_share_of_the_contact_beyond_small_strains_is_told(heights, pressure):
    with pytest.warns(UserWarning, match="strains are no longer small") as told:
        found = solve(heights, pressure)
    share, peak, slope = shares(found)
    assert share > 0.01
    assert {str(each.message) for each in told} == set(found.validity.splitlines())
    assert f"small on {100.0 * share:.3g} % of the contact" in found.validity
    assert f"the largest are {peak:.3g} E* and {slope:.2g})" in found.validity


@pytest.mark.parametrize(("slope", "pressure"), [(0.2, 0.05), (0.02, 0.15), (0.4, 0.001)])
def test_contacts_of_small_strains_are_solved_without_a_word(slope, pressure):
    found = solve(wave(slope), pressure)
    assert shares(found)[0] == 0.0
    assert found.validity == ""


def test_a_path_and_a_curve_tell_their_worst_step():
    scene = {"scene": SCENE | {"loading": {"pressure": "10 MPa"}}}
    with pytest.warns(UserWarning, match="largest are 0.6"):
        gfmd_numba.solve(scene | {"path": [{"pressure": f"{0.6 * MODULUS} Pa"}, {"pressure": "10 MPa"}]}, wave(0.01))
    with pytest.warns(UserWarning, match="largest are 0.6"):
        gfmd_numba.load_curve(scene, [f"{0.6 * MODULUS} Pa", "10 MPa"], heights=wave(0.01))


def test_scenes_without_any_scale_are_solved_without_a_word():
    body = {"poissons_ratio": 0.3}
    scene = {"body": body, "interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.6}}
    found = gfmd_numba.solve({"scene": scene}, wave(0.4) / 100.0)
    assert (found["pressure"] > 0.2).any()
    assert found.validity == ""


def test_fast_pressures_count_in_the_modulus_that_bears_them():
    body = SCENE["body"] | {"relaxation": [{"modulus": "30 GPa", "time": "1 s"}]}
    loading = {"pressure": f"{0.5 * MODULUS} Pa", "duration": "1 ms"}
    found = gfmd_numba.solve({"scene": SCENE | {"body": body, "loading": loading}}, wave(0.1))
    assert found["pressure"].max() > 0.2 * MODULUS
    assert "strains" not in found.validity
