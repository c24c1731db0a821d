"""Output directories that belong to another campaign, another run or somebody else."""

import pytest

import gfmd_numba
from gfmd_numba.campaign.output_directory import claimed
from gfmd_numba.scene import InputError
from support.campaigns import TINY, campaign


def test_output_directory_of_another_campaign_is_refused(tmp_path):
    out = tmp_path / "out"
    gfmd_numba.run(campaign(tmp_path, TINY), out, 0)
    with pytest.raises(
        InputError, match=r"out: you gave the output directory of campaign 'tiny'; gfmd allows .*'other'"
    ):
        gfmd_numba.run(campaign(tmp_path, TINY, **{"name: tiny": "name: other"}), out, 0)


@pytest.mark.long
def test_a_damaged_label_says_what_to_do(tmp_path):
    path, out = campaign(tmp_path, TINY), tmp_path / "out"
    gfmd_numba.run(path, out)
    for text in ("x", "name: ["):
        (out / "campaign.yaml").write_text(text)
        with pytest.raises(
            InputError, match=r"out/campaign.yaml: you gave a copy .* that somebody has changed.*move it away"
        ):
            gfmd_numba.run(path, out)
    (out / "campaign.yaml").unlink()
    gfmd_numba.run(path, out)
    assert (out / "campaign.yaml").read_text() == path.read_text()


def test_one_run_at_a_time(tmp_path):
    path, out = campaign(tmp_path, TINY), tmp_path / "out"
    with (
        claimed(out, "tiny", "name: tiny"),
        pytest.raises(InputError, match=r"out: you gave an output directory in which another run is at work"),
    ):
        gfmd_numba.run(path, out)
    gfmd_numba.run(path, out)


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
