"""`gfmd plan --target`: it says what the first rounds of `gfmd run --until` decide, and leaves nothing behind."""

import re
import tempfile

import pytest
import yaml

from gfmd_numba.campaign import rounds
from gfmd_numba.campaign import run as runs
from gfmd_numba.cli.campaigns import goal_in
from gfmd_numba.cli.tables import duration
from gfmd_numba.scene import InputError
from support.campaigns import TINY, campaign, killed_in
from support.command_line import gfmd, refused, unfolded
from support.doubts import without_doubts

pytestmark = pytest.mark.usefixtures("undrawn")

ONE = {
    "reference: {": "levels: only\nfit: {exponents: free, fixed: {eps_c: 1.5, eps_f: 0.7}}\nreference: {",
    "grid: {hurst: [0.3, 0.8]}": "",
}
SHORT = {
    "name": "short",
    "seed": 1,
    "scene": {
        "body": {"poissons_ratio": 0.33},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.05},
    },
}
COARSE = SHORT | {
    "realisations": 2,
    "reference": {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1 / 2},
    "limits": {"eps_f": [1 / 2, 1 / 4], "eps_t": [1], "cross": [{"eps_f": 1 / 4, "eps_t": 1}]},
    "fit": {"exponents": "free", "fixed": {"eps_f": [0.3, 2], "eps_t": 1}},
}


def written(folder, record):
    path = folder / "campaign.yaml"
    path.write_text(yaml.safe_dump(record))
    return path


def planned(path, *options):
    return gfmd("plan", path, "--workers=0", *options)


def told(said):
    """Realisations of the pilot and of round 1, of each level in the order of the table."""
    table = said.partition("realisations of each level")[2].partition("\n\n")[2].partition("\n\n")[0]
    return [tuple(map(int, line.split()[-2:])) for line in table.splitlines()[1:]]


def killed_before_round(number, path, out, *options):
    """The rounds of a run that is killed when it has decided about this one."""
    with killed_in(runs, "finish", number):
        gfmd("run", path, "-o", out, "--workers=0", *options)
    return rounds.read(out).rounds


@pytest.fixture
def compared(tmp_path, monkeypatch):
    """What a plan said, and the first two rounds of a run to the same target, which is killed before the second."""

    def of(path, target):
        monkeypatch.setattr(runs, "seconds_per_price", lambda planned, directory: 1.0)
        said = planned(path, f"--target={target}")
        assert said.exit_code == 0, said.output
        first, second = killed_before_round(1, path, tmp_path / "out", f"--until={target}")
        before = dict(zip(first.cases, first.realisations, strict=True))
        assert told(said.stdout) == [
            (before.get(case, 0), number) for case, number in zip(second.cases, second.realisations, strict=True)
        ]
        found = first.errors["kappa"]
        sure = f"{found.error:.2%} (with 90 % probability below {found.error * found.factor:.2%})"
        assert f"kappa in the limit: error {sure}" in unfolded(said.stdout)
        assert f"about {duration(second.price)} for the contacts of the pilot and of round 1" in unfolded(said.stdout)
        return unfolded(said.stdout), first, second

    return of


@pytest.mark.long
def test_it_tells_the_realisations_and_the_error_of_the_next_round(tmp_path, monkeypatch, compared):
    without_doubts(monkeypatch)
    said, first, second = compared(campaign(tmp_path, **ONE), "kappa=3%")
    assert first.levels == second.levels
    assert "round 1 more realisations of the same levels" in said
    assert f"{second.predicted_error:.2%} of kappa in the limit is expected after round 1" in said
    whole = f"about {duration(second.target_price)} for all contacts until the target is reached"
    assert f"{whole}, as far as the pilot can tell" in said


@pytest.mark.long
def test_it_tells_the_finer_levels_of_the_next_round_and_not_what_the_target_takes(tmp_path, compared):
    said, first, second = compared(written(tmp_path, COARSE), "5%")
    assert set(first.levels[0]) < set(second.levels[0])
    assert f"round 1 finer levels, eps_c to 1/2, eps_f to 1/{1 / second.levels[0][0][1]:.0f}" in said
    assert "no error is predicted for levels without results" in said
    assert "nobody can know yet what the target takes" in said
    assert "until the target is reached" not in said


@pytest.mark.long
def test_a_campaign_without_levels_is_planned_from_its_pilot(tmp_path):
    said = planned(written(tmp_path, SHORT), "--target=kappa=2%")
    assert said.exit_code == 0, said.output
    assert "eps_c to 1/8, eps_f to 1/1024, eps_t to 1/8: 11 cases" in unfolded(said.stderr)
    assert re.search(r"target +2.00%: (not reached by the pilot|reached)", said.stdout)


@pytest.mark.long
def test_a_target_that_the_pilot_reaches_needs_no_other_round(tmp_path):
    said = planned(campaign(tmp_path, **ONE), "--target=50%")
    assert said.exit_code == 0, said.output
    assert "50.00%: reached by the pilot, after which `gfmd run --until` ends" in unfolded(said.stdout)
    assert "round 1" not in said.stdout


@pytest.mark.long
def test_a_target_out_of_reach_is_told_with_the_reason(tmp_path):
    said = planned(written(tmp_path, COARSE | {"levels": "only"}), "--target=5%")
    assert said.exit_code == 3
    assert "5.00%: not reached: the distance from the finest levels to the limit leaves" in unfolded(said.stdout)
    assert "round 1" not in said.stdout


@pytest.mark.long
def test_levels_that_do_not_fit_the_memory_are_told(tmp_path, monkeypatch):
    room = [None]

    def check_room(todo, workers):
        if not room:
            raise InputError("--workers: you gave 0")
        room.pop()

    monkeypatch.setattr(runs, "check_room", check_room)
    said = planned(written(tmp_path, COARSE), "--target=5%")
    assert said.exit_code == 3
    assert "not reached: finer levels do not fit the memory (--workers: you gave 0)" in unfolded(said.stdout)


@pytest.mark.long
def test_nothing_is_left_behind(tmp_path, monkeypatch):
    temporary, folder = tmp_path / "temporary", tmp_path / "folder"
    temporary.mkdir()
    folder.mkdir()
    path = written(folder, COARSE)
    before = path.read_bytes()
    monkeypatch.chdir(folder)
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    assert planned(path, "--target=5%").exit_code == 0
    assert [*temporary.iterdir()] == []
    assert [(each, each.read_bytes()) for each in folder.iterdir()] == [(path, before)]


def test_an_interrupt_is_told_as_what_it_is(tmp_path, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(runs, "finish", interrupted)
    said = planned(campaign(tmp_path, **ONE), "--target=3%")
    assert said.exit_code == 130
    assert said.stderr.splitlines()[-1] == "gfmd: interrupted; a plan keeps no results"


@pytest.mark.parametrize(
    ("options", "why"),
    [
        (("--target=0",), "each with a relative error above 0 and below 1, like kappa=3% or 0.03"),
        (("--target=200%",), "each with a relative error above 0 and below 1, like kappa=3% or 0.03"),
        (("--target=kappa=2x",), "each with a relative error above 0 and below 1, like kappa=3% or 0.03"),
        (("--target=area=1%",), "--target: you gave 'area'; gfmd allows one of kappa, kappa_counted, kappa_r"),
        (("--target=2%", "--budget=soon"), "gfmd allows a time like 20min, 2h or 90 s"),
        (("--target=2%", "--budget=1e-9"), "--budget: you gave 1e-09 s of processor time, where the pilot of 20"),
        (("--budget=20min",), "--budget: you gave no --target, whose processor time it bounds"),
        (("--target=2%", "--pilot=3"), "--pilot: you gave --target as well, which runs a pilot of its own"),
    ],
)
def test_what_makes_no_sense_is_refused(tmp_path, options, why):
    assert why in refused("plan", campaign(tmp_path, **ONE), "--workers=0", *options)


def test_a_campaign_without_limits_has_no_target(tmp_path):
    said = refused("plan", campaign(tmp_path, TINY), "--target=1%")
    assert said.startswith("gfmd: --target: you gave a campaign without a limit")


def test_a_target_without_a_name_is_that_of_what_is_fitted(tmp_path):
    path = campaign(tmp_path, **{"reference: {": "fit: {variable: kappa_r}\nreference: {"})
    assert goal_in(path, {"": 0.02}, None, "--until").targets == {"kappa_r": 0.02}


def test_without_a_target_on_the_command_line_the_first_round_of_that_in_the_file_is_planned(tmp_path):
    asked = COARSE | {"target": {"kappa": "90%"}}
    path = written(tmp_path, asked)  # whose realisations are all that is asked for
    assert "simulations 10 of 10 asked for" in unfolded(planned(path, "--pilot=0").stdout)
    path = written(tmp_path, {name: value for name, value in asked.items() if name != "realisations"})
    said = planned(path, "--pilot=0")
    assert "what follows is the first round" in unfolded(said.stdout)
    first = killed_before_round(0, path, tmp_path / "out")[0].realisations
    assert f"simulations {sum(first)} of {sum(first)} asked for" in unfolded(said.stdout)
    assert sum(first) > 2 * len(first)
    off = [line for line in said.stdout.splitlines() if line.startswith("off ")]
    assert "friction" in unfolded(said.stdout)
    assert len(off) == 2  # a line for each reason
