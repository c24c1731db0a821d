"""`gfmd run --until`: what it says, draws and refuses, and how it exits."""

import re

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.analysis import plot_rounds
from gfmd_numba.campaign import rounds
from gfmd_numba.campaign import run as runs
from gfmd_numba.campaign.failures import Ending
from gfmd_numba.campaign.limits import FEWEST
from support.campaigns import TINY, campaign
from support.command_line import gfmd, refused, unfolded

pytestmark = pytest.mark.usefixtures("laws_that_hold", "undrawn")

ONE = {
    "reference: {": "levels: only\nfit: {exponents: free, fixed: {eps_c: 1.5, eps_f: 0.7}}\nreference: {",
    "grid: {hurst: [0.3, 0.8]}": "",
}


FINER = ONE | {"reference: {": "fit: {exponents: free, fixed: {eps_c: [1, 2], eps_f: [0.5, 1.5]}}\nreference: {"}


@pytest.fixture(scope="module")
def reached(tmp_path_factory, laws_that_hold):
    folder = tmp_path_factory.mktemp("reached")
    done = gfmd("run", campaign(folder, **ONE), "-o", folder / "out", "--workers=0", "--until=kappa=4%")
    assert done.exit_code == 0, done.output
    return folder / "out", done


@pytest.mark.long
@pytest.mark.parametrize(("options", "own"), [([], True), (["--fixed=eps_c=1.5"], True), (["--fixed=eps_f=1"], False)])
def test_a_fit_tells_how_a_run_ended_only_if_it_is_that_of_the_run(reached, options, own):
    said = gfmd("fit", reached[0], *options)
    assert said.exit_code == 0
    assert ("until kappa to 4.00%" in unfolded(said.stdout)) == own


@pytest.mark.long
def test_a_run_prints_the_fit_by_which_it_ended_and_makes_no_other(reached, monkeypatch):
    monkeypatch.setattr("gfmd_numba.analysis.fit_tfc", None)
    again = gfmd("run", reached[0] / "campaign.yaml", "-o", reached[0], "--workers=0", "--until=kappa=4%")
    assert again.exit_code == 0
    assert again.stdout == reached[1].stdout


def test_it_says_round_by_round_what_was_reached(reached):
    said = unfolded(reached[1].stdout)
    assert "round 0: error" in said
    assert "), the pilot; " in said
    assert "(with 90 % probability below " in said
    assert "until kappa to 4.00%: reached price a tenth of this error, 0." in said
    assert "plan this campaign again" not in said  # which is what helps where a plan missed its target


def test_its_progress_shows_the_error_the_target_and_the_time(reached):
    said = unfolded(reached[1].stderr)
    assert "added cross levels [{eps_c: 1/2, eps_f: 1/8}], to see whether corrections add up" in said
    pilot = re.search(r"round 0, the pilot: (\d+) simulations", said)
    assert int(pilot[1]) >= 6 * FEWEST
    assert "round 1: error " in said
    assert ", target 4.00%; " in said
    assert " s of processor time, " in said
    assert " until the target is reached" in said


def test_everything_fits_a_terminal(reached):
    lines = reached[1].output.splitlines()
    assert max(len(line) for line in lines if str(reached[0]) not in line) <= 80


@pytest.mark.long
def test_two_pictures_are_drawn(reached, tmp_path):
    out, done = reached
    assert (out / "small.png").is_file()
    assert (out / "small-rounds.png").is_file()
    assert f"picture  {out / 'small-rounds.png'}" in done.stdout
    again = gfmd("plot", out, "-o", tmp_path / "mine.svg")
    assert again.exit_code == 0
    assert (tmp_path / "mine-rounds.svg").is_file()


def test_a_picture_of_somebody_else_stays(reached, tmp_path):
    (tmp_path / "mine-rounds.png").write_text("mine")
    assert "gfmd did not write" in refused("plot", reached[0], "-o", tmp_path / "mine.png")
    assert (tmp_path / "mine-rounds.png").read_text() == "mine"


def test_the_picture_shows_rounds_and_target(reached):
    results = gfmd_numba.open_campaign(reached[0])
    (axis,) = plot_rounds(results).axes
    lines = {line.get_label(): line for line in axis.lines}
    (target,) = set(lines["target 4 %"].get_ydata())
    assert target == 0.04
    drawn = axis.containers[0].lines[0]
    np.testing.assert_array_equal(drawn.get_ydata(), results["round_error"])


@pytest.mark.long
def test_fit_shows_the_rounds_again(reached):
    assert "kappa to 4.00%: reached" in unfolded(gfmd("fit", reached[0]).stdout)


@pytest.mark.long
def test_a_target_out_of_reach_exits_with_3_and_the_best_estimate(tmp_path, monkeypatch):
    monkeypatch.setattr("gfmd_numba.campaign.cost.remembered", dict)  # of contacts on a machine that is busy
    path = campaign(tmp_path, **FINER)
    done = gfmd("run", path, "-o", tmp_path / "out", "--workers=0", "--until=kappa=0.7%", "--budget=1 s")
    assert done.exit_code == 3, done.output
    said = unfolded(done.stdout)
    assert "kappa to 0.70%: not reached: the budget is too small for" in said
    assert "limit" in said


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--until=0",), "each with a relative error above 0 and below 1, like kappa=3% or 0.03"),
        (("--until=kappa=x",), "each with a relative error above 0 and below 1, like kappa=3% or 0.03"),
        (("--until=area=1%",), "gfmd allows one of kappa, kappa_counted, kappa_r, contact_area_fraction, contact_area"),
        (("--until=kappa=1%", "--until=2%"), "gfmd allows several targets of different variables, each with its name"),
        (("--until=kappa=1%", "--until=kappa=2%"), "gfmd allows several targets of different variables"),
        (("--until=1%", "--budget=soon"), "gfmd allows a time like 20min, 2h or 90 s"),
        (
            ("--until=1%", "--budget=1e-9"),
            "where the pilot of 20 realisations of the finest level, and more of the others, takes about",
        ),
        (("--budget=20min",), "--budget: you gave no --until"),
        (("--until=1%", "--only=limit=eps_c"), "--only: you gave --until, or a target in FILE, as well"),
        (("--until=1%", "--limit=3"), "--limit: you gave --until, or a target in FILE, as well"),
    ],
)
def test_what_makes_no_sense_is_refused(tmp_path, options, told):
    assert told in refused("run", campaign(tmp_path, **ONE), "-o", tmp_path / "out", "--workers=0", *options)
    assert not (tmp_path / "out").exists()


def test_a_campaign_without_limits_is_refused(tmp_path):
    said = refused("run", campaign(tmp_path, TINY), "-o", tmp_path / "out", "--until=1%")
    assert said.startswith("gfmd: --until: you gave a campaign without a limit")


def test_the_help_says_that_the_realisations_of_the_file_are_not_used():
    said = unfolded(gfmd("run", "--help").stdout)
    assert (
        "Run until the limit has this error; may be given for several variables. gfmd chooses the numbers of "
        "realisations; those in FILE are not used" in said
    )
    assert "Processor time that the rounds may take, like 20min" in said


@pytest.mark.long
def test_an_interrupt_prints_the_best_estimate_and_leaves_a_run_to_go_on_with(tmp_path, monkeypatch):
    """In the first round after the pilot, when half of it is done."""
    path, out = campaign(tmp_path, **ONE), tmp_path / "out"
    finish = runs.finish

    def interrupted(planned, todo, *others):
        blocks = list(todo)
        if len(rounds.read(out).rounds) < 2:
            return finish(planned, blocks, *others)
        finish(planned, blocks[: len(blocks) // 2], *others)
        raise KeyboardInterrupt

    monkeypatch.setattr(runs, "finish", interrupted)
    done = gfmd("run", path, "-o", out, "--workers=0", "--until=kappa=2%")
    assert done.exit_code == 130, done.output
    said = unfolded(done.stdout)
    assert "kappa to 2.00%: not reached: the run was interrupted" in said
    assert "limit continuum" in said
    assert "interrupted; finished work is kept, the same command resumes" in unfolded(done.stderr)
    results = gfmd_numba.open_campaign(out)
    assert not (results["status"] == Ending.unfinished).any()
    assert (results["realisations"].values > FEWEST).any()
