"""Results, shards and profiles that are damaged: refused, or the same as before."""

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from gfmd_numba.campaign.results import read_results
from gfmd_numba.campaign.run import run
from gfmd_numba.campaign.shards import Finished
from gfmd_numba.campaign.workers import Workers
from gfmd_numba.roughness.measurements import measurement
from gfmd_numba.roughness.surface_files import read_content
from support.campaigns import TINY, campaign
from support.faulty_files import refusal
from support.forked_trial import tried_in_a_fork  # noqa: F401


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    return run(campaign(folder, TINY), folder / "out", Workers(0))[0]


def damaged(content, pick):
    """Content that lost its end, or some bytes of which were altered, zeroed or repeated."""
    content, at = bytearray(content), pick.randrange(len(content))
    kind = pick.randrange(4)
    if kind == 0:
        return bytes(content[:at])
    if kind == 1:
        content[at] ^= 1 << pick.randrange(8)
    elif kind == 2:
        stop = min(at + pick.randrange(1, 5000), len(content))
        content[at:stop] = bytes(stop - at)
    else:
        content[at:at] = content[at : at + pick.randrange(1, 500)]
    return bytes(content)


@pytest.mark.parametrize("examples", [4, pytest.param(25, marks=pytest.mark.long)])
def test_a_damaged_file_of_results_is_refused_or_says_the_same(results, examples):
    """The HDF5 library finds wrong numbers in such files, internal errors, or no end."""
    sound, path = read_results(results), results.with_name("damaged.nc")

    @given(pick=st.randoms(use_true_random=False))
    @settings(derandomize=True, deadline=None, max_examples=examples)
    def check(pick):
        path.unlink(missing_ok=True)
        path.write_bytes(damaged(results.read_bytes(), pick))
        said = refusal(read_results, path)
        if said is None:
            xr.testing.assert_identical(read_results(path), sound)
        else:
            assert "not netCDF or is damaged" in said

    check()
    path.unlink()


@pytest.mark.long
def test_results_with_a_seal_are_plain_netcdf(results, tmp_path):
    with xr.open_dataset(results) as plain:
        xr.testing.assert_identical(plain.load(), read_results(results))
        plain.to_netcdf(tmp_path / "written by another.nc")
    xr.testing.assert_identical(read_results(tmp_path / "written by another.nc"), read_results(results))


def test_a_damaged_measured_profile_is_no_traceback(tmp_path):
    """Bytes that make the netCDF library fail with an error of its own kind."""
    xr.Dataset({"height": ("x", np.arange(5000.0))}).to_netcdf(tmp_path / "p.nc", encoding={"height": {"zlib": True}})
    content = bytearray((tmp_path / "p.nc").read_bytes())
    content[len(content) // 2 : len(content) // 2 + 2000] = bytes(2000)
    (tmp_path / "q.nc").write_bytes(content)
    with pytest.raises(ValueError, match="no netCDF file, or a damaged one"):
        measurement(read_content(tmp_path / "q.nc"))


def test_a_damaged_shard_is_none(results, tmp_path):
    shard = next(results.parent.glob("shards/*.shard"))
    (tmp_path / "shards").mkdir()
    copy = tmp_path / "shards" / shard.name

    @given(pick=st.randoms(use_true_random=False))
    @settings(derandomize=True, deadline=None, max_examples=60)
    def check(pick):
        altered = damaged(shard.read_bytes(), pick)
        copy.write_bytes(altered)
        assert (Finished(tmp_path).read(shard.stem) is None) == (altered != shard.read_bytes())

    check()
