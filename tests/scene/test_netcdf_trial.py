"""Files on which the HDF5 library never ends: another process finds that out, in bounded time."""

import base64
import os
import subprocess
import sys
import zlib

import numpy as np
import pytest
import xarray as xr

from gfmd_numba.campaign.results import read_results
from gfmd_numba.roughness.surface_files import load_netcdf
from gfmd_numba.scene import InputError, regular_file

# a profile, some bytes of which were altered: the library reads its attribute for ever (HDF5 2.0)
ENDLESS = """
eNrr9HBx4+WS4mLi4GCAgf9QwKAI4RtAxfO9Zxzz93AJYuLZwqQEFmFmQdOCDriYGBhB8mwiIJIRppyBseo9lAWTYYTJVBozocowwWQqypmhMqIQGSiXge
nwyt1QowUEQGQ41DOlDEjg9LQTdWDn81owMoLNZmJkZISZDqOZRUAuFlSUZ4CYqMAgzsEgXg9ksYL9wswFsWIhG0T9JKg+URmwBmCI4AoLHm2w+QxsDBwg
pc4+jsHBDMIgN0Otd/H0dfUL9vT3iw92dvRxZeCJAnoSqIEVosHP0dcVrN4Bqj4kI7NYAYgSFfJSS5xd3BRSMnNT84oz8/MUkkpLFPLySxBSZYlFmYlJOa
l6CjBgxAByEBPQfD4GHpD58X6pJckpaSYumbmZKQwCwCCEhQATPAz/3NwVixmGsGhlITEMjdmHeBiakBaGkDQ+13RTCfXC8OgIC0NIWpyaGm8DCcNbjIwm
4DBkRuRl9LDEJQ4NYwV7Bkh54cBgws1g8h9YrLDygcNYC1Eo/qjnEALrYQQ6BFogER3inpAQFwF6UAThQef8/KKUzLzEktRiVG8CkwOsaGNGKsAYoV7hcY
HEBzfQMJBxbpk5OWGJOaWpWL0CMo0R1cVwL/GoQ0IemhRK8zJLisFRywO1KiWxslihODMvOVXBkCcH5BxmBn5gQhFBTiU+nsEhDJLQBCQOxBzQNI3uCbD1
AggxZD4LGp8ViJ0ebW72d/bwhoU8LDxhsYJwkQHIRUGubq5Brn7OrhAXmTFBDEtJLEksTi1BOA2ePBk4BBhQgx09oHazoIQYg5WIxj9sLhKgu4tgfJ1z3V
WDw0WwXPbro0YvyEWwfMGIO1+4QlICHyT5xfs5BxTlF6QWlWSmQpKhEtTYstQikFtsjXTywFnH1kTP0EDPUCcjJc3U1kjPSM/A86HuD4ZRMApGwSgYBaNg
FBAF3J39fdCbZQzQNgAIvEdrMpMKVvCPhvEoGAWjYBSMglEwCkbBKBgFo2AUjIJRMFhA9n5ZvaOTvO13Z3yO2nva155frmexcb2S/fF1h363nPHYX8EtbM
yV479/mrJD7gV/o/0nT3n9Mm53tf+6mSdktWmAvXdJd5Yxk7V9yo1pBVMuO+6f/P6Dn3NSwP579+wmSk513G8aO3Oddae1/YT0zp4XVgH2DjsvNzD5u9p7
WUSGmN8z2j/Xdl7KyQb//UHtglf3zPbYf2dNWy73UmX7uyGR/8Ne+do7Pm70Tcjytmdg6lnPNOHRvvtL2Krn7PLe37avcGfXGt/9tkcTHvyJUNzvvXDK2b
N/POz5VZ+vWhnmb7/gxOvWz2ce/l86X/nVt32u+1usLz+QMgjYv6dTvHJBldV+AOoVHe4=
"""
ASLEEP = "import resource; resource.setrlimit(resource.RLIMIT_CPU, (1, 1))\nwhile True: pass"


@pytest.fixture
def hasty(monkeypatch):
    monkeypatch.setattr(regular_file, "START", 2)


@pytest.mark.long
def test_a_file_without_end_is_refused(tmp_path, hasty):
    (tmp_path / "p.nc").write_bytes(zlib.decompress(base64.b64decode(ENDLESS)))
    with pytest.raises(ValueError, match="no netCDF file, or a damaged one"):
        load_netcdf(tmp_path / "p.nc")
    with pytest.raises(InputError, match="a file that is not netCDF or is damaged"):
        read_results(tmp_path / "p.nc")


@pytest.mark.parametrize("script", [pytest.param(ASLEEP, marks=pytest.mark.long), "import os; os.abort()"])
def test_a_reading_that_fails_is_a_damaged_file(tmp_path, monkeypatch, hasty, script):
    xr.Dataset({"height": ("x", np.arange(9.0))}).to_netcdf(tmp_path / "p.nc")
    assert regular_file.can_be_read(tmp_path / "p.nc", 10**9)
    monkeypatch.setattr(regular_file, "_READ", script)
    assert not regular_file.can_be_read(tmp_path / "p.nc", 10**9)


def test_a_trial_imports_nothing_of_the_folder_it_is_in(tmp_path, monkeypatch):
    xr.Dataset({"height": ("x", np.arange(9.0))}).to_netcdf(tmp_path / "p.nc")
    (tmp_path / "netCDF4.py").write_text(f"open({os.fspath(tmp_path / 'ran')!r}, 'w'); raise SystemExit(1)")
    monkeypatch.chdir(tmp_path)
    assert regular_file.can_be_read("p.nc", 10**9)
    assert not (tmp_path / "ran").exists()


@pytest.mark.long
def test_a_folder_that_the_locale_cannot_write_is_told(tmp_path):
    folder = tmp_path / "mäß"
    folder.mkdir()
    (folder / "p.nc").write_bytes(b"\x89HDF")
    code = "import sys; from pathlib import Path; from gfmd_numba.roughness.surface_files import load_netcdf\n"
    code += "try: load_netcdf(Path(sys.argv[1]))\nexcept ValueError as error: print(error)"
    plain = {**os.environ, "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    done = subprocess.run([sys.executable, "-c", code, folder / "p.nc"], env=plain, capture_output=True, text=True)
    assert "a path with letters that the locale does not know" in done.stdout
