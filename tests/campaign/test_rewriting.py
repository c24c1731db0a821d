"""A campaign rewritten for a target: another name, other realisations, and every other character as it was."""

import re
from dataclasses import replace

import pytest
import yaml
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from gfmd_numba.analysis import Design
from gfmd_numba.campaign import design as accuracy
from gfmd_numba.campaign.cross_levels import with_cross_levels
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.rewriting import with_values
from gfmd_numba.cli import main
from gfmd_numba.scene import InputError
from support.campaigns import SMALL, campaign

DESIGN = Design(reference=46, levels={"eps_c": {1 / 2: 3, 1 / 8: 7}}, seconds=1.0, error=0.0123, sampling=0.01,
                exponents=0.005, limiting="sampling")  # fmt: skip
COUNTS = {"reference": 46, "eps_c": (3, 0, 7), "eps_f": (0, 0, 0), "eps_t": None, "cross": None}
BLOCK = "realisations:   # by limit\n  reference: 6   # as the first\n  # few\n  eps_c: 3   # enough\n"
FLOW = "realisations: {reference: 6,  # as the first\n   # few\n  eps_c: 3}   # enough\n"
STYLES = {
    "a number": SMALL,
    "a number and a comment": SMALL.replace("realisations: 6", "realisations: 6   # all # of them"),
    "a block": SMALL.replace("realisations: 6\n", BLOCK),
    "a block at the end": SMALL.replace("realisations: 6\n", "") + BLOCK + "# that is all\n",
    "flow over several lines": SMALL.replace("realisations: 6\n", FLOW),
    "quoted": SMALL.replace("realisations: 6", "'realisations' : 6").replace("name: small", '"name": "small"'),
    "a target": SMALL + "target: {kappa: 5%}   # of all groups\n",
    "an empty target": SMALL + "target:   # none yet\n",
    "indented": re.sub("(?m)^(?=.)", "  ", SMALL),
    "document marks": f"%YAML 1.2\n---\n{SMALL.strip()}   # end\n...\n",
    "no last line end": SMALL.rstrip(),
    "a comment that looks like a key": SMALL + "# realisations: 7\n",
    "a folded name": SMALL.replace("name: small", "name: >-\n  small"),
    "line ends of Windows": SMALL.replace("realisations: 6\n", BLOCK).replace("\n", "\r\n"),
    "with a byte-order mark": "\ufeff" + SMALL,
    "all on one line": yaml.dump(yaml.safe_load(SMALL), default_flow_style=True, width=9999),
    "JSON": '{"name":"small","seed":1,"realisations":6,"scene":{"body":{"poissons_ratio":0.33},"roughness":{"method":'
    '"psd","hurst":0.8,"rms_gradient":0.01},"interface":{"hard_wall":{}},"loading":{"reduced_pressure":0.05}},'
    '"reference":{"eps_c":0.25,"eps_f":0.0625,"eps_t":0.5},"limits":{"eps_c":[0.5,0.25,0.125],"eps_f":[0.125,0.0625,0.03125]}}',
}

CROSS_DESIGN = replace(DESIGN, levels=DESIGN.levels | {"eps_f": {1 / 8: 5, 1 / 32: 4}}, cross=(21,))
LIMITS = "limits: {eps_c: [1/2, 1/4, 1/8], eps_f: [1/8, 1/16, 1/32]}"
OF_LIMITS = {
    "a block": "limits:   # all\n  eps_c: [1/2, 1/4, 1/8]\n  eps_f:\n    - 1/8\n    - 1/32   # fine\n",
    "flow over several lines": "limits: {eps_c: [1/2, 1/4, 1/8],   # c\n  eps_f: [1/8, 1/32]   # f\n  }",
    "a last comma": "limits: {eps_c: [1/2, 1/4, 1/8], eps_f: [1/8, 1/32],}",
    "none yet": "limits: {cross: null, eps_c: [1/2, 1/4, 1/8], eps_f: [1/8, 1/32]}",
    "none yet in a block": "limits:\n  cross:   # none\n  eps_c: [1/2, 1/4, 1/8]\n  eps_f: [1/8, 1/32]",
}
STYLES_OF_LIMITS = STYLES | {f"limits, {name}": SMALL.replace(LIMITS, text) for name, text in OF_LIMITS.items()}


def rewritten(folder, text):
    path = folder / "first.yaml"
    path.write_bytes(text.encode())
    planned = plan(path)
    new, name = accuracy.rewritten(planned, DESIGN, 0.02)
    (folder / "second.yaml").write_bytes(new.encode())
    found = load_campaign(folder / "second.yaml")[0]
    assert found.name == name != planned.campaign.name
    return planned.campaign, found, new


@pytest.mark.parametrize("style", STYLES)
def test_every_style_of_yaml_is_rewritten(tmp_path, style):
    first, found, new = rewritten(tmp_path, STYLES[style])
    assert found.name == "small-0.02"
    assert found.target == {"kappa": 0.02}
    assert found.realisations.model_dump() == COUNTS
    changes = {"name": first.name, "target": first.target, "realisations": first.realisations}
    assert found.model_copy(update=changes) == first
    assert sorted(re.findall(r"#[^#\r\n]*", new)) == sorted(re.findall(r"#[^#\r\n]*", STYLES[style]))
    assert new.count("\r\n") in (0, new.count("\n"))


@pytest.mark.parametrize("style", STYLES_OF_LIMITS)
def test_every_style_of_yaml_gets_the_cross_levels_of_a_plan(tmp_path, style):
    path, second = tmp_path / "first.yaml", tmp_path / "second.yaml"
    path.write_bytes(STYLES_OF_LIMITS[style].encode())
    new, _ = accuracy.rewritten(with_cross_levels(plan(path)), CROSS_DESIGN, 0.02)
    second.write_bytes(new.encode())
    found = load_campaign(second)[0]
    assert found.limits.crossed == ({"eps_c": 1 / 2, "eps_f": 1 / 8},)
    assert found.realisations.cross == (21,)
    assert sorted(re.findall(r"#[^#\r\n]*", new)) == sorted(re.findall(r"#[^#\r\n]*", STYLES_OF_LIMITS[style]))


def test_what_is_not_changed_stays_where_it_was(tmp_path):
    _, _, new = rewritten(tmp_path, SMALL)
    before, after = SMALL.splitlines(), new.splitlines()
    changed = [i for i, line in enumerate(before) if line != after[i]]
    assert [before[i] for i in changed] == ["name: small", "realisations: 6"]
    assert after[len(before) :] == ["target: {kappa: 0.02}"]


def test_a_long_name_stays_within_what_a_name_may_be(tmp_path):
    _, found, _ = rewritten(tmp_path, SMALL.replace("name: small", f"name: {'x' * 100}"))
    assert found.name == "x" * 95 + "-0.02"


def test_a_text_that_would_not_read_as_meant_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(accuracy, "with_values", lambda text, values: text.replace("seed: 1", "seed: 2"))
    with pytest.raises(
        InputError, match=r"--write: you gave a campaign file whose text .*`realisations: {reference: 46"
    ):
        rewritten(tmp_path, SMALL)


def test_the_planned_campaign_leaves_the_results_of_the_first_alone(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(accuracy, "pilot", lambda planned: accuracy.Pilot(None, [], 1, 1))
    monkeypatch.setattr(accuracy, "design", lambda *_: CROSS_DESIGN)
    monkeypatch.setattr(accuracy, "loosest_residual", lambda *_: 1e-3)
    campaign(tmp_path)
    said = CliRunner().invoke(main, ["plan", "campaign.yaml", "--target=kappa=2%", "--write=planned.yaml"])
    assert said.exit_code == 0, said.output
    assert "planned.yaml, named small-0.02" in said.output
    again = CliRunner().invoke(main, ["plan", "campaign.yaml", "--target=kappa=2%", "--write=campaign.yaml"])
    assert again.exit_code == 2
    assert "--write: you gave campaign.yaml; gfmd allows a new file in an existing folder" in again.output
    assert (tmp_path / "campaign.yaml").read_text() == SMALL


leaf = st.one_of(st.integers(), st.text("ab#:,'\"{}[]- \n", max_size=8), st.none())
tree = st.recursive(leaf, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from("pqr"), inner))


@pytest.mark.long
@settings(derandomize=True, deadline=None, max_examples=300)
@given(st.dictionaries(st.sampled_from("abcdef"), tree, min_size=1), st.sampled_from([True, False, None]))
def test_any_mapping_gets_the_new_values_and_keeps_the_others(data, style):
    text = yaml.safe_dump(data, default_flow_style=style, width=40)
    new = with_values(text, {"a": "{x: [1, 2]}", "z": "3"})
    assert yaml.safe_load(new) == data | {"a": {"x": [1, 2]}, "z": 3}
