"""Every way a run may end has a name, a number in the files and a sentence that says what to do."""

import numpy as np

import gfmd_numba
from gfmd_numba.campaign import failures
from gfmd_numba.campaign.failures import Ending
from gfmd_numba.solvers import status
from gfmd_numba.solvers.status import Status, certified, flag_attributes, withdrawn


def test_every_ending_has_a_sentence():
    assert set(status.SENTENCES) == set(Status)
    assert set(failures.SENTENCES) == {*Status, *Ending}
    assert all(sentence.endswith(".") for sentence in failures.SENTENCES.values())


def test_a_campaign_has_the_endings_of_the_solver_and_its_own():
    """The numbers stand in files: none may change."""
    assert {ended.name: ended.value for ended in (*Status, *Ending)} == {
        **{ended.name: ended.value for ended in Status},
        "timeout": 7,
        "crashed": 8,
        "unfinished": 9,
        "not_asked": 10,
    }
    assert flag_attributes(failures.SENTENCES)["flag_values"].tolist() == list(range(11))


def test_results_carry_the_sentences():
    scene = {
        "body": {"poissons_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.05},
    }
    found = gfmd_numba.solve({"scene": scene, "discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1 / 2}})
    attributes = found["status"].attrs
    assert attributes["flag_meanings"].split() == [ended.name for ended in Status]
    assert attributes["flag_sentences"].splitlines()[0] == f"ok: {status.SENTENCES[Status.ok]}"


def test_a_residual_is_certified_up_to_the_one_asked_for():
    found = certified(np.array([0.0, 1e-8, 1.1e-8, np.inf, np.nan]), 1e-8, Status.stagnated)
    ok, stagnated = Status.ok, Status.stagnated
    assert found.tolist() == [ok, ok, stagnated, stagnated, Status.nonfinite]


def test_a_failed_check_withdraws_ok_and_no_other_status():
    before, failed = np.array([0, 0, 2], dtype=np.int8), np.array([False, True, True])
    assert withdrawn(before, failed, Status.too_steep).tolist() == [Status.ok, Status.too_steep, Status.stagnated]
