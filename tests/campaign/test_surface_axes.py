"""Lengths and exponents of surfaces are varied by campaigns, checked together, and tell groups apart."""

import numpy as np
import pytest
import xarray as xr
import yaml
from click.testing import CliRunner
from pydantic import TypeAdapter

import gfmd_numba
from gfmd_numba.analysis import fit_tfc, plot_campaign
from gfmd_numba.campaign.axes import OF_THE_SCENE, with_values
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.campaign.plan import plan
from gfmd_numba.cli import main
from gfmd_numba.scene import InputError, Scene

MODEL = {"method": "psd", "model": "k_correlation", "hurst": 0.8, "correlation_length": 0.1, "rms_height": 1e-3}
MOUNDS = MODEL | {"mound_separation": 0.3}
POWER_LAW = {"method": "psd", "hurst": 0.8, "roll_off": 0.5, "cut_on": 0.125, "rms_gradient": 0.02}
ANISOTROPIC = {"correlation_length_x": 0.05, "correlation_length_y": 0.1, "rms_height": 1e-3, "method": "psd"}
LENGTHS = ANISOTROPIC | {"model": "length_anisotropy", "hurst": 0.8}
EXPONENTS = ANISOTROPIC | {"model": "scaling_anisotropy", "hurst_x": 0.5, "hurst_y": 0.8}
VARIED = {
    "rms_height": (MODEL, [1e-3, 2e-3]),
    "correlation_length": (MODEL, [0.05, 0.2]),
    "mound_separation": (MOUNDS, [0.2, 0.4]),
    "cut_on": (MODEL | {"cut_on": 0.1}, [0.125, 0.25]),
    "roll_off": (POWER_LAW, [0.25, 0.5]),
    "correlation_length_x": (LENGTHS, [0.05, 0.2]),
    "correlation_length_y": (LENGTHS, [0.05, 0.2]),
    "hurst_x": (EXPONENTS, [0.3, 0.8]),
    "hurst_y": (EXPONENTS, [0.3, 0.8]),
}
EPS = {"eps_c", "eps_f", "eps_t"}


def campaign(roughness, grid=None, realisations=3, **scene):
    parts = {
        "dimension": 2 if roughness.get("model", "").endswith("anisotropy") else 1,
        "body": {"poissons_ratio": 0.3},
        "roughness": {"points": 32} | roughness,
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.05},
    }
    return {"name": "c", "seed": 7, "realisations": realisations, "scene": parts | scene, "grid": grid or {}}


def axis_named(name):
    (found,) = (axis for axis in OF_THE_SCENE if axis.name == name)
    return found


@pytest.mark.parametrize("name", VARIED)
def test_a_value_stands_in_its_place_of_the_record_alone(name):
    roughness, values = VARIED[name]
    scene, axis = Scene.model_validate(campaign(roughness)["scene"]), axis_named(name)
    assert TypeAdapter(axis.type).validate_python(values[1]) == values[1]
    found = with_values(scene, {axis.place: values[1]})
    assert axis.value(found, None) == values[1]
    assert found.roughness.model_dump() == scene.roughness.model_dump() | {name: values[1]}


@pytest.mark.long
@pytest.mark.parametrize("name", ["correlation_length_y", "cut_on", "hurst_x"])
def test_a_grid_over_it_is_run_fitted_and_drawn(tmp_path, name):
    roughness, values = VARIED[name]
    (tmp_path / "c.yaml").write_text(yaml.safe_dump(campaign(roughness, {name: values}, length=None)))
    results = gfmd_numba.run(tmp_path / "c.yaml", tmp_path / "out", workers=0)
    assert (results["status"] == 0).all()
    column = results[axis_named(name).coordinate]
    assert column.values.tolist() == values
    assert column.attrs["axis"] == "physics"
    fitted = fit_tfc(results)
    assert fitted.sizes["group"] == 2
    assert fitted[column.name].values.tolist() == values
    np.testing.assert_allclose(fitted["reference"], results["kappa"].mean("realisation"))
    (panel,) = plot_campaign(results).axes
    assert panel.get_xlabel() == axis_named(name).label
    (line,) = (container.lines[0] for container in panel.containers)
    np.testing.assert_allclose(np.sort(line.get_xdata()), values)


@pytest.mark.parametrize("name", [name for name in VARIED if name != "rms_height"])
def test_what_is_varied_changes_the_contact_as_in_a_scene_of_its_own(name):
    roughness, values = VARIED[name]
    planned = plan(campaign(roughness, {name: values}))
    alone = [plan(campaign(roughness | {name: value})).problems[0].identity for value in values]
    assert [case.problem.identity for case in planned.cases] == alone
    assert len(set(alone)) == 2


def test_an_rms_height_alone_changes_no_dimensionless_problem():
    planned = plan(campaign(MODEL, {"rms_height": [1e-3, 2e-3]}))
    assert [case.rms_gradient for case in planned.cases][1] == pytest.approx(2 * planned.cases[0].rms_gradient)
    assert len(planned.problems) == 1


def test_lengths_are_in_metres_where_the_period_is(tmp_path):
    file = campaign(MODEL | {"correlation_length": 1e-5, "rms_height": 1e-7}, length=1e-4)
    results = gfmd_numba.run(file | {"grid": {"correlation_length": [5e-6, 1e-5]}}, tmp_path / "out", workers=0)
    assert results["correlation_length"].units == results["rms_height"].units == "m"
    assert plot_campaign(results).axes[0].get_xlabel() == r"$\xi$ (µm)"


@pytest.mark.parametrize(
    ("roughness", "grid", "said"),
    [
        (
            POWER_LAW,
            {"cut_on": [0.125, 0.5]},
            "grid.cut_on[1]: you gave 0.5; gfmd allows a wavelength below roll_off = 0.5",
        ),
        (
            POWER_LAW,
            {"roll_off": [0.5, 0.1]},
            "grid.roll_off[1]: you gave 0.1; gfmd allows a value for which cut_on is a wavelength below roll_off = 0.1",
        ),
        (POWER_LAW, {"cut_on": [0.01]}, "grid.cut_on[0]: you gave 0.01; gfmd allows at least 0.0666"),
        (POWER_LAW, {"roll_off": [0.5, 3]}, "grid.roll_off[1]: you gave 3; gfmd allows at most the period 1"),
        (
            POWER_LAW,
            {"cut_on": [0.1, 0.2], "roll_off": [0.5, 0.15]},
            "grid.cut_on[1]: you gave 0.2; gfmd allows a wavelength below roll_off = 0.15",
        ),
        (
            MOUNDS,
            {"correlation_length": [0.1, 0.4]},
            "grid.correlation_length[1]: you gave 0.4; gfmd allows at most mound_s",
        ),
        (
            MOUNDS,
            {"mound_separation": [0.01]},
            "grid.mound_separation[0]: you gave 0.01; gfmd allows a value for which correlation_length is at most "
            "mound",
        ),
        (MODEL, {"cut_on": [2]}, "grid.cut_on[0]: you gave 2; gfmd allows a wavelength so short that"),
        (
            MODEL,
            {"rms_gradient": [0.1]},
            "grid.rms_gradient[0]: you gave 0.1; gfmd allows exactly one of rms_height and",
        ),
        (
            MODEL,
            {"rms_gradient": [0.1], "cut_on": [0.2]},
            "grid.rms_gradient[0]: you gave 0.1; gfmd allows exactly one of",
        ),
        (
            POWER_LAW,
            {"roll_off": [0.1], "hurst": [0.5]},
            "grid.roll_off[0]: you gave 0.1; gfmd allows a value for which cut_",
        ),
        (MODEL, {"hurst": [0.0]}, "grid.hurst[0]: you gave 0"),
        (MODEL, {"correlation_length": [0]}, "grid.correlation_length[0]: you gave 0; gfmd allows a number from 1e-30"),
        (
            POWER_LAW,
            {"correlation_length": [1]},
            "gfmd allows nothing, as scene.roughness with model self_affine has no ",
        ),
        (
            EXPONENTS,
            {"hurst": [0.5]},
            "gfmd allows nothing, as scene.roughness with model scaling_anisotropy has no hurst",
        ),
    ],
)
def test_values_of_a_grid_keep_the_rules_of_their_surface_together(roughness, grid, said):
    with pytest.raises(InputError) as refused:
        load_campaign(campaign(roughness, grid))
    assert said in str(refused.value)


def test_values_are_checked_with_the_grids_others_and_not_with_what_they_replace():
    planned = plan(campaign(POWER_LAW, {"cut_on": [0.07, 0.08], "roll_off": [0.1]}))
    assert [case.problem.surface.generator.band for case in planned.cases] == [(10.0, 14), (10.0, 12)]


def test_a_wavelength_of_a_surface_on_a_discretisation_is_refused():
    file = campaign({"method": "psd", "hurst": 0.8, "rms_gradient": 0.02, "points": None}, {"cut_on": [0.1]})
    with pytest.raises(
        InputError, match=r"grid\.cut_on\[0\]: you gave 0.1; gfmd allows points, cut_on and roll_off together"
    ):
        load_campaign(file | {"reference": {"eps_c": 0.25, "eps_f": 0.25, "eps_t": 0.5}})


@pytest.mark.parametrize("scale", [{"rms_height": 1e-3}, {"rms_height": None, "rms_gradient": 0.01}])
def test_a_length_that_makes_no_surface_is_one_message(tmp_path, scale):
    file = tmp_path / "c.yaml"
    filtered = MODEL | {"method": "fourier_filter"} | scale
    file.write_text(yaml.safe_dump(campaign(filtered, {"correlation_length": [0.1, 5.0]})))
    done = CliRunner().invoke(main, ["run", str(file)])
    assert done.exit_code == 2
    said = " ".join(done.stderr.split())
    assert (
        "method fourier_filter, correlation_length 5; gfmd allows a usable surface, not a spectrum that is neg" in said
    )


@pytest.mark.parametrize("scale", [{"rms_height": 1e-3}, {"rms_gradient": 0.01}])
def test_a_length_at_which_no_wave_is_left_is_refused_everywhere(scale):
    smooth = {"method": "psd", "model": "exponential", "hurst": 1.0, "correlation_length": 20.0, "points": 32} | scale
    allowed = "a usable surface, not a spectrum that is zero at all waves that fit the period"
    with pytest.raises(InputError, match=allowed):
        plan(campaign(smooth | {"correlation_length": 0.1}, {"correlation_length": [0.1, 20.0]}))
    with pytest.raises(InputError, match=allowed):
        gfmd_numba.solve({"scene": campaign(smooth)["scene"]})
    with pytest.raises(InputError, match=allowed):
        gfmd_numba.make_surface({"surface": smooth})


@pytest.mark.long
def test_surfaces_with_a_grid_of_their_own_have_no_eps(tmp_path):
    tiny = MODEL | {"correlation_length": 1e-20}  # whose eps_f would be 1e19
    results = gfmd_numba.run(campaign(tiny, {"hurst": [0.5, 0.8]}), tmp_path / "out", workers=0)
    assert not EPS & set(results.coords)
    assert (results["nx"] == 32).all()
    with xr.open_dataset(tmp_path / "out" / "c.nc") as written:
        fitted = fit_tfc(written)
    assert fitted["reference"].notnull().all()
    assert fitted["kappa_tfc"].isnull().all()
    assert fitted["reference_eps"].isnull().all()
    for message in fitted["message"].values:
        assert message.startswith("surfaces have grids and lengths of their own: no discretisation is varied")
        assert "eps_" not in message


@pytest.mark.long
def test_commands_say_nothing_of_an_eps_that_a_campaign_has_not(tmp_path):
    file = tmp_path / "c.yaml"
    file.write_text(yaml.safe_dump(campaign(MODEL, {"correlation_length": [0.05, 0.1]})))
    out = str(tmp_path / "out")
    printed = ""
    for command in (["run", str(file), "-o", out, "--workers=0"], ["plot", out, "-o", str(tmp_path / "c.png")]):
        done = CliRunner().invoke(main, command)
        assert done.exit_code == 0, done.output
        printed += done.output
    assert "eps_" not in printed
    assert "0.05" in printed
    assert (tmp_path / "c.png").stat().st_size > 1000
    refused = CliRunner().invoke(main, ["run", str(file), "-o", out, "--only", "eps_c=1"])
    assert refused.exit_code == 2
    assert "--only: you gave eps_c" in refused.stderr


def test_exponents_of_an_eps_that_a_campaign_has_not_are_refused():
    with pytest.raises(
        InputError, match=r"fit\.fixed\.eps_c: you gave 1\.?0?; gfmd allows nothing, as the surface has"
    ):
        load_campaign(campaign(MODEL) | {"fit": {"fixed": {"eps_c": 1.0}}})


def test_the_grid_that_would_resolve_a_law_is_told_in_points(tmp_path):
    law = {"hard_wall": {}, "exponential": {"work_of_adhesion": 0.05, "range": 0.04}}
    planned = plan(campaign(MODEL, {"hurst": [0.5, 0.8]}, interface=law))
    assert "Take at least" in planned.validity
    assert "points" in planned.validity
    assert "eps_c" not in planned.validity
