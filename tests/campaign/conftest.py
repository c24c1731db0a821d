"""A small campaign that has run."""

import pytest

import gfmd_numba
from gfmd_numba.campaign.execution import Workers
from gfmd_numba.campaign.run import run as run_campaign
from support.campaigns import campaign


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("finished")
    path, failures = run_campaign(campaign(folder), folder / "out", Workers(0))
    assert failures == {}
    return gfmd_numba.open_campaign(path)
