"""A target or a budget is planned for campaigns whose loads vary, whatever unit the loads have."""

import re

import numpy as np
import pytest
import yaml
from click.testing import CliRunner

import gfmd_numba
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.cli import main

pytestmark = pytest.mark.usefixtures("laws_that_hold")

LOADS = {
    "pressure": ["1 MPa", "10 MPa"],
    "line_load": ["1 kN/m", "1e4 N/m"],
    "force": ["1 N", "10 N"],
    "displacement": ["2 um", "4 um"],
}

EXPONENTS = {"eps_c": 1, "eps_f": 0.5, "eps_t": 1}


FINE = {
    "reference": {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1 / 4},
    "limits": {"eps_c": [1 / 2, 1 / 8], "eps_f": [1 / 8, 1 / 32], "eps_t": [1 / 2, 1 / 8]},
}


def campaign(folder, load, **changes):
    dimension = 2 if load == "force" else 1
    body = {"youngs_modulus": "2 GPa", "poissons_ratio": 0.33} | ({"aspect_ratio": 1} if load == "displacement" else {})
    file = {
        "name": "loads",
        "seed": 1,
        "realisations": 2,
        "scene": {
            "length": "1 mm",
            "dimension": dimension,
            "body": body,
            "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.03},
            "interface": {"hard_wall": {}},
            "loading": {load: LOADS[load][0]},
        },
        "reference": {"eps_c": 1 / 2, "eps_f": 1 / 4, "eps_t": 1 / 2},
        "limits": {"eps_c": [1 / 4], "eps_f": [1 / 8], "eps_t": [1, 1 / 4]},
        "grid": {load: LOADS[load]},
        "fit": {"fixed": EXPONENTS},
    }
    (folder / "loads.yaml").write_text(yaml.safe_dump(file | changes))
    return folder / "loads.yaml"


def gfmd(*words):
    done = CliRunner().invoke(main, [str(word) for word in words])
    assert done.exit_code == 0, done.output
    return " ".join(done.output.split())


@pytest.mark.long
@pytest.mark.parametrize("load", LOADS)
def test_a_design_holds_for_each_load_and_is_written_with_its_units(tmp_path, load):
    path, better = campaign(tmp_path, load), tmp_path / "better.yaml"
    said = gfmd("plan", path, "--target", "kappa=20%", "--write", better)
    assert "each of the 2 groups reaches this error with 90 % probability" in said
    assert float(re.search(r"error ([0-9.]+)% of kappa", said)[1]) <= 20.0
    written, given = load_campaign(better)[0], load_campaign(path)[0]
    assert (written.target, written.grid, written.scene) == ({"kappa": 0.2}, given.grid, given.scene)
    assert yaml.safe_load(better.read_text())["grid"] == {load: LOADS[load]}
    assert written.realisations.reference > given.realisations.reference


@pytest.mark.long
def test_a_target_is_reached_at_each_pressure(tmp_path):
    path, better = campaign(tmp_path, "pressure", **FINE), tmp_path / "better.yaml"
    gfmd("plan", path, "--target", "kappa=10%", "--write", better)
    fitted = gfmd_numba.fit_tfc(gfmd_numba.run(better, tmp_path / "out"), fixed=EXPONENTS)
    assert fitted["prescribed_pressure"].values.tolist() == [1e6, 1e7]
    error = fitted["kappa_tfc_error"] / fitted["kappa_tfc"]
    assert (error <= 0.1).all()
    assert float(error.max()) > 0.02  # no more surfaces than it takes


@pytest.mark.long
def test_a_budget_buys_a_smaller_error_for_all_loads(tmp_path):
    path = campaign(tmp_path, "pressure", **FINE)
    told = [gfmd("plan", path, "--budget", budget) for budget in ("2s", "20s")]
    errors = [float(re.search(r"error ([0-9.]+)% of kappa", said)[1]) for said in told]
    assert np.isclose(errors[0] / errors[1], np.sqrt(10), rtol=0.5)
