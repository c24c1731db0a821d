"""Fits warn of contacts of too few nodes, on a profile and on a map, and of no others."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba import fit_tfc
from support.campaigns import MAPS
from support.campaigns import campaign as campaign_file
from support.synthetic_campaigns import ALPHA, campaign


def message(nodes_of_all, segments, **coordinates):
    """What a fit says of a campaign whose contacts have so many nodes together, in so many stretches."""
    dataset = campaign()
    shape = dataset["kappa"].dims, np.ones(dataset["kappa"].shape)
    named = {"nx": ("case", np.full(dataset.sizes["case"], 512))}
    named |= {name: ("case", np.full(dataset.sizes["case"], value)) for name, value in coordinates.items()}
    total = 512 ** coordinates.get("dimension", 1)
    dataset = dataset.assign_coords(named).assign(
        n_segments=(shape[0], segments * shape[1]),
        contact_area_fraction_counted=(shape[0], nodes_of_all / total * shape[1]),
    )
    return fit_tfc(dataset, fixed=ALPHA)["message"].item()


@pytest.mark.long
def test_stretches_of_a_profile_are_counted_along_it():
    for known in ({}, {"dimension": 1}):
        said = message(30, 20, **known)
        assert "stretches of contact have 1.5 nodes on average where they have most, fewer than 2:" in said
        assert "take a finer eps_c or a higher pressure" in said
    assert "nodes on average" not in message(41, 20, dimension=1)


def test_the_note_names_what_the_grid_of_a_campaign_follows_from(tmp_path):
    scene = {
        "body": {"poissons_ratio": 0.3},
        "roughness": {
            "method": "psd",
            "hurst": 0.8,
            "roll_off": 0.5,
            "cut_on": 0.125,
            "rms_gradient": 0.02,
            "points": 64,
        },
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 1e-6},
    }
    dataset = gfmd_numba.run({"name": "c", "seed": 1, "realisations": 3, "scene": scene}, tmp_path / "out")
    assert "take more points or a higher pressure" in " ".join(fit_tfc(dataset)["message"].item().split())


@pytest.mark.long
def test_patches_of_a_map_are_counted_over_its_square():
    assert "patches of contact have 3.5 nodes on average where they have most, fewer than 4:" in message(
        70, 20, dimension=2
    )
    assert "nodes on average" not in message(81, 20, dimension=2)


@pytest.mark.long
def test_a_campaign_of_resolved_maps_is_not_warned_of(tmp_path):
    text = MAPS + "reference: {eps_c: 1/4, eps_f: 1/8, eps_t: 1/2}\nlimits: {eps_c: [1/2]}\n"
    dataset = gfmd_numba.run(campaign_file(tmp_path, text), tmp_path / "out")
    assert (dataset["dimension"] == 2).all()
    nodes = dataset["contact_area_fraction_counted"] * dataset["nx"] ** 2
    assert (nodes.sum("realisation") / dataset["n_segments"].sum("realisation")).max() > 20
    assert "nodes on average" not in fit_tfc(dataset, fixed={"eps_c": 1.0})["message"].item()
