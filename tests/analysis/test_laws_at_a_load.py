"""The law of the unseen slope at a load: areas have it as kappa does, and each step of a path that of its own load."""

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.analysis.selection import has_measured_slope_law

CAMPAIGN = {
    "name": "loads",
    "seed": 4,
    "realisations": 6,
    "scene": {
        "body": {"youngs_modulus": 1e9, "poissons_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
        "interface": {"hard_wall": {}},
        "loading": {"pressure": 4e5},
    },
    "reference": {"eps_c": 1 / 4, "eps_f": 1 / 32, "eps_t": 1 / 2},
    "limits": {"eps_f": [1 / 8, 1 / 64]},
}


@pytest.fixture(scope="module")
def light(tmp_path_factory):
    return gfmd_numba.run(CAMPAIGN, tmp_path_factory.mktemp("light") / "out")


def test_an_area_at_one_load_has_the_limit_of_kappa(light):
    kappa, area = (gfmd_numba.fit_tfc(light, name) for name in ("kappa", "contact_area_fraction"))
    load = light["reduced_pressure"].values[0]
    assert area["law"].sel(limit="eps_f").item() == "unseen slope"
    np.testing.assert_allclose(area["contact_area_fraction_tfc"], load * kappa["kappa_tfc"], rtol=1e-9)
    np.testing.assert_allclose(area["contact_area_fraction_tfc_error"], load * kappa["kappa_tfc_error"], rtol=1e-6)


@pytest.mark.long
def test_a_step_of_a_path_has_the_law_of_its_own_load(light, tmp_path):
    """An elastic contact does not remember, so that the step has the limit of a campaign under its load alone."""
    heavy = CAMPAIGN | {"scene": CAMPAIGN["scene"] | {"loading": {"pressure": 2e6}}}
    steps = gfmd_numba.fit_tfc(gfmd_numba.run(CAMPAIGN | {"path": [{"pressure": 2e6}]}, tmp_path / "path"))
    for step, results in enumerate((light, gfmd_numba.run(heavy, tmp_path / "heavy"))):
        alone = gfmd_numba.fit_tfc(results)
        np.testing.assert_allclose(steps["kappa_tfc"][step], alone["kappa_tfc"][0], rtol=1e-5)
        np.testing.assert_allclose(steps["kappa_tfc_error"][step], alone["kappa_tfc_error"][0], rtol=1e-3)


def test_groups_of_several_loads_do_not_share_the_unseen_slope(light, tmp_path):
    """Contacts see shorter waves the larger the load is, so that each group has the limit that it has alone."""
    heavy = gfmd_numba.run(CAMPAIGN | {"grid": {"pressure": [4e5, 4e6]}}, tmp_path / "both")
    both, alone = gfmd_numba.fit_tfc(heavy, exponents="shared"), gfmd_numba.fit_tfc(light)
    np.testing.assert_allclose(both["kappa_tfc"][0], alone["kappa_tfc"][0], rtol=1e-9)
    np.testing.assert_allclose(both["kappa_tfc_error"][0], alone["kappa_tfc_error"][0], rtol=1e-6)


@pytest.mark.parametrize(("told", "is_measured"), [([True, True], True), ([True, False], False), (None, False)])
def test_the_law_was_measured_for_contacts_if_all_cases_say_so(told, is_measured):
    cases = xr.Dataset(coords={"reduced_pressure": ("case", [0.01, 0.01])})
    if told is not None:
        cases = cases.assign_coords(has_measured_slope_law=("case", told))
    assert has_measured_slope_law(cases) == is_measured
