"""The seconds that commands print are those that the contacts of the campaign took, by a clock of the test's own."""

import re
import time
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

import gfmd_numba
from gfmd_numba.campaign import execution, shards
from gfmd_numba.cli import main
from gfmd_numba.cli.tables import duration
from gfmd_numba.contact import load_path
from support.campaigns import campaign

pytestmark = pytest.mark.usefixtures("undrawn")

FIT = "fit: {exponents: free, fixed: {eps_c: 1.5, eps_f: 0.7}}\nlevels: only\nreference: {"
SHARED = {  # a half-space has no other problem for another Poisson's ratio
    "reference: {": FIT,
    "grid: {hurst: [0.3, 0.8]}": "grid: {poissons_ratio: [0.2, 0.3, 0.4]}",
}
ONE = {"reference: {": FIT, "grid: {hurst: [0.3, 0.8]}": ""}


@pytest.fixture
def clock(monkeypatch):
    """Processor time of this whole process, all its threads, while it solves and measures contacts."""
    spent = [0.0]

    def timed(function):
        def call(*given):
            begun = time.process_time()
            try:
                return function(*given)
            finally:
                spent[0] += time.process_time() - begun

        return call

    for module in (execution, load_path):  # also what compiles kernels
        monkeypatch.setattr(module, "measured", timed(module.measured))
    return spent


def gfmd(*arguments):
    done = CliRunner().invoke(main, [str(argument) for argument in arguments])
    assert done.exit_code == 0, done.output
    return " ".join(done.output.split())


@pytest.mark.long
def test_a_fit_prints_what_the_contacts_took_where_cases_share_them(tmp_path, clock):
    """Each problem once, though three cases have it."""
    path = campaign(tmp_path, **SHARED | {"realisations: 6": "realisations: 60"})
    said = gfmd("run", path, "-o", tmp_path / "out", "--workers=0")
    results = gfmd_numba.open_campaign(tmp_path / "out")
    seconds = results.attrs["cpu_seconds"]
    # compiling loads kernels, tiny contacts that the results do not count
    assert seconds <= clock[0]
    assert results["case_seconds"].sum() == pytest.approx(3 * seconds)
    finished = shards.Finished(tmp_path / "out")
    stored = [finished.read(name)["seconds"].sum() for name in finished]
    assert seconds == pytest.approx(sum(stored))
    told = f"; {duration(seconds)} of processor time for the contacts"
    assert told in said
    assert told in gfmd("fit", tmp_path / "out")


@pytest.mark.long
def test_contacts_take_the_processor_time_that_the_results_tell(tmp_path, clock, monkeypatch):
    """By a clock of all threads, none of which works unseen."""
    monkeypatch.setattr("gfmd_numba.campaign.run.compile_kernels", lambda problems: None)
    path = campaign(tmp_path, **ONE | {"realisations: 6": "realisations: 200"})
    gfmd("run", path, "-o", tmp_path / "first", "--workers=0")  # kernels are loaded, and the cost is known
    clock[0] = 0.0
    gfmd("run", path, "-o", tmp_path / "out", "--workers=0")
    assert gfmd_numba.open_campaign(tmp_path / "out").attrs["cpu_seconds"] == pytest.approx(clock[0], rel=0.1)


@pytest.mark.long
def test_the_price_of_the_next_digit_is_a_hundred_times_that_of_the_run(tmp_path, laws_that_hold):
    said = gfmd("run", campaign(tmp_path, **ONE), "-o", tmp_path / "out", "--workers=0", "--until=kappa=3%")
    results = gfmd_numba.open_campaign(tmp_path / "out")
    seconds = results.attrs["cpu_seconds"]
    assert results["round_cpu_seconds"].values[-1] == pytest.approx(seconds)
    assert f"; {duration(seconds)} of processor time for the contacts so far" in said
    assert f"takes about {duration(100 * seconds)} of processor time for the contacts" in said


@pytest.mark.long
def test_what_a_round_was_to_take_is_what_it_took(tmp_path, monkeypatch, laws_that_hold):
    """On a machine that takes a nanosecond an operation: real seconds of so short a pilot tell what else ran."""
    now = [0.0]

    def measured(problem, realisations):
        found = load_path.measured(problem, realisations)
        n = problem.surface.nodes
        now[0] += 1e-9 * found["n_transforms"].sum() * (n * np.log2(n) + 2**15)
        return found

    monkeypatch.setattr(execution, "measured", measured)
    monkeypatch.setattr(execution, "time", SimpleNamespace(thread_time=lambda: now[0]))
    said = gfmd("run", campaign(tmp_path, **ONE), "-o", tmp_path / "out", "--workers=0", "--until=kappa=1%")
    told = [float(number) for number in re.findall(r"; about ([\d.]+) s of processor time", said)]
    took = np.diff(gfmd_numba.open_campaign(tmp_path / "out")["round_cpu_seconds"].values)
    assert len(told) == len(took) > 0
    np.testing.assert_allclose(told, took, rtol=0.1)  # a round's surfaces take other numbers of transforms


@pytest.mark.long
def test_surfaces_that_were_not_asked_for_are_not_paid_for(tmp_path):
    """A run of fewer realisations after one of many takes its share of their seconds."""
    out = tmp_path / "out"
    gfmd("run", campaign(tmp_path, **ONE | {"realisations: 6": "realisations: 40"}), "-o", out, "--workers=0")
    all_of_them = gfmd_numba.open_campaign(out).attrs["cpu_seconds"]
    gfmd("run", campaign(tmp_path, **ONE | {"realisations: 6": "realisations: 10"}), "-o", out, "--workers=0")
    assert gfmd_numba.open_campaign(out).attrs["cpu_seconds"] == pytest.approx(all_of_them / 4)
