"""Campaigns: which problems are the same, and that no interruption or worker count changes a number."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import psutil
import pytest
import xarray as xr
from distributed import LocalCluster

import gfmd_numba
from gfmd_numba.campaign import execution, shards
from gfmd_numba.campaign.cases import blocks
from gfmd_numba.campaign.execution import Workers
from gfmd_numba.campaign.failures import Failure
from gfmd_numba.campaign.output_directory import claimed
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.run import run as run_campaign
from gfmd_numba.scene import InputError
from gfmd_numba.storage.atomic_file import replace

SMALL = """
name: small
seed: 1
realisations: 6
scene:
  body: {youngs_modulus: 70e9, poissons_ratio: 0.33}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.05}
reference: {eps_c: 1/4, eps_f: 1/16, eps_t: 1/2}
limits: {eps_c: [1/2, 1/4, 1/8], eps_f: [1/8, 1/16, 1/32]}
grid: {hurst: [0.3, 0.8]}
"""


def campaign(folder: Path, text: str = SMALL, **replacements: str) -> Path:
    for old, new in replacements.items():
        assert old in text
        text = text.replace(old, new)
    path = folder / "campaign.yaml"
    path.write_text(text)
    return path


def numbers(dataset: xr.Dataset) -> xr.Dataset:
    return dataset.drop_vars(["wall_time", "case_seconds"]).drop_attrs()


def test_limits_are_one_at_a_time_around_one_reference(tmp_path):
    cases = plan(campaign(tmp_path)).cases
    assert len(cases) == 2 * 5
    eps = [(c.scene.roughness.hurst, c.limit, c.discretisation.eps_c, c.discretisation.eps_f) for c in cases[:5]]
    assert eps == [
        (0.3, "reference", 1 / 4, 1 / 16),
        (0.3, "eps_c", 1 / 2, 1 / 16),
        (0.3, "eps_c", 1 / 8, 1 / 16),
        (0.3, "eps_f", 1 / 4, 1 / 8),
        (0.3, "eps_f", 1 / 4, 1 / 32),
    ]
    assert {c.scene.roughness.hurst for c in cases[5:]} == {0.8}


def test_grid_is_a_full_product(tmp_path):
    text = SMALL.replace("limits: {eps_c: [1/2, 1/4, 1/8], eps_f: [1/8, 1/16, 1/32]}", "")
    text = text.replace("hurst: [0.3, 0.8]", "eps_c: [1/2, 1/4], eps_f: [1/8, 1/16], reduced_pressure: [0.1, 0.2]")
    cases = plan(campaign(tmp_path, text)).cases
    assert len(cases) == 8
    assert len({c.problem.identity for c in cases}) == 8


def test_equal_problems_are_solved_once(tmp_path):
    """A half-space knows nu only through E*, a deep slab is a half-space, the gradient only scales."""
    grid = "poissons_ratio: [0.2, 0.33], aspect_ratio: [.inf, 6, 0.5], rms_gradient: [0.01, 0.1]"
    planned = plan(campaign(tmp_path, **{"hurst: [0.3, 0.8]": grid}))
    assert len(planned.cases) == 2 * 3 * 2 * 5
    assert len(planned.problems) == 5 * (1 + 2)
    assert (
        sum(effect.state == "dropped" for effect in planned.effects) == 1 + 2
    )  # the half-space's Poisson's ratio; a = 6 at either Poisson's ratio


def test_identity_follows_what_decides_the_numbers(tmp_path):
    def identity(**changes):
        return plan(campaign(tmp_path, **changes)).cases[0].problem.identity

    base = identity()
    assert identity(**{"70e9": "1e9"}) == base
    assert identity(**{"rms_gradient: 0.01": "rms_gradient: 0.02"}) == base
    for old, new in (
        ("seed: 1", "seed: 2"),
        ("0.05", "0.06"),
        ("[0.3, 0.8]", "[0.4]"),
        ("eps_f: 1/16, eps_t", "eps_f: 1/32, eps_t"),
        ("grid:", "numerics: {residual: 1e-7}\ngrid:"),
        ("0.33}", "0.33, aspect_ratio: 0.1}"),
    ):
        assert identity(**{old: new}) != base


def test_blocks_cover_all_realisations_once(tmp_path, monkeypatch):
    monkeypatch.setattr("gfmd_numba.campaign.cases._BLOCK_SAMPLES", 500)
    planned = plan(campaign(tmp_path))
    for case in planned.cases:
        covered = [r for block in blocks(case.problem, 6) for r in range(block.first, block.stop)]
        assert covered == list(range(6))
    assert len(list(planned.blocks)) > len(planned.cases)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("finished")
    path, failures = run_campaign(campaign(folder), folder / "out", Workers(0))
    assert failures == {}
    return gfmd_numba.open_campaign(path)


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


@pytest.mark.parametrize("workers", [1, 2])
def test_worker_count_changes_no_number(finished, tmp_path, workers):
    result = gfmd_numba.run(campaign(tmp_path), tmp_path / "out", workers)
    xr.testing.assert_identical(numbers(result), numbers(finished))


@pytest.mark.parametrize("workers", [0, 2])
def test_a_killed_run_resumes_to_the_same_numbers(finished, tmp_path, workers):
    """SIGKILL as soon as the first shards are there; what is finished is not computed again."""
    path, out = campaign(tmp_path), tmp_path / "out"
    command = [sys.executable, "-m", "gfmd_numba.cli", "run", str(path), "-o", str(out), f"--workers={workers}"]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
    while process.poll() is None and len(list(out.glob("shards/*.shard"))) < 3:
        time.sleep(0.001)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    left = {shard: shard.stat().st_mtime_ns for shard in out.glob("shards/*.shard")}
    assert len(left) >= 3
    result = gfmd_numba.run(path, out, workers)
    xr.testing.assert_identical(numbers(result), numbers(finished))
    assert {shard: shard.stat().st_mtime_ns for shard in left} == left


@pytest.mark.skipif(sys.platform == "win32", reason="no process groups to interrupt")
def test_an_interrupt_is_one_message_and_leaves_nothing_running(tmp_path):
    """Ctrl-C reaches the workers, too, at any moment after the first shard."""
    path, out = campaign(tmp_path, **{"realisations: 6": "realisations: 6000"}), tmp_path / "out"
    command = [sys.executable, "-m", "gfmd_numba.cli", "run", str(path), "-o", str(out), "--workers=2"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True)
    while process.poll() is None and not list(out.glob("shards/*.shard")):
        time.sleep(0.001)
    time.sleep(np.random.default_rng().uniform(0, 0.2))
    os.killpg(process.pid, signal.SIGINT)
    said = [line for line in process.communicate()[0].decode().splitlines() if not line.startswith("blocks ")]
    assert process.returncode == 130
    assert said == ["gfmd: interrupted; finished work is kept, the same command resumes"]
    left = list(out.glob("shards/*"))
    assert left
    assert all(shards.read(shard) is not None for shard in left if shard.suffix == ".shard")
    assert not [p for p in psutil.process_iter() if p.status() != psutil.STATUS_ZOMBIE and session(p) == process.pid]


def session(process: psutil.Process) -> int | None:
    try:
        return os.getsid(process.pid)
    except ProcessLookupError:
        return None


def test_an_existing_scheduler_changes_no_number(finished, tmp_path):
    with LocalCluster(n_workers=1, threads_per_worker=1, processes=False, dashboard_address="127.0.0.1:0") as cluster:
        path, failures = run_campaign(campaign(tmp_path), tmp_path / "out", Workers(address=cluster.scheduler_address))
    assert failures == {}
    xr.testing.assert_identical(numbers(gfmd_numba.open_campaign(path)), numbers(finished))


@pytest.mark.parametrize("address", ["nowhere://127.0.0.1:1", "tcp://127.0.0.1:x"])
def test_a_wrong_scheduler_is_named(tmp_path, address):
    with pytest.raises(InputError, match=f"--scheduler: given {address} .*; allowed: the address of a running dask"):
        run_campaign(campaign(tmp_path), tmp_path / "out", Workers(address=address))
    run_campaign(campaign(tmp_path), tmp_path / "out", Workers(0))  # a client that failed is not in the way


def test_a_damaged_shard_is_computed_again(finished, tmp_path):
    path, out = campaign(tmp_path), tmp_path / "out"
    gfmd_numba.run(path, out, 0)
    first, second, third, *_ = sorted(out.glob("shards/*.shard"))
    content = first.read_bytes()
    first.write_bytes(content[:-10])
    altered = bytearray(second.read_bytes())
    altered[len(altered) // 2] ^= 1
    second.write_bytes(altered)
    third.write_bytes(b"")
    xr.testing.assert_identical(numbers(gfmd_numba.run(path, out, 0)), numbers(finished))
    assert first.read_bytes()[:13] == content[:13]
    assert all(shards.read(shard) is not None for shard in (first, second, third))


def test_a_crashed_task_is_named_and_leaves_the_others_alone(finished, tmp_path, monkeypatch):
    planned = plan(campaign(tmp_path))
    bad = next(planned.blocks)
    solve = execution.solve

    def fails_once(problem, realisations):
        if problem.identity == bad.problem.identity:
            raise FloatingPointError("boom")
        return solve(problem, realisations)

    monkeypatch.setattr(execution, "solve", fails_once)
    path, failures = run_campaign(tmp_path / "campaign.yaml", tmp_path / "out", Workers(0))
    assert failures == {bad.name: Failure("crashed", "FloatingPointError: boom")}
    result = gfmd_numba.open_campaign(path)
    crashed = result["case_id"] == bad.problem.identity
    assert (result["status"].where(crashed, drop=True) == 5).all()
    assert result["kappa"].where(crashed, drop=True).isnull().all()
    xr.testing.assert_identical(
        numbers(result).isel(case=~crashed.values), numbers(finished).isel(case=~crashed.values)
    )


def test_more_realisations_keep_the_finished_ones(tmp_path, monkeypatch):
    monkeypatch.setattr("gfmd_numba.campaign.cases._BLOCK_SAMPLES", 128 * 3)
    out = tmp_path / "out"
    few = gfmd_numba.run(campaign(tmp_path), out, 0)
    stamps = {shard: shard.stat().st_mtime_ns for shard in out.glob("shards/*.shard")}
    more = gfmd_numba.run(campaign(tmp_path, **{"realisations: 6": "realisations: 9"}), out, 0)
    same = numbers(more).isel(realisation=slice(6)).drop_vars("realisations")
    xr.testing.assert_identical(same, numbers(few).drop_vars("realisations"))
    assert stamps.items() <= {shard: shard.stat().st_mtime_ns for shard in out.glob("shards/*.shard")}.items()


def test_output_directory_of_another_campaign_is_refused(tmp_path):
    out = tmp_path / "out"
    gfmd_numba.run(campaign(tmp_path), out, 0)
    with pytest.raises(InputError, match=r"out: given the output directory of campaign 'small'; allowed: .*'other'"):
        gfmd_numba.run(campaign(tmp_path, **{"name: small": "name: other"}), out, 0)


def test_results_are_found_by_name_among_other_files(finished, tmp_path):
    out = tmp_path / "out"
    gfmd_numba.run(campaign(tmp_path), out)
    (out / "another.nc").touch()
    xr.testing.assert_identical(numbers(gfmd_numba.open_campaign(out)), numbers(finished))
    (out / "campaign.yaml").unlink()
    with pytest.raises(InputError, match="given a directory with 2 netCDF files"):
        gfmd_numba.open_campaign(out)
    with pytest.raises(InputError, match=r"another.nc: given a file that is not netCDF"):
        gfmd_numba.open_campaign(out / "another.nc")
    with pytest.raises(InputError, match=r"third.nc: given a path that cannot be read \(No such"):
        gfmd_numba.open_campaign(out / "third.nc")


def test_a_script_without_a_main_guard_may_run_a_campaign(tmp_path):
    campaign(tmp_path)
    script = tmp_path / "script.py"
    script.write_text("import gfmd_numba\ngfmd_numba.run('campaign.yaml', 'out')\n")
    subprocess.run([sys.executable, script], cwd=tmp_path, check=True)
    assert (tmp_path / "out" / "small.nc").exists()


def test_leftovers_of_a_killed_run_do_not_block_it(finished, tmp_path):
    path, out = campaign(tmp_path), tmp_path / "out"
    out.mkdir(parents=True)
    leftovers = [out / f"small.nc.{32 * '0'}.tmp", out / f".{32 * 'a'}.tmp"]
    for leftover in (*leftovers, out / ".lock"):
        leftover.touch()
    with claimed(out, "small", path.read_text()):
        assert not any(leftover.exists() for leftover in leftovers)
    (out / "shards").mkdir()
    leftovers += [out / "shards" / f"a.shard.{32 * '1'}.tmp", out / "shards" / "a.late.tmp"]
    for leftover in leftovers:
        leftover.touch()
    xr.testing.assert_identical(numbers(gfmd_numba.run(path, out)), numbers(finished))
    assert not any(leftover.exists() for leftover in leftovers)


@pytest.mark.parametrize("text", ["", "name: [", "- list"])
def test_a_damaged_label_says_what_to_do(tmp_path, text):
    path, out = campaign(tmp_path), tmp_path / "out"
    gfmd_numba.run(path, out)
    (out / "campaign.yaml").write_text(text)
    with pytest.raises(InputError, match=r"out/campaign.yaml: given a copy .* that somebody has changed.*move it away"):
        gfmd_numba.run(path, out)
    (out / "campaign.yaml").unlink()
    gfmd_numba.run(path, out)
    assert (out / "campaign.yaml").read_text() == path.read_text()


def test_one_run_at_a_time(tmp_path):
    path, out = campaign(tmp_path), tmp_path / "out"
    with (
        claimed(out, "small", "name: small"),
        pytest.raises(InputError, match=r"out: given an output directory in which another run is at work"),
    ):
        gfmd_numba.run(path, out)
    gfmd_numba.run(path, out)


def test_files_follow_the_umask(tmp_path):
    before = os.umask(0o027)
    try:
        replace(tmp_path / "file", b"")
    finally:
        os.umask(before)
    assert (tmp_path / "file").stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize("content", ["file", "folder"])
def test_output_path_that_holds_something_else_is_refused(tmp_path, content):
    out = tmp_path / "out"
    if content == "folder":
        out.mkdir()
        (out / "thesis.tex").write_text("precious")
    else:
        out.write_text("precious")
    with pytest.raises(InputError, match="holds something else"):
        gfmd_numba.run(campaign(tmp_path), out, 0)


def test_shards_are_all_or_nothing(tmp_path):
    path = tmp_path / "a.shard"
    assert shards.read(path) is None
    arrays = {"kappa": np.array([1.0, np.nan]), "status": np.array([0, 1], dtype=np.int8)}
    shards.write(path, arrays)
    stored = shards.read(path)
    assert stored is not None
    for name, values in arrays.items():
        np.testing.assert_array_equal(stored[name], values)
        assert stored[name].dtype == values.dtype
    content = path.read_bytes()
    (tmp_path / "b.shard").write_bytes(content)
    assert shards.read(tmp_path / "b.shard") is None
    (tmp_path / "b.shard").unlink()
    for cut in range(0, len(content), 7):
        path.write_bytes(content[:cut])
        assert shards.read(path) is None
    assert list(tmp_path.iterdir()) == [path]


def test_each_level_may_have_realisations_of_its_own_and_none(finished, tmp_path):
    text = SMALL.replace("realisations: 6", "realisations: {reference: 6, eps_c: [3, 0, 2], eps_f: [0, 0, 4]}")
    result = gfmd_numba.run(campaign(tmp_path, text), tmp_path / "out")
    assert result["limit"].values.tolist() == 2 * ["reference", "eps_c", "eps_c", "eps_f"]
    np.testing.assert_array_equal(result["realisations"], 2 * [6, 3, 2, 4])


def test_a_limit_may_have_realisations_of_its_own(finished, tmp_path):
    text = SMALL.replace("realisations: 6", "realisations: {reference: 6, eps_f: 2}")
    result = gfmd_numba.run(campaign(tmp_path, text), tmp_path / "out")
    counts = np.where(result["limit"] == "eps_f", 2, 6)
    np.testing.assert_array_equal(result["realisations"], counts)
    np.testing.assert_array_equal((result["status"] == 0).sum("realisation"), counts)
    np.testing.assert_array_equal((result["status"] == 7).sum("realisation"), 6 - counts)
    same = result["kappa"].notnull()
    np.testing.assert_array_equal(result["kappa"].where(same), finished["kappa"].where(same))
