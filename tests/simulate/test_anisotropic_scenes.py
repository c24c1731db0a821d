"""Both anisotropic models of the thesis, (3.15) and (3.16), from a scene and a campaign to pictures."""

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.analysis import plot_body, plot_campaign, plot_surface
from gfmd_numba.analysis.plots.contact import plot_contact
from gfmd_numba.fourier import grid
from gfmd_numba.roughness.spectra import LengthAnisotropicSpectrum, ScalingAnisotropicSpectrum
from support.cases import some_of
from support.legible import faults

NX = 64
LENGTHS = {"correlation_length_x": 0.04, "correlation_length_y": 0.16, "rms_height": 2e-3}
MODELS = {
    "length_anisotropy": {"hurst": 0.8},
    "scaling_anisotropy": {"hurst_x": 0.4, "hurst_y": 0.8},
}
SPECTRA = {
    "length_anisotropy": LengthAnisotropicSpectrum(0.8, (0.04, 0.16)),
    "scaling_anisotropy": ScalingAnisotropicSpectrum((0.4, 0.8), (0.04, 0.16)),
}


@pytest.fixture(params=some_of(MODELS, 1))
def model(request):
    return request.param


def scene(model):
    return {
        "dimension": 2,
        "body": {"poissons_ratio": 0.3},
        "roughness": {"method": "psd", "model": model, "points": NX} | LENGTHS | MODELS[model],
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.05},
    }


@pytest.mark.long
def test_a_scene_is_solved_and_drawn_with_the_slopes_of_its_model(model):
    contact = gfmd_numba.solve({"scene": scene(model), "seed": 5})
    assert int(contact["status"]) == 0
    qy, qx = grid.wavevectors((NX, NX), (1.0, 1.0))
    density = SPECTRA[model].psd(qx, qy) * grid.multiplicity(NX)
    density[0, 0] = 0.0
    expected = np.sqrt((qx**2 * density).sum() / (qy**2 * density).sum())
    waves = abs(grid.coefficients(contact["height"].values, 2)) ** 2 * grid.multiplicity(NX)
    slopes = np.sqrt([(q**2 * waves).sum() for q in (qx, qy)])
    assert slopes[0] / slopes[1] == pytest.approx(expected, rel=0.1)
    assert expected > 1.5
    assert faults(plot_contact(contact)) == []
    assert len(plot_body(gfmd_numba.body_fields(contact)).axes) == 5
    surface = gfmd_numba.make_surface({"surface": scene(model)["roughness"], "dimension": 2})
    plot_surface(surface)


@pytest.mark.long
def test_a_campaign_has_the_contact_of_the_scene_and_is_drawn(model, tmp_path):
    alone = gfmd_numba.solve({"scene": scene(model), "seed": 5})
    loads = {"reduced_pressure": [0.05, 0.1]}
    campaign = {"name": "a", "seed": 5, "realisations": 2, "scene": scene(model), "grid": loads}
    found = gfmd_numba.run(campaign, tmp_path / "out", workers=0)
    assert (found["status"] == 0).all()
    same = found.isel(case=0, realisation=0)
    for name in ("contact_area_fraction", "mean_gap", "kappa", "rms_gradient"):
        xr.testing.assert_allclose(same[name].drop_vars(same[name].coords), alone[name].drop_vars(alone[name].coords))
    assert (found["contact_area_fraction"].diff("case") > 0.0).all()
    assert faults(plot_campaign(found)) == []
