"""Results for commands to read."""

import pytest

from gfmd_numba.campaign.run import run as run_campaign
from gfmd_numba.campaign.workers import Workers
from support.campaigns import campaign


@pytest.fixture(scope="session")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    return run_campaign(campaign(folder), folder / "out", Workers(0))[0]
