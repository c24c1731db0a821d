"""What is told of a ball without roughness: its force and radius, and nothing that counts in roughness."""

import json
import warnings

import pytest
import xarray as xr
from click.testing import CliRunner

import gfmd_numba
from gfmd_numba.analysis import plot_curve, plot_statistics
from gfmd_numba.cli import main
from gfmd_numba.text.recorded_scene import is_form_alone

pytestmark = pytest.mark.usefixtures("undrawn")

BALL = {
    "dimension": 2,
    "periodic": False,
    "length": "100 um",
    "body": {"youngs_modulus": "2 GPa", "poissons_ratio": 0.35},
    "form": {"radius": "1 mm", "points": 24},
    "interface": {"hard_wall": {}},
    "loading": {"force": "50 mN"},
}


def told(tmp_path, command, *options, **changes):
    scene = {key: value for key, value in (BALL | changes).items() if value is not None}
    (tmp_path / "ball.yaml").write_text(json.dumps({"scene": scene}))
    done = CliRunner().invoke(main, [command, str(tmp_path / "ball.yaml"), *options, "-o", str(tmp_path / "ball.nc")])
    assert done.exit_code == 0, done.output
    return done.stdout


def test_force_radius_approach_and_peak_pressure_are_told(tmp_path):
    said = told(tmp_path, "solve")
    for words in ("p*", "kappa", "mean pressure"):
        assert words not in said
    for words in ("force                   50            mN", "contact radius", "approach", "peak pressure"):
        assert words in said
    statistics = gfmd_numba.contact_statistics(gfmd_numba.solve(tmp_path / "ball.yaml"))
    assert not any("persson" in name for name in statistics.variables)
    assert len(plot_statistics(statistics).axes) == 3


@pytest.mark.parametrize(("length", "unit"), [("100 um", "mN"), (None, "E* L_x2")])
def test_a_prescribed_displacement_tells_the_force(tmp_path, length, unit):
    """Of Hertz, 4/3 E* R^(1/2) d^(3/2)."""
    body = BALL["body"] if length else {"poissons_ratio": 0.35}
    form, way = ({"radius": 10.0, "points": 24}, 6.5e-3) if length is None else (BALL["form"], "0.65 um")
    said = told(tmp_path, "solve", length=length, body=body, form=form, loading={"displacement": way})
    line = next(line for line in said.splitlines() if line.startswith("force"))
    expected = 4.0 / 3.0 * (10.0**0.5 * 6.5e-3**1.5 if length is None else 1e3 * 2.279202e9 * 1e-3**0.5 * 0.65e-6**1.5)
    assert float(line.split()[1]) == pytest.approx(expected, rel=0.02)
    assert line.endswith(unit)


@pytest.mark.long
def test_the_pull_off_of_a_ball_is_a_force(tmp_path):
    """Also the tension where a step was divided, which is larger than at the steps."""
    law = {"exponential": {"work_of_adhesion": "50 mJ/m^2", "range": "1 um"}}
    changed = {"body": {"youngs_modulus": "3 MPa", "poissons_ratio": 0.5}, "interface": {"hard_wall": {}} | law}
    way = {"loading": {"displacement": "0.5 um"}}
    path = [{"displacement": f"{-d} um"} for d in (0.3, 1, 2)]
    (tmp_path / "ball.yaml").write_text(json.dumps({"scene": BALL | changed | way, "path": path}))
    done = CliRunner().invoke(main, ["solve", str(tmp_path / "ball.yaml"), "-o", str(tmp_path / "ball.nc")])
    (line,) = (each for each in done.stdout.splitlines() if each.startswith("pull-off"))
    found = xr.load_dataset(tmp_path / "ball.nc")
    force = 1e-8 * float(found["pull_off_pressure"])
    assert line.split()[0:2] == ["pull-off", "force"]
    assert line.split()[3] == "µN"
    assert float(line.split()[2]) == pytest.approx(1e6 * force, rel=1e-4)
    assert force > -1e-8 * float(found["mean_pressure"].min())


def test_a_curve_over_forces_draws_radius_and_approach_over_the_force(tmp_path):
    said = told(tmp_path, "curve", "--loads", "10mN,50mN")
    assert "p*" not in said
    assert "radius" in said
    axes = plot_curve(xr.load_dataset(tmp_path / "ball.nc")).axes
    assert [axis.get_ylabel().split(" (")[0] for axis in axes[:2]] == ["Contact radius", r"Approach $\delta$"]
    assert axes[-1].get_xlabel().startswith("Force (")


def test_a_rough_ball_is_none():
    rough = {"scene": {"form": {"radius": 1.0}, "body": {"roughness": {"method": "psd"}}}}
    assert not is_form_alone(json.dumps(rough))
    assert is_form_alone(json.dumps({"scene": {"form": {"radius": 1.0}, "body": {}, "counter_body": None}}))
    assert not is_form_alone(json.dumps({"scene": {"roughness": {"method": "psd"}, "body": {}}}))


@pytest.mark.parametrize("rough", [False, True])
def test_statistics_of_a_form_have_nothing_that_depends_on_the_cut_out(rough):
    roughness = {"roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.001}} if rough else {}
    levels = {"discretisation": {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1 / 2}} if rough else {}
    form = {"radius": "1 mm"} | ({} if rough else {"points": 24})
    with warnings.catch_warnings(action="ignore"):
        contact = gfmd_numba.solve({"scene": BALL | roughness | {"form": form}} | levels)
    found = gfmd_numba.contact_statistics(contact)
    assert not [name for name in found.variables if "persson" in name or name == "mean_gap"]
    plot_statistics(found)


def test_a_rough_counter_body_is_no_form_alone():
    rough = {"form": {"radius": 1.0}, "body": {}, "counter_body": {"roughness": {"method": "psd"}}}
    assert not is_form_alone(json.dumps({"scene": rough}))


def test_a_form_with_a_period_has_a_mean_pressure(tmp_path):
    said = told(tmp_path, "solve", periodic=True, loading={"pressure": "1 MPa"})
    assert "mean pressure" in said
    assert "p*" not in said
    assert "\nforce" not in said


def test_a_force_without_a_length_is_told_in_pascals_of_the_window(tmp_path):
    said = told(tmp_path, "solve", length=None, form={"radius": 10.0, "points": 24}, loading={"displacement": 6.5e-3})
    (line,) = (line for line in said.splitlines() if line.startswith("force"))
    assert line.endswith("Pa L_x2")
