"""Results of a campaign: they describe themselves, equal contacts solved alone, and are found again."""

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.scene import InputError
from support.campaigns import SMALL, TINY, campaign, numbers


def test_dataset_is_self_describing(finished):
    assert finished.sizes == {"case": 10, "realisation": 6}
    assert (finished["status"] == 0).all()
    assert finished["status"].attrs["flag_meanings"].split()[0] == "ok"
    for name in finished.data_vars:
        assert {"units", "long_name"} <= finished[name].attrs.keys()
    assert finished.attrs["campaign"] == SMALL
    assert finished.attrs["Conventions"].startswith("CF-")
    e_star = 70e9 / (1 - 0.33**2)
    np.testing.assert_allclose(finished["mean_pressure"], 0.05 * 0.01 * e_star, rtol=1e-6)
    np.testing.assert_allclose(finished["rms_gradient"], 0.01)
    area = finished["contact_area_fraction_counted"] * finished["rms_gradient"] * e_star / finished["mean_pressure"]
    np.testing.assert_allclose(finished["kappa_counted"], area)


def test_a_case_equals_the_contact_solved_alone(finished):
    case = finished.isel(case=2, realisation=4)
    alone = gfmd_numba.solve(
        {
            "scene": {
                "body": {"youngs_modulus": 70e9, "poissons_ratio": 0.33},
                "roughness": {"method": "psd", "hurst": float(case.hurst), "rms_gradient": 0.01},
                "interface": {"hard_wall": {}},
                "loading": {"reduced_pressure": 0.05},
            },
            "discretisation": {name: float(case[name]) for name in ("eps_c", "eps_f", "eps_t")},
            "seed": 1,
            "realisation": 4,
        }
    )
    for name in numbers(finished).data_vars:
        assert float(alone[name]) == float(case[name]), name


@pytest.mark.long
def test_results_are_found_by_name_among_other_files(tmp_path):
    out = tmp_path / "out"
    found = gfmd_numba.run(campaign(tmp_path, TINY), out)
    (out / "another.nc").touch()
    xr.testing.assert_identical(gfmd_numba.open_campaign(out), found)
    (out / "campaign.yaml").unlink()
    with pytest.raises(InputError, match="you gave a directory with 2 netCDF files"):
        gfmd_numba.open_campaign(out)
    with pytest.raises(InputError, match=r"another.nc: you gave a file that is not netCDF"):
        gfmd_numba.open_campaign(out / "another.nc")
    with pytest.raises(InputError, match=r"third.nc: you gave a path that cannot be read \(No such"):
        gfmd_numba.open_campaign(out / "third.nc")
