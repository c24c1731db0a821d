"""Campaign, scene and surface files mutated at random: each is read or refused with a reason, in bounded time."""

import random
import re
import sys
import time
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import TypeAdapter

from gfmd_numba.campaign.axes import Values
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.scene import load_scene
from gfmd_numba.scene.surface_file import load_surface
from support.alterations import changed_text
from support.faulty_files import refusal
from support.scenes import SURFACE

CAMPAIGN = (Path(__file__).parents[2] / "campaigns" / "given-levels.yaml").read_text(encoding="utf-8")
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
KINDS = {"campaign": (load_campaign, CAMPAIGN), "scene": (load_scene, SCENE), "surface": (load_surface, SURFACE)}


def assert_loads_or_says_why(folder, kind, text):
    load, _ = KINDS[kind]
    path = folder / "fuzzed.yaml"
    path.write_text(text, encoding="utf-8")
    begun = time.perf_counter()
    said = refusal(load, path)
    assert time.perf_counter() - begun < 10.0
    if said is not None:
        assert re.match(re.escape(str(path)) + r":(\d+:\d+:)? .*you gave .*; gfmd (allows|needs) ", said, re.DOTALL)
        assert len(said) < 20_000


@pytest.mark.parametrize("kind", KINDS)
def test_what_the_mutants_were_made_from_is_good(tmp_path, kind):
    load, text = KINDS[kind]
    (tmp_path / "good.yaml").write_text(text, encoding="utf-8")
    load(tmp_path / "good.yaml")


@pytest.mark.parametrize("kind", KINDS)
def test_a_mutant_is_read_or_refused_with_a_reason(tmp_path_factory, kind):
    folder = tmp_path_factory.mktemp(kind)

    @given(pick=st.randoms(use_true_random=False))
    @settings(derandomize=True, deadline=None, max_examples=25)
    def mutants(pick):
        assert_loads_or_says_why(folder, kind, changed_text(KINDS[kind][1], pick))

    mutants()


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_many_mutants_are_read_or_refused_with_a_reason(tmp_path_factory, kind):
    folder = tmp_path_factory.mktemp(kind)

    @given(pick=st.randoms(use_true_random=True))
    @settings(deadline=None, max_examples=200)
    def mutants(pick):
        assert_loads_or_says_why(folder, kind, changed_text(KINDS[kind][1], pick))

    mutants()


def test_any_text_is_refused_with_a_reason(tmp_path):
    pick = random.Random(1)
    for _ in range(40):
        most = pick.choice((0x80, 0x800, sys.maxunicode))
        text = "".join(chr(pick.randrange(most)) for _ in range(pick.randrange(200)))
        assert_loads_or_says_why(tmp_path, "campaign", text.encode("utf-8", "ignore").decode())


def test_a_long_list_is_checked_in_time_of_its_length():
    """Each of 200 000 values was compared with all before it: half an hour."""
    values = tuple(float(i) for i in range(200_000))
    begun = time.perf_counter()
    assert TypeAdapter(Values[float]).validate_python(values) == values
    assert time.perf_counter() - begun < 10.0
