"""A campaign says what speaks against its contacts, as a contact that is solved alone does."""

import warnings

import pytest

import gfmd_numba

SCENE = {
    "length": 1e-3,
    "body": {"youngs_modulus": 1e9, "poissons_ratio": 0.3},
    "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
    "interface": {"hard_wall": {}},
    "loading": {"pressure": 1e6},
}
GRID = {"reference": {"eps_c": 1 / 8, "eps_f": 1 / 8, "eps_t": 1 / 2}, "realisations": 4}


@pytest.mark.parametrize(
    ("changed", "campaign", "said"),
    [
        ({}, {}, ""),
        ({"loading": {"pressure": 1e3}}, {}, "may be that of single nodes"),
        ({"loading": {"pressure": 1e5}}, {"grid": {"pressure": [3e3, 1e6]}}, "narrow on this grid in 1 of 2 cases"),
        ({"loading": {"pressure": 1e3}}, {"limits": {"eps_c": [1 / 2, 1 / 4]}}, ""),
        ({"roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 1.0}}, {}, "no longer small in 1 of 1 cases"),
        ({"loading": {"pressure": 5e8}}, {}, "and the mean pressure 0.4"),
    ],
    ids=["sound", "single nodes", "one case of two", "a limit of eps_c", "steep", "pressed hard"],
)
def test_it_says_what_a_contact_alone_would(tmp_path, monkeypatch, changed, campaign, said):
    monkeypatch.chdir(tmp_path)
    given = {"name": "doubtful", "seed": 1, "scene": SCENE | changed} | GRID | campaign
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        validity = gfmd_numba.run(given).attrs["validity"]
    assert said in validity
    assert bool(said) == bool(validity)
