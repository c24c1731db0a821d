"""Workers that together need more memory than is free: objected to before anything is solved."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from gfmd_numba.campaign import execution
from gfmd_numba.campaign.cases import block_bytes
from gfmd_numba.campaign.plan import check_memory, plan
from gfmd_numba.scene import InputError
from support.campaigns import MAPS, campaign
from support.command_line import gfmd

LARGE = MAPS + "reference: {eps_c: 1/4, eps_f: 1/256, eps_t: 1/4}\n"  # 8192^2: 12.9 GB a worker

CAMPAIGN_OF_PATHS = {
    "name": "paths",
    "seed": 1,
    "realisations": 5,
    "scene": {
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 1.0},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
        "interface": {"hard_wall": {}, "friction": {"coefficient": 0.3}},
        "loading": {"reduced_pressure": 0.02},
    },
    "reference": {"eps_c": 1 / 8, "eps_f": 1 / 8, "eps_t": 1 / 2},
    "path": [{"sliding": 1e-4}, {"sliding": 0.0}],
}


@pytest.fixture
def free(monkeypatch):
    """Sets what of 64 GB is free."""

    def of(available):
        memory = SimpleNamespace(total=64_000_000_000, available=int(available))
        monkeypatch.setattr("psutil.virtual_memory", lambda: memory)

    return of


@pytest.mark.parametrize("command", ["plan", "run"])
def test_two_workers_beyond_the_free_memory_are_objected_to(tmp_path, free, monkeypatch, command):
    monkeypatch.setattr(execution, "measured", lambda *_: pytest.fail("begun"))
    monkeypatch.chdir(tmp_path)
    free(20e9)
    said = gfmd(command, campaign(tmp_path, LARGE), "--workers=2")
    assert said.exit_code == 2
    for part in ("--workers: you gave 2", "12.9 GB", "25.8 GB in all", "20.0 GB of memory are free", "at most 1"):
        assert part in said.output


def test_what_is_proposed_is_accepted(tmp_path, free):
    blocks = list(plan(campaign(tmp_path, LARGE)).blocks)
    free(39e9)
    with pytest.raises(InputError, match="at most 2, or a coarser grid"):
        check_memory(blocks, 3)
    check_memory(blocks, 2)
    free(13.2e9)
    with pytest.raises(InputError, match="gfmd allows 0, this process alone"):
        check_memory(blocks, 1)
    check_memory(blocks, 0)
    free(10e9)
    with pytest.raises(InputError, match=r"you gave 0, .* a machine with 13.1 GB free, or a coarser grid"):
        check_memory(blocks, 0)


def test_a_block_of_paths_takes_the_memory_of_one_realisation():
    """Realisations are followed one after another."""
    few = plan(CAMPAIGN_OF_PATHS).problems[0]
    assert block_bytes(few, 5) == block_bytes(few, 1)
    without = replace(few, path=())
    assert block_bytes(without, 5) == 5 * block_bytes(without, 1) == 5 * block_bytes(few, 1)


def test_the_size_of_results_counts_what_is_recorded_along_a_path():
    planned = plan(CAMPAIGN_OF_PATHS)
    alone = plan({name: value for name, value in CAMPAIGN_OF_PATHS.items() if name != "path"})
    assert planned.file_bytes > 3 * alone.file_bytes  # three loads, and more of each


@pytest.mark.long
def test_nothing_left_to_do_needs_no_memory(tmp_path, free):
    path = campaign(tmp_path)
    assert gfmd("run", path, "-o", tmp_path / "out", "--workers=0").exit_code == 0
    free(1e6)
    assert gfmd("run", path, "-o", tmp_path / "out", "--workers=2").exit_code == 0
