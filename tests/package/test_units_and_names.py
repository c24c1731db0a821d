"""Every variable and coordinate of every dataset says what it is and in which unit, and cases can be looked up."""

from functools import cache

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.analysis import secant_stiffness
from gfmd_numba.campaign.work_precision import Point, dataset
from gfmd_numba.storage.atomic_file import write_dataset

BODY = {"youngs_modulus": 70e9, "poissons_ratio": 0.33, "aspect_ratio": 0.3}
ROUGH = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}
COARSE = {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1 / 2}
SURFACE = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1, "cut_on": 0.04, "roll_off": 0.5, "points": 64}
LOADED = {"scene": {"body": BODY, "boundary": {"normal_traction": 1e5}}, "points": 8}
CAMPAIGN = """
name: q
seed: 1
realisations: 3
scene:
  body: {youngs_modulus: 70e9, poissons_ratio: 0.33, aspect_ratio: 0.3}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}, exponential: {work_of_adhesion: 1e-3, range: 2e-6}}
  loading: {displacement: 2e-7}
  length: 1e-4
reference: {eps_c: 1/4, eps_f: 1/16, eps_t: 1/2}
limits: {eps_c: [1/2, 1/8]}
grid: {hurst: [0.3, 0.8]}
"""


def scene(path=(), **changes):
    asked = {"body": BODY, "roughness": ROUGH, "interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.05}}
    return {"scene": asked | {"length": 1e-4} | changes, "discretisation": COARSE, "path": list(path)}


@cache
def contact():
    return gfmd_numba.solve(scene())


@cache
def a_map():
    return gfmd_numba.solve(scene(dimension=2))


@cache
def a_path():
    return gfmd_numba.solve(scene(path=[{"reduced_pressure": 0.1}, {"reduced_pressure": 0.2}]))


@pytest.fixture(scope="module")
def campaign(tmp_path_factory):
    folder = tmp_path_factory.mktemp("campaign")
    (folder / "q.yaml").write_text(CAMPAIGN)
    return gfmd_numba.run(folder / "q.yaml", folder / "out", workers=0)


def described(found):
    for name, variable in found.variables.items():
        assert variable.attrs.get("units"), name
        assert variable.attrs.get("long_name"), name
    for dim in {"case", "realisation", "step", "group", "limit"} & set(found.dims):
        assert dim in found.indexes, dim


KINDS = {
    "contact": contact,
    "dimensionless": lambda: gfmd_numba.solve(scene(length=None)),
    "both components": lambda: gfmd_numba.solve(scene(interface={"hard_wall": {}, "friction": {"coefficient": 0.3}})),
    "path": a_path,
    "map": a_map,
    "rough body": lambda: gfmd_numba.solve(scene(roughness=None, body=BODY | {"roughness": ROUGH})),
    "loaded body": lambda: gfmd_numba.solve(
        {"scene": {"body": BODY, "boundary": {"normal_traction": 1e5}}, "points": 8}
    ),
    "surface": lambda: gfmd_numba.make_surface({"surface": SURFACE}),
    "map of heights": lambda: gfmd_numba.make_surface({"surface": SURFACE, "dimension": 2}),
    "fields": lambda: gfmd_numba.body_fields(contact()),
    "fields of a path": lambda: gfmd_numba.body_fields(a_path()),
    "statistics": lambda: gfmd_numba.contact_statistics(contact()),
    "statistics of a path": lambda: gfmd_numba.contact_statistics(a_path()),
    "statistics of a map": lambda: gfmd_numba.contact_statistics(a_map()),
    "percolation": lambda: gfmd_numba.gap_percolation(a_map()),
    "leakage": lambda: gfmd_numba.leakage(a_map()),
    "conductance": lambda: gfmd_numba.contact_conductance(a_map()),
    "stiffness": lambda: secant_stiffness(a_path()),
    "accuracy": lambda: dataset([Point("surfaces", "reference", 4.0, 0.1, 1.0, 10.0, 0, "kappa", 0.1, 0.1, 1e-5)]),
}


@pytest.mark.parametrize(
    "kind",
    [pytest.param(kind, marks=pytest.mark.long) if kind in ("fields of a path", "leakage") else kind for kind in KINDS],
)
def test_a_dataset_says_what_each_of_its_numbers_is(kind, tmp_path):
    found = KINDS[kind]()
    described(found)
    write_dataset(tmp_path / "found.nc", found)
    with xr.open_dataset(tmp_path / "found.nc") as written:
        described(written)


def test_a_campaign_says_what_each_of_its_numbers_is(campaign):
    described(campaign)
    assert campaign.sel(case=3)["hurst"] == 0.8
    assert campaign.indexes["realisation"].tolist() == [0, 1, 2]
    assert campaign["punch_displacement"].units == "m"
    assert campaign["work_of_adhesion"].units == "J m-2"
    assert campaign["interaction_range"].units == "m"


def test_a_fit_says_what_each_of_its_numbers_is(campaign, tmp_path):
    fitted = gfmd_numba.fit_tfc(campaign, variable="mean_gap", fixed={"eps_c": 1.0})
    described(fitted)
    assert fitted["mean_gap_tfc"].units == fitted["C"].units == "m"
    assert fitted["mean_gap_tfc"].long_name == "mean_gap in the thermodynamic, fractal and continuum limit"
    assert not [name for name in fitted.variables if "kappa" in name]
    assert "kappa_tfc" not in str(fitted.attrs) + str({n: fitted[n].attrs for n in fitted.variables})
    assert fitted["alpha"].units == "1"
    assert fitted["work_of_adhesion"].attrs["axis"] == "physics"
    assert np.array_equal(fitted["group"], [0, 1])
    write_dataset(tmp_path / "fit.nc", fitted)
    with xr.open_dataset(tmp_path / "fit.nc") as written:
        described(written)
