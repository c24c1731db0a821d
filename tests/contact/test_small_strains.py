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
        (np.roll(wave(0.4), N // 4), 0.19),  # also on both sides of where the period closes
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
    with pytest.warns(UserWarning, match=r"largest are 0.6.*\(in step 1 of 2\)$"):
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


def creeping(path=None, slope=0.1, pressure=0.5, **loading):
    """Solve a wave on a body that is at first eleven times as stiff, with a relaxation time of 1 s."""
    body = SCENE["body"] | {"relaxation": [{"modulus": "30 GPa", "time": "1 s"}]}
    scene = SCENE | {"body": body, "loading": {"pressure": f"{pressure * MODULUS} Pa"} | loading}
    in_time = {"path": path, "numerics": {"time_tolerance": 0.01}} if path else {}
    return gfmd_numba.solve({"scene": scene} | in_time, wave(slope))


def test_a_body_that_has_crept_strains_as_its_relaxed_modulus_lets_it():
    with pytest.warns(UserWarning, match=r"strains are no longer small on .* where the relaxed_pressure exceeds 0.2 E"):
        found = creeping([{"duration": 500.0}])
    for step, stiffer in enumerate((11.0, 1.0)):
        pressed = found["pressure"].values[step] > 0.0
        ratio = found["pressure"].values[step][pressed] / found["relaxed_pressure"].values[step][pressed]
        np.testing.assert_allclose(ratio, stiffer, rtol=1e-2)  # the time_tolerance
    amplitude = np.ptp(found["relaxed_pressure"].values[1]) / 2.0  # in full contact half the slope
    assert amplitude == pytest.approx(0.05 * MODULUS, rel=1e-3)


def test_a_sliding_punch_strains_a_relaxed_body_when_it_is_slow():
    with pytest.warns(UserWarning, match="where the relaxed_pressure exceeds 0.2 E"):
        creeping(None, 0.25, 0.1, speed="1 um/s")
    found = creeping(None, 0.25, 0.1, speed="1 mm/s")
    assert found["pressure"].max() > 0.5 * MODULUS
    assert found.validity == ""


@pytest.mark.parametrize(
    ("path", "loading", "said"),
    [
        ([{"duration": 1000.0}], {}, ""),
        (
            [{"duration": 600.0}, {"duration": 600.0}],
            {},
            "after some 11 s this body is fully relaxed, and the load acts for",
        ),
        ([{"duration": 600.0}, {"pressure": "1 GPa"}, {"duration": 600.0}], {}, ""),
        (
            [{"duration": 1e-3}, {"duration": 1.0}],
            {},
            "before some 1 s this body is glassy, and the load acts for 0.001",
        ),
        (None, {"speed": "1 mm/s"}, ""),
        (
            None,
            {"speed": "3 mm/s"},
            "at 3 mm/s waves of 100 µm act at 30 Hz, and this body is glassy far above 0.159 Hz",
        ),
        (
            None,
            {"speed": "10 nm/s"},
            "at 10 nm/s waves of 100 µm act at 0.0001 Hz, and this body is relaxed far below 0.014",
        ),
        (
            [{"sliding": "30 um", "duration": 0.01}],
            {},
            "at 3 mm/s waves of 100 µm act at 30 Hz, and this body is glassy",
        ),
    ],
)
@pytest.mark.filterwarnings("ignore")
def test_times_and_rates_far_outside_the_relaxation_times_are_told(path, loading, said):
    others = [line for line in creeping(path, **loading).validity.splitlines() if "strains" not in line]
    assert len(others) == bool(said), others
    assert said in "".join(others)


@pytest.mark.long
def test_a_creep_curve_tells_its_strains_with_the_time_of_the_numbers():
    body = SCENE["body"] | {"relaxation": [{"modulus": "30 GPa", "time": "1 s"}]}
    scene = SCENE | {"body": body, "loading": {"pressure": f"{0.1 * MODULUS} Pa"}}
    file = {"scene": scene, "numerics": {"time_tolerance": 0.1}}
    with pytest.warns(UserWarning, match=r"at 20 s to 60 s \(numbers at 60 s\): strains are no longer small on"):
        gfmd_numba.load_curve(file, times=["0.1 s", "20 s", "60 s"], heights=wave(0.25))
