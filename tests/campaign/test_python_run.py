"""What `gfmd_numba.run` takes for a campaign and for workers, and that a refused call leaves nothing behind."""

import re

import numpy as np
import pytest
import xarray as xr
from distributed import Client, LocalCluster

import gfmd_numba
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.campaign.run import run as run_campaign
from gfmd_numba.campaign.workers import Workers
from gfmd_numba.scene import InputError
from gfmd_numba.scene.document import read_document
from support.campaigns import TINY, campaign, numbers


@pytest.fixture
def mapping(tmp_path):
    return read_document(campaign(tmp_path)).data


def test_a_mapping_is_a_campaign(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = campaign(tmp_path, TINY)
    mapping = read_document(path).data
    result = gfmd_numba.run(mapping)
    xr.testing.assert_identical(numbers(result), numbers(gfmd_numba.run(path, "of_the_file")))
    assert load_campaign(tmp_path / "tiny" / "campaign.yaml")[0] == load_campaign(path)[0]


@pytest.mark.parametrize("name", ["1e5", "null", "007", "no", "-"])
def test_the_text_of_a_mapping_says_the_same(mapping, tmp_path, name):
    shared = [np.float64(0.3), 0.8]
    mapping |= {"name": name, "grid": {"hurst": shared, "aspect_ratio": (float("inf"), 1e-5)}, "limits": {}}
    given, document = load_campaign(mapping)
    path = tmp_path / "again.yaml"
    path.write_text(document.text)
    assert load_campaign(path)[0] == given


def test_faults_of_a_mapping_are_told(mapping):
    mapping["grid"]["hirst"] = mapping["grid"].pop("hurst")
    with pytest.raises(InputError, match=r"^grid.hirst: you gave an unknown key; .*did you mean 'hurst'\?"):
        gfmd_numba.run(mapping)


@pytest.mark.parametrize("given", [123, None, [1], 1.5, b"campaign.yaml"])
def test_what_is_no_campaign_is_refused(given, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    allowed = "gfmd allows the path of a YAML file, or a mapping of its content"
    with pytest.raises(
        InputError, match=f"^campaign: you gave {re.escape(repr(given)[:40]) if given else ''}.*{allowed}"
    ):
        gfmd_numba.run(given)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("given", ["2", -1, 1.5, True, None, [2]])
def test_what_are_no_workers_is_refused(given, tmp_path):
    path = campaign(tmp_path)
    with pytest.raises(InputError, match=r"^workers: you gave .*; gfmd allows a number of processes from 0, a dask"):
        gfmd_numba.run(path, tmp_path / "out", workers=given)
    assert not (tmp_path / "out").exists()


def test_an_output_that_is_no_path_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"^output: you gave 5; gfmd allows the path of a directory"):
        gfmd_numba.run(campaign(tmp_path), 5)


@pytest.mark.long
def test_a_dask_client_may_do_the_work(finished, tmp_path):
    with (
        LocalCluster(n_workers=1, threads_per_worker=1, processes=False, dashboard_address="127.0.0.1:0") as cluster,
        Client(cluster, set_as_default=False) as client,
    ):
        result = gfmd_numba.run(campaign(tmp_path), tmp_path / "out", workers=client)
        assert client.status == "running"  # it is the caller's
    xr.testing.assert_identical(numbers(result), numbers(finished))
    with pytest.raises(InputError, match=r"^workers: you gave a dask client that is closed; gfmd allows .*connected"):
        gfmd_numba.run(campaign(tmp_path), tmp_path / "new", workers=client)
    assert not (tmp_path / "new").exists()


def test_a_scheduler_that_is_refused_leaves_no_directory(tmp_path):
    with pytest.raises(InputError, match="--scheduler: you gave"):
        run_campaign(campaign(tmp_path), tmp_path / "a" / "out", Workers(address="nowhere://127.0.0.1:1"))
    assert [entry.name for entry in tmp_path.iterdir()] == ["campaign.yaml"]


def test_workers_that_are_refused_leave_no_directory(tmp_path):
    with (
        LocalCluster(n_workers=0, processes=False, dashboard_address="127.0.0.1:0") as cluster,
        Client(cluster, set_as_default=False) as client,
        pytest.raises(InputError, match="without workers"),
    ):
        gfmd_numba.run(campaign(tmp_path), tmp_path / "out", workers=client)
    assert [entry.name for entry in tmp_path.iterdir()] == ["campaign.yaml"]


def test_a_refused_run_keeps_what_was_there(tmp_path):
    out = tmp_path / "out"
    gfmd_numba.run(campaign(tmp_path, TINY), out)
    next(out.glob("shards/*.shard")).unlink()
    before = sorted(out.rglob("*"))
    with pytest.raises(InputError, match="--scheduler: you gave"):
        run_campaign(campaign(tmp_path, TINY), out, Workers(address="nowhere://127.0.0.1:1"))
    assert sorted(out.rglob("*")) == before


def test_a_message_about_a_scheduler_is_told_once(tmp_path):
    with pytest.raises(InputError) as told:
        run_campaign(campaign(tmp_path), tmp_path / "out", Workers(address="tcp://192.0.2.1:8786"))
    assert str(told.value).count("you gave") == str(told.value).count("gfmd allows") == 1
