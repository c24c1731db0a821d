"""Datasets written without a cluster are those that xarray writes."""

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.storage.atomic_file import write_dataset
from support.command_line import python
from support.scenes import SCENE


def written(dataset, file):
    write_dataset(file, dataset)
    return file


def assert_the_same(file, expected):
    with xr.open_dataset(file) as one, xr.open_dataset(expected) as other:
        xr.testing.assert_identical(one, other)
        for name in one.variables:
            ours, theirs = ({k: v for k, v in each[name].encoding.items() if k != "source"} for each in (one, other))
            np.testing.assert_equal(ours, theirs)


def test_a_contact_is_written_as_xarray_writes_it(tmp_path):
    (tmp_path / "scene.yaml").write_text(SCENE)
    dataset = gfmd_numba.solve(tmp_path / "scene.yaml")
    dataset.to_netcdf(tmp_path / "expected.nc", engine="netcdf4")
    assert_the_same(written(dataset, tmp_path / "contact.nc"), tmp_path / "expected.nc")


def test_text_flags_and_gaps_are_written_as_xarray_writes_them(tmp_path):
    dataset = xr.Dataset(
        {"kappa": (("case", "realisation"), [[1.0, np.nan], [2.0, 3.0]]), "status": ("case", np.int8([0, 2]))},
        coords={"case_id": ("case", ["a", "bc"]), "reference": ("case", [True, False]), "realisation": [0, 1]},
        attrs={"title": "κ", "seed": 7, "campaign": "name: x\nseed: 7\n"},
    )
    dataset["status"].attrs = {"flag_values": np.int8([0, 2]), "flag_meanings": "ok crashed"}
    dataset.to_netcdf(tmp_path / "expected.nc", engine="netcdf4", encoding={"case_id": {"dtype": "S1"}})
    assert_the_same(written(dataset, tmp_path / "campaign.nc"), tmp_path / "expected.nc")


@pytest.mark.long
def test_a_file_with_texts_can_be_opened_again_before_it_is_closed(tmp_path):
    """With strings of variable length HDF5 reads memory that it has freed, and the process ends (HDF5 issue 5359)."""
    text = xr.Dataset({"case": ("x", ["a", "µ", ""]), "none": ("y", ["", ""]), "one": ((), "length: 1 mm\n")})
    file = written(text, tmp_path / "texts.nc")
    with xr.open_dataset(file) as read:
        xr.testing.assert_identical(read, text)
    open_often = "import netCDF4, sys; all(netCDF4.Dataset(sys.argv[1]) for _ in range(300))"
    python(open_often, file)


_THREADS = """
import sys
from pathlib import Path
from threading import Thread

import xarray as xr

from gfmd_numba.storage.atomic_file import write_dataset
from gfmd_numba.storage.netcdf_file import content_of, read_dataset

numbers = xr.Dataset({f"v{i}": ("x", [1.0] * 100, {"units": "1"}) for i in range(10)})
write_dataset(Path(sys.argv[1]), numbers)
failed = []

def work():
    try:
        for _ in range(4):
            content_of(numbers)
            assert read_dataset(sys.argv[1], 1e9).identical(numbers)
    except BaseException as error:
        failed.append(error)

threads = [Thread(target=work) for _ in range(4)]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
assert not failed, failed
"""


@pytest.mark.long
def test_threads_write_and_read_at_once(tmp_path):
    """The HDF5 library ends the process in a segmentation fault where two threads are in it."""
    python(_THREADS, tmp_path / "numbers.nc")
