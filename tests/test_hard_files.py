"""Hard files: campaigns and scenes mutated at random, damaged results and shards, no home, clocks set wrong."""

import os
import re
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import TypeAdapter
from test_campaign import campaign

from gfmd_numba.campaign import shards
from gfmd_numba.campaign.execution import Workers
from gfmd_numba.campaign.file import Values, load_campaign
from gfmd_numba.campaign.results import read_results
from gfmd_numba.campaign.run import run
from gfmd_numba.campaign.status import progress
from gfmd_numba.roughness.measurements import read_surface
from gfmd_numba.scene import InputError, load_scene
from gfmd_numba.scene.surface_file import load_surface

CAMPAIGN = (Path(__file__).parents[1] / "campaigns" / "quickstart.yaml").read_text(encoding="utf-8")
SCENE = """
length: 1e-4
body: {youngs_modulus: 70e9, poissons_ratio: 0.33, aspect_ratio: 1}
roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
interface: {hard_wall: {}, exponential: {work_of_adhesion: 0.05, range: 2e-6}, friction: {coefficient: 0.3}}
loading: {displacement: 2e-7}
boundary: {normal_traction: 3.0}
discretisation: {eps_c: 1/4, eps_f: 1/16, eps_t: 1/2}
numerics: {solver: auto, residual: 1e-8}
path: [{displacement: 3e-7}, {sliding: 1e-7}, {displacement: 1e-7}]
"""
TINY = """
name: tiny
seed: 1
realisations: 2
scene:
  body: {poissons_ratio: 0.33}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.05}
reference: {eps_c: 1/2, eps_f: 1/4, eps_t: 1}
"""
SURFACE = """
surface:
  method: psd
  model: exponential
  hurst: 0.8
  correlation_length: 4e-6
  mound_separation: 9e-6
  cut_on: 1e-6
  rms_height: 3e-7
  points: 512
length: 1e-4
"""
KINDS = {"campaign": (load_campaign, CAMPAIGN), "scene": (load_scene, SCENE), "surface": (load_surface, SURFACE)}
WORDS = """
NaN .nan .inf -.inf inf 1e400 -1e400 1e-400 0 -0.0 1/0 0/0 1e308 5e-324 '0.5' "1" true no ~ [] {} [[1]] {a:1} &a *a
<<:{} !!python/object:os.system !!int ../../etc/passwd /dev/null 名前 \u202e 0x10 0o17 1_000 12:30:00 2001-01-01 - ? :
# --- ... | > ` @ ' " \t 1e3.5 1/1e3 +.5 1. 0.1e-1000000000 None null [.inf] [0.5,0.5] {method:psd} {method:[psd]}
"""
ODD = WORDS.split()
ODD += ["1" * 400, "9" * 299 + "/" + "9" * 299, "é" * 50, "[" * 200, "{a: " * 200, "1e-3 " * 1000]


def mutated(text, pick):
    """Text with one to five words, characters or lines replaced, repeated, moved or lost."""
    for _ in range(pick.choice([1, 1, 1, 2, 5])):
        words, lines = list(re.finditer(r"[^\s{}\[\],:]+", text)), text.splitlines(keepends=True)
        if not words:
            return text
        word, other = pick.choice(words), pick.choice(words)
        line, at = pick.randrange(len(lines)), pick.randrange(len(text))
        kind = pick.randrange(7)
        if kind == 0:
            text = text[: word.start()] + pick.choice(ODD) + text[word.end() :]
        elif kind == 1:
            text = text[: word.start()] + other.group() + text[word.end() :]
        elif kind == 2:
            text = text[:at] + pick.choice("{}[],:#&*!|>'\"%@`\t\n -?\x7f\u2028\ufeff\xa0") + text[at:]
        elif kind == 3:
            text = text[:at] + text[at + pick.randrange(20) :]
        elif kind == 4:
            text = "".join([*lines[:line], lines[line], *lines[line:]])
        elif kind == 5:
            text = "".join([*lines[:line], " " * pick.randrange(6) + lines[line].lstrip(), *lines[line + 1 :]])
        else:
            text = text[:at]
    return text


def assert_loads_or_says_why(folder, kind, text):
    load, _ = KINDS[kind]
    path = folder / "fuzzed.yaml"
    path.write_text(text, encoding="utf-8")
    begun = time.perf_counter()
    said = refusal(load, path)
    assert time.perf_counter() - begun < 10.0
    if said is not None:
        assert re.match(re.escape(str(path)) + r":(\d+:\d+:)? .*given .*; allowed: ", said, re.DOTALL)
        assert len(said) < 20_000


def refusal(load, path):
    """What an InputError says, None without one; any other exception is a failure."""
    try:
        load(path)
    except InputError as error:
        return str(error)
    return None


@pytest.mark.parametrize("kind", KINDS)
def test_what_the_mutants_were_made_from_is_good(tmp_path, kind):
    load, text = KINDS[kind]
    (tmp_path / "good.yaml").write_text(text, encoding="utf-8")
    load(tmp_path / "good.yaml")


@pytest.mark.parametrize("kind", KINDS)
def test_a_mutant_is_read_or_refused_with_a_reason(tmp_path_factory, kind):
    folder = tmp_path_factory.mktemp(kind)

    @given(pick=st.randoms(use_true_random=False))
    @settings(derandomize=True, deadline=None, max_examples=150)
    def mutants(pick):
        assert_loads_or_says_why(folder, kind, mutated(KINDS[kind][1], pick))

    mutants()


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_many_mutants_are_read_or_refused_with_a_reason(tmp_path_factory, kind):
    folder = tmp_path_factory.mktemp(kind)

    @given(pick=st.randoms(use_true_random=True))
    @settings(deadline=None, max_examples=5000)
    def mutants(pick):
        assert_loads_or_says_why(folder, kind, mutated(KINDS[kind][1], pick))

    mutants()


@given(text=st.text(max_size=200))
@settings(derandomize=True, deadline=None, max_examples=150)
def test_any_text_is_refused_with_a_reason(tmp_path_factory, text):
    assert_loads_or_says_why(tmp_path_factory.getbasetemp(), "campaign", text.encode("utf-8", "ignore").decode())


def test_a_long_list_is_checked_in_time_of_its_length():
    """Each of 200 000 values was compared with all before it: half an hour."""
    values = tuple(float(i) for i in range(200_000))
    begun = time.perf_counter()
    assert TypeAdapter(Values[float]).validate_python(values) == values
    assert time.perf_counter() - begun < 10.0


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    return run(campaign(folder), folder / "out", Workers(0))[0]


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


def test_a_damaged_file_of_results_is_refused_or_says_the_same(results):
    """The HDF5 library finds wrong numbers in such files, internal errors, or no end."""
    sound, path = read_results(results), results.with_name("damaged.nc")

    @given(pick=st.randoms(use_true_random=False))
    @settings(derandomize=True, deadline=None, max_examples=300)
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
        read_surface(tmp_path / "q.nc")


def test_a_damaged_shard_is_none(results, tmp_path):
    shard = next(results.parent.glob("shards/*.shard"))
    copy = tmp_path / shard.name

    @given(pick=st.randoms(use_true_random=False))
    @settings(derandomize=True, deadline=None, max_examples=300)
    def check(pick):
        altered = damaged(shard.read_bytes(), pick)
        copy.write_bytes(altered)
        assert (shards.read(copy) is None) == (altered != shard.read_bytes())

    check()


@pytest.mark.parametrize("shift", [-1e9, 1e9])
def test_a_clock_set_wrong_is_no_failure(tmp_path, shift):
    """Files that seem to come from another decade; work left to do has then no honest end in sight."""
    path, out = campaign(tmp_path), tmp_path / "out"
    run(path, out, Workers(0))
    next(out.glob("shards/*.shard")).unlink()
    for file in (out / ".gfmd-campaign", *out.glob("shards/*.shard")):
        os.utime(file, (time.time() + shift,) * 2)
    found = progress(out)
    assert found.done == found.blocks - 1
    assert found.seconds_left is None or found.seconds_left >= 0.0
    run(path, out, Workers(0))
    assert progress(out).done == found.blocks


def test_a_campaign_without_a_home_or_a_compiler(tmp_path):
    """Nor a cache that can be written: a file stands where the folders should be. Kernels run as plain Python."""
    (tmp_path / "file").touch()
    path = tmp_path / "tiny.yaml"
    path.write_text(TINY)
    nowhere = {name: str(tmp_path / "file" / "home") for name in ("HOME", "XDG_CACHE_HOME", "MPLCONFIGDIR")}
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("NUMBA", "GFMD"))} | nowhere
    environment["NUMBA_DISABLE_JIT"] = "1"
    command = [sys.executable, "-m", "gfmd_numba.cli", "run", str(path), "-o", str(tmp_path / "out"), "--workers", "0"]
    ran = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    assert "Traceback" not in ran.stderr
    assert list((tmp_path / "out").glob("*.nc"))
