"""Load curves against closed forms, cold solutions, and a linear solve with the contact held."""

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba import InputError, load_curve, solve
from gfmd_numba.fourier import grid
from gfmd_numba.simulate import curve
from gfmd_numba.theory import closed_forms
from support.cases import some_of
from support.contacts import scene_file
from support.waves import AMPLITUDE, FULL, GRADIENT, wave

LOADS = np.array([0.002, 0.01, 0.05, 0.1, 0.3, 0.6, 0.9])  # of the load of full contact


@pytest.fixture(scope="module")
def westergaard(tmp_path_factory):
    return load_curve(wave(tmp_path_factory.mktemp("wave")), LOADS * FULL / GRADIENT)


def test_area_and_peak_pressure_of_a_wave_are_westergaards(westergaard):
    width = [2 * closed_forms.westergaard_half_width(p, AMPLITUDE) for p in LOADS * FULL]
    spacing = 1 / 1024
    np.testing.assert_allclose(westergaard["contact_area_fraction"], width, atol=spacing)
    peak = [closed_forms.westergaard_pressure(np.zeros(1), p, AMPLITUDE)[0] for p in LOADS * FULL]
    np.testing.assert_allclose(westergaard["peak_pressure"], peak, rtol=5e-3)
    np.testing.assert_allclose(westergaard["mean_pressure"], LOADS * FULL, rtol=1e-7)
    assert westergaard["n_segments"].values.tolist() == [1] * len(LOADS)


def test_the_stiffness_of_a_wave_is_the_slope_of_its_closed_form(westergaard):
    slope = np.pi / -np.log(LOADS)
    found = westergaard["contact_stiffness"].values
    np.testing.assert_allclose(found, slope, rtol=2e-2)
    assert "no exact tangent" in westergaard["contact_stiffness"].comment


def test_the_energy_of_a_wave_is_the_work_of_its_load(westergaard):
    """The integral of p d(approach), with the approach of the closed form: (p^2 / 4 - p^2 ln(p / full) / 2) / pi."""
    p = LOADS * FULL
    work = p**2 * (0.25 - 0.5 * np.log(LOADS)) / np.pi
    np.testing.assert_allclose(westergaard["elastic_energy"], work, rtol=5e-3)


@pytest.mark.long
def test_the_energy_of_a_rough_contact_rises_by_load_times_approach():
    loads = np.geomspace(0.01, 1.0, 60)
    found = load_curve(scene_file(), loads)
    p, gap, energy = (found[name].values for name in ("mean_pressure", "mean_gap", "elastic_energy"))
    work = np.concatenate([[0.0], np.cumsum(0.5 * (p[1:] + p[:-1]) * -np.diff(gap))])
    np.testing.assert_allclose(energy - energy[0], work, atol=2e-3 * energy[-1])


@pytest.mark.long
def test_the_stiffness_is_that_of_the_contact_held():
    """K = n / sum_ij (A_ff^-1)_ij over the open nodes; differences between the loads themselves are far from that."""
    loads = np.geomspace(1e-3, 0.5, 20)
    scene = scene_file(body={"poissons_ratio": 0.33}) | {"seed": 0}
    scene["discretisation"] = {"eps_c": 0.25, "eps_f": 1 / 32, "eps_t": 0.25}
    found = load_curve(scene, loads)
    path = solve(scene | {"path": [{"reduced_pressure": float(load)} for load in loads]})
    n = path.sizes["x"]
    full = grid.signal(0.5 * grid.wavenumbers(n) * grid.coefficients(np.eye(n)), n)
    opened = (path["gap"] > 0).values[1:]
    exact = [n / np.linalg.solve(full[np.ix_(free, free)], np.ones(free.sum())).sum() for free in opened]
    error = abs(found["contact_stiffness"].values / exact - 1)
    assert np.count_nonzero(error > 1e-3) <= 1  # where a node comes into contact within the short step
    assert error.max() < 0.02
    p, gap = found["mean_pressure"].values, found["mean_gap"].values
    along_the_path = p / -np.gradient(gap, np.log(p))
    assert abs(along_the_path / exact - 1).max() > 0.1


MAP = scene_file() | {"discretisation": {"eps_c": 0.25, "eps_f": 1 / 4, "eps_t": 1 / 2}}
MAP["scene"] |= {"dimension": 2}


@pytest.mark.parametrize(
    "scene",
    [scene_file(body={"poissons_ratio": 0.33}), pytest.param(MAP, marks=pytest.mark.long)],
    ids=["half-space", "map"],
)
def test_a_warm_start_ends_where_a_cold_one_does(scene):
    loads = [0.01, 0.05, 0.8]
    found = load_curve(scene, loads)
    assert (found["status"] == 0).all()
    for i, load in enumerate(loads):
        scene["scene"]["loading"] = {"reduced_pressure": load}
        cold = solve(scene)
        for name in ("contact_area_fraction", "n_segments"):
            assert float(found[name][i]) == float(cold[name])
        for name in ("mean_pressure", "mean_gap", "peak_pressure", "elastic_energy"):
            assert float(found[name][i]) == pytest.approx(float(cold[name]), rel=1e-6)


def test_prescribed_displacements_give_the_curve_of_their_pressures():
    by_displacement = load_curve(scene_file(loading={"displacement": 1.0}), [1e-4, 5e-4, 2e-3])
    by_pressure = load_curve(scene_file(), by_displacement["reduced_pressure"].values)
    for name in ("mean_gap", "contact_area_fraction", "peak_pressure", "elastic_energy"):
        np.testing.assert_allclose(by_displacement[name], by_pressure[name], rtol=1e-5)
    np.testing.assert_allclose(by_displacement["contact_stiffness"], by_pressure["contact_stiffness"], rtol=2e-2)


def test_loads_that_fall_give_the_same_curve_backwards():
    loads = [0.01, 0.1]
    up, down = load_curve(scene_file(), loads), load_curve(scene_file(), loads[::-1])
    for name in ("mean_gap", "contact_area_fraction", "peak_pressure"):
        np.testing.assert_allclose(down[name].values[::-1], up[name].values, rtol=1e-6)
    np.testing.assert_allclose(down["contact_stiffness"].values[::-1], up["contact_stiffness"].values, rtol=5e-2)


@pytest.mark.parametrize("loads", some_of([[0.1, 0.1001, 0.4], [0.4, 0.1001, 0.1], [0.4, 0.3999], [0.2]], 1, 2))
def test_the_path_of_a_curve_never_turns_back_nor_leaves_its_loads(monkeypatch, loads):
    followed = []
    solve_path = curve.solve_path
    monkeypatch.setattr(curve, "solve_path", lambda *given: followed.append(given) or solve_path(*given))
    load_curve(scene_file(), loads)
    ((whole, *_),) = followed
    pressures = np.array([problem.mean_pressure for problem in whole.at_each_load])
    assert set(loads) <= set(pressures)
    assert pressures.max() == max(loads)
    assert (np.diff(pressures) <= 0).all() if loads[0] > loads[-1] else (np.diff(pressures) > 0).all()


@pytest.mark.parametrize(
    "interface", some_of([{"hard_wall": {"hardness": "2 GPa"}}, {"friction": {"coefficient": 0.3}}], 1)
)
def test_no_point_of_a_falling_curve_was_loaded_beyond_its_first_load(interface):
    scene = {"length": "1 mm", "body": {"youngs_modulus": "200 GPa", "poissons_ratio": 0.3, "aspect_ratio": 1.0}}
    scene |= {"roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1}, "loading": {"pressure": "300 MPa"}}
    scene["interface"] = {"hard_wall": {}} | interface
    file = {"scene": scene, "discretisation": {"eps_c": 1 / 8, "eps_f": 1 / 8, "eps_t": 1 / 2}}
    found, alone = load_curve(file, ["300 MPa", "100 MPa"]), solve(file)
    names = {"contact_area_fraction", "plastic_area_fraction", "peak_pressure", "mean_gap", "elastic_energy"}
    for name in names & set(found.variables):
        assert float(found[name][0]) == pytest.approx(float(alone[name]), rel=1e-6)


def test_a_full_contact_is_infinitely_stiff(tmp_path):
    found = load_curve(wave(tmp_path, 64), [0.1, 2.0])
    assert np.isfinite(found["contact_stiffness"][0])
    assert float(found["contact_stiffness"][1]) == np.inf
    assert float(found["n_segments"][1]) == 0


@pytest.mark.long
def test_realisations_give_their_mean_and_its_error():
    loads = [0.02, 0.2]
    found = load_curve(scene_file(), loads, 4)
    each = [load_curve(scene_file() | {"realisation": i}, loads) for i in range(4)]
    assert found["n_realisations"].values.tolist() == [4, 4]
    for name in ("contact_area_fraction", "mean_gap", "contact_stiffness", "peak_pressure", "elastic_energy"):
        values = np.stack([one[name].values for one in each])
        np.testing.assert_allclose(found[name], values.mean(axis=0), rtol=1e-12)
        error = values.std(axis=0, ddof=1) / 2
        np.testing.assert_allclose(found[f"{name}_standard_error"], error, rtol=1e-9)
    assert "mean_pressure_standard_error" not in found  # as it is prescribed


def test_the_curve_does_not_depend_on_units():
    bare = load_curve(scene_file(), [0.01, 0.1])
    si = load_curve(scene_file(1e-4, 70e9), [0.01, 0.1])
    e_star, length = 70e9 / (1 - 0.33**2), 1e-4
    factors = {
        "mean_pressure": (e_star, "Pa"),
        "peak_pressure": (e_star, "Pa"),
        "mean_gap": (length, "m"),
        "contact_stiffness": (e_star / length, "Pa m-1"),
        "elastic_energy": (e_star * length, "J m-2"),
        "reduced_pressure": (1.0, "1"),
    }
    for name, (factor, units) in factors.items():
        np.testing.assert_allclose(si[name], factor * bare[name], rtol=1e-9)
        assert (bare[name].units, si[name].units) == ("1", units)
    np.testing.assert_allclose(si["contact_length"], length * bare["contact_area_fraction"])
    assert si["contact_length"].units == "m"
    assert "contact_length" not in bare


def test_the_area_of_a_map_is_an_area():
    scene = {**MAP, "scene": MAP["scene"] | {"length": 1e-3, "loading": {"reduced_pressure": 0.1}}}
    found = load_curve(scene, [0.1])
    assert found["contact_area"].units == "m2"
    assert float(found["contact_area"][0]) == pytest.approx(1e-6 * float(found["contact_area_fraction"][0]))


@pytest.mark.parametrize(
    ("loads", "realisations", "said"),
    [
        ([0.1, -1.0], 1, r"loads\[1\]: you gave -1.0; gfmd allows a number from 1e-30 to 1e\+30"),
        ([0.1, float("nan")], 1, r"loads\[1\]: you gave nan; gfmd allows a number"),
        ([0.1, "0.2"], 1, r"loads\[1\]: you gave '0.2'; gfmd allows a number"),
        (
            [0.1, 0.1],
            1,
            r"loads\[1\]: you gave 0.1; gfmd allows loads that all rise, or all fall, unlike 0.1 before it",
        ),
        (
            [0.1, 0.3, 0.2],
            1,
            r"loads\[2\]: you gave 0.2; gfmd allows loads that all rise, or all fall, unlike 0.3 before it",
        ),
        ([], 1, r"loads: you gave \[\]; gfmd allows a list of one or more numbers"),
        ("0.1", 1, "loads: you gave '0.1'; gfmd allows a list of one or more numbers"),
        (0.1, 1, "loads: you gave 0.1; gfmd allows a list of one or more numbers"),
        (None, 1, "loads, times, speeds: you gave none; gfmd allows one of them"),
        ([0.1], 0, "realisations: you gave 0; gfmd allows a whole number from 1"),
        ([0.1], 1.5, "realisations: you gave 1.5; gfmd allows a whole number from 1"),
    ],
)
def test_bad_loads_are_located_errors(loads, realisations, said):
    with pytest.raises(InputError, match=said):
        load_curve(scene_file(), loads, realisations)


def test_scenes_that_have_no_load_curve_are_refused(tmp_path):
    with pytest.raises(InputError, match="path: you gave a path of 1 steps; gfmd allows no path"):
        load_curve(scene_file() | {"path": [{"reduced_pressure": 0.1}]}, [0.1])
    with pytest.raises(
        InputError, match="realisations: you gave 2; gfmd allows 1, as no surface of this scene is random"
    ):
        load_curve(wave(tmp_path, 64), [0.1], 2)
    loaded = {"scene": {"body": {"poissons_ratio": 0.3, "aspect_ratio": 1.0}, "boundary": {"normal_traction": 0.01}}}
    with pytest.raises(InputError, match="you gave a loaded body without a punch; gfmd allows a contact"):
        load_curve(loaded | {"points": 16}, [0.1])


def test_a_displacement_without_room_names_its_load():
    body = {"poissons_ratio": 0.5, "aspect_ratio": 0.3}
    with pytest.raises(
        InputError, match=r"loads\[1\]: you gave 0.5; gfmd allows at most .*, as an incompressible body has no room"
    ):
        load_curve(scene_file(body=body, loading={"displacement": 1e-5}), [1e-5, 0.5])


def test_a_load_that_fails_is_marked_and_told_and_has_no_numbers():
    with pytest.warns(
        UserWarning, match="^steps_used_up at prescribed_load 0.05, 0.1: The solver took all the iterations"
    ) as told:
        found = load_curve(scene_file() | {"numerics": {"max_iterations": 1}}, [0.05, 0.1])
    assert told[0].filename == __file__
    assert (found["status"] == 1).all()
    assert found["n_realisations"].values.tolist() == [0, 0]
    assert np.isnan(found["contact_area_fraction"]).all()


@pytest.mark.long
def test_surfaces_that_fail_are_left_out_of_the_mean(monkeypatch):
    """All but the first of three at the first load, all at the second: a mean without an error, and none."""
    solved = curve.solve_curve

    def failing(asked):
        for i, step in enumerate(solved(asked)):
            failed = i in (1, 2, 3, 4, 5)
            yield step.where(not failed).assign(status=step["status"] + failed)

    whole = load_curve(scene_file(), [0.05, 0.1])
    monkeypatch.setattr(curve, "solve_curve", failing)
    with pytest.warns(UserWarning, match="^steps_used_up at prescribed_load 0.05, 0.1: "):
        found = load_curve(scene_file(), [0.05, 0.1], 3)
    assert found["n_realisations"].values.tolist() == [1, 0]
    assert found["status"].values.tolist() == [1, 1]
    assert float(found["mean_gap"][0]) == float(whole["mean_gap"][0])
    assert np.isnan(found["mean_gap"][1])
    assert np.isnan(found["mean_gap_standard_error"]).all()


def test_full_contacts_have_a_mean_stiffness_without_an_error():
    found = load_curve(scene_file(), [10.0, 20.0], 2)
    assert (found["contact_stiffness"] == np.inf).all()
    assert np.isnan(found["contact_stiffness_standard_error"]).all()


def test_every_column_says_what_it_is():
    found = load_curve(scene_file(), [0.05, 0.1], 2)
    for name, variable in found.variables.items():
        assert variable.attrs["long_name"], name
        assert variable.attrs["units"] if name != "status" else variable.attrs["flag_meanings"]


@pytest.mark.long
def test_rough_bodies_and_laws_have_load_curves():
    rough = scene_file(body={"poissons_ratio": 0.33, "roughness": scene_file()["scene"]["roughness"]}, roughness=None)
    assert (load_curve(rough, [0.05, 0.1])["contact_stiffness"] > 0).all()
    sticky = scene_file(interface={"hard_wall": {}, "friction": {"coefficient": 0.3}})
    assert (load_curve(sticky, [0.05, 0.1])["contact_stiffness"] > 0).all()


def test_the_peak_is_the_largest_pressure_of_the_fields():
    contact = gfmd_numba.solve(scene_file())
    assert float(contact["peak_pressure"]) == float(contact["pressure"].max())


def test_no_name_of_a_result_is_that_of_a_method_of_xarray():
    for found in (load_curve(scene_file(), [0.05, 0.1], 2), solve(scene_file())):
        for name in found.variables:
            xr.testing.assert_identical(getattr(found, name), found[name])


def test_what_speaks_against_any_load_is_said_once():
    said = curve._of_all(
        [
            (3e6, "off by 1e-3\nat the edge\nsteep\nat 1 m/s glassy"),
            (2e6, "steep"),
            (1e6, "too coarse by 20 %\noff by 0.2\nsteep"),
        ],
        "Pa",
    )
    assert said.splitlines() == [
        "at 1 MPa to 3 MPa (numbers at 3 MPa): off by 1e-3",
        "at 3 MPa: at the edge",
        "steep",
        "at 1 m/s glassy",
        "at 1 MPa: too coarse by 20 %",
    ]
