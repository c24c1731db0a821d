"""More or fewer realisations of a campaign use what is finished, and change no number."""

import shutil

import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

import gfmd_numba
from gfmd_numba.campaign import cases, execution
from gfmd_numba.campaign.cases import blocks
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.status import progress, verify
from support.campaigns import campaign, numbers
from support.command_line import gfmd


def realisations(folder, number):
    """A campaign of two cases."""
    return campaign(folder, **{"limits:": "#", "realisations: 6": f"realisations: {number}"})


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """Campaigns that were run afresh with 4 and with 6 realisations."""
    folder = tmp_path_factory.mktemp("ran")
    for number in (4, 6):
        gfmd_numba.run(realisations(folder, number), folder / str(number))
    return folder


@pytest.fixture
def begun(ran, tmp_path):
    """A run of 4 realisations to go on with."""
    return shutil.copytree(ran / "4", tmp_path / "out")


@pytest.fixture
def solved(monkeypatch):
    """Realisations that have been solved, in order."""
    counted = []
    solve = execution.measured

    def counting(problem, chosen):
        if problem.surface.nodes > 16:  # kernels are compiled on less
            counted.append((chosen.start, chosen.stop))
        return solve(problem, chosen)

    monkeypatch.setattr(execution, "measured", counting)
    return counted


def test_more_realisations_solve_only_the_new_ones(tmp_path, ran, begun, solved):
    stamps = {shard: shard.stat().st_mtime_ns for shard in begun.glob("shards/*.shard")}
    more, fresh = gfmd_numba.run(realisations(tmp_path, 6), begun), gfmd_numba.open_campaign(ran / "6")
    assert set(solved) == {(4, 6)}
    assert len(solved) == 2
    assert more.attrs["content_sha256"] == fresh.attrs["content_sha256"]
    xr.testing.assert_identical(numbers(more), numbers(fresh))
    found, verdict = progress(begun), verify(begun)
    assert (found.done, found.blocks) == (4, 4)
    assert (verdict.sound, verdict.damaged, verdict.missing, verdict.foreign) == (4, [], 0, [])
    assert stamps.items() <= {shard: shard.stat().st_mtime_ns for shard in begun.glob("shards/*.shard")}.items()


@pytest.mark.long
def test_fewer_realisations_solve_nothing(tmp_path, ran, begun, solved):
    out = shutil.copytree(ran / "6", tmp_path / "six")
    fewer = gfmd_numba.run(realisations(tmp_path, 4), out)
    assert solved == []
    assert fewer.sizes["realisation"] == 4
    assert fewer.attrs["content_sha256"] == gfmd_numba.open_campaign(ran / "4").attrs["content_sha256"]
    gfmd_numba.run(realisations(tmp_path, 3), begun)
    verdict = verify(begun)
    assert (verdict.sound, verdict.missing, verdict.foreign) == (2, 0, [])


@pytest.mark.long
def test_a_surplus_shard_is_not_foreign(tmp_path, begun):
    """A damaged one is not used, so nothing computes it again."""
    gfmd_numba.run(realisations(tmp_path, 6), begun)
    gfmd_numba.run(realisations(tmp_path, 4), begun)
    assert (verify(begun).sound, verify(begun).foreign) == (4, [])
    surplus = next(begun.glob("shards/*-000004-000006.shard"))
    surplus.write_bytes(b"")
    assert (verify(begun).sound, verify(begun).damaged, verify(begun).foreign) == (3, [], [surplus.stem])


@pytest.mark.long
def test_a_damaged_old_shard_is_computed_again(tmp_path, ran, begun):
    next(begun.glob("shards/*.shard")).write_bytes(b"")
    more = gfmd_numba.run(realisations(tmp_path, 6), begun)
    assert more.attrs["content_sha256"] == gfmd_numba.open_campaign(ran / "6").attrs["content_sha256"]


@pytest.mark.usefixtures("undrawn")
def test_a_part_of_a_run_with_more_realisations_is_collected(tmp_path, begun):
    done = gfmd("run", realisations(tmp_path, 6), "-o", begun, "--workers=0", "--only=hurst=0.3")
    assert done.exit_code == 0, done.output
    assert "2 of the 12 simulations of the whole campaign have not run yet" in done.output


ranges = st.tuples(st.integers(0, 30), st.integers(1, 8)).map(lambda r: (r[0], r[0] + r[1]))


@pytest.fixture(scope="module")
def problem(tmp_path_factory):
    return plan(campaign(tmp_path_factory.mktemp("problem"))).problems[0]


@pytest.mark.long
@settings(max_examples=100, deadline=None)
@given(data=st.data(), held=st.lists(ranges, max_size=6), wanted=st.integers(1, 30), size=st.integers(1, 8))
def test_blocks_cover_what_is_wanted_and_stay_the_same_while_they_get_finished(problem, data, held, wanted, size):
    before, cases._BLOCK_SAMPLES = cases._BLOCK_SAMPLES, size * problem.surface.nodes
    try:
        split = [(block.first, block.stop) for block in blocks(problem, wanted, held)]
        finished = data.draw(st.sets(st.sampled_from(split)))
        again = [(block.first, block.stop) for block in blocks(problem, wanted, [*held, *finished])]
    finally:
        cases._BLOCK_SAMPLES = before
    assert split == again
    covered = [r for first, stop in split for r in range(first, stop)]
    assert covered == list(range(split[-1][1]))
    assert wanted <= len(covered)
    assert all(stop - first <= size for first, stop in split)
    assert all((first, stop) in held or stop <= wanted for first, stop in split)
