"""Scenes and campaigns of maps, from file to dataset, and what is refused."""

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba import run
from gfmd_numba.analysis.plots.contact import plot_contact
from gfmd_numba.scene import InputError
from gfmd_numba.solvers.status import Status
from support.campaigns import MAPS, campaign

SCENE = """\
dimension: 2
length: 1e-4
body: {youngs_modulus: 70e9, poissons_ratio: 0.33, aspect_ratio: 0.2}
roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
interface: {hard_wall: {}}
loading: {reduced_pressure: 0.05}
discretisation: {eps_c: 1/2, eps_f: 1/4, eps_t: 1/2}
"""


def scene(folder, old="", new=""):
    path = folder / "map.yaml"
    assert old in SCENE
    path.write_text(SCENE.replace(old, new) if old else SCENE)
    return path


def test_a_file_of_a_map_gives_a_dataset_of_x_and_y(tmp_path):
    gfmd_numba.solve(scene(tmp_path)).to_netcdf(tmp_path / "map.nc")
    with xr.open_dataset(tmp_path / "map.nc") as dataset:
        assert dataset["pressure"].dims == ("y", "x")
        assert dataset["y"].size == dataset["x"].size == 32
        assert float(dataset["pressure"].mean()) == pytest.approx(float(dataset["mean_pressure"]), rel=1e-9)
        assert float(dataset["kappa"]) < float(dataset["kappa_counted"])
        assert np.isnan(dataset["kappa_edges"])
        assert float(dataset["rms_gradient"]) == pytest.approx(0.01)
        figure = plot_contact(dataset)
    assert len(figure.axes) == 9  # three maps, their colour bars and three distributions


@pytest.mark.parametrize(
    ("old", "new", "where", "allowed"),
    [
        ("length: 1e-4", "boundary: {normal_traction: 1.0}", "boundary.normal_traction", "a mean of 0"),
        ("0.33,", "0.33, state: plane_stress,", "body.state", "'plane_strain'"),
        ("dimension: 2", "dimension: 3", "dimension", "one of 1, 2"),
    ],
)
def test_what_maps_cannot_have_is_refused(tmp_path, old, new, where, allowed):
    np.save(tmp_path / "a.npy", np.zeros(4))
    with pytest.raises(InputError) as refused:
        gfmd_numba.solve(scene(tmp_path, old, new))
    assert f"{where}: you gave" in str(refused.value)
    assert allowed in str(refused.value)


@pytest.mark.long
def test_a_campaign_of_maps_gives_plausible_kappas(tmp_path):
    text = MAPS + "reference: {eps_c: 1/2, eps_f: 1/4, eps_t: 1/2}\nlimits: {eps_c: [1, 1/4]}\n"
    dataset = run(campaign(tmp_path, text), output=tmp_path / "out", workers=0)
    assert dataset["nx"].values.tolist() == [32, 16, 64]
    assert (dataset["status"] == Status.ok).all()
    assert ((dataset["kappa"] > 1.5) & (dataset["kappa"] < 3.0)).all()
    assert dataset["kappa_edges"].isnull().all()
