"""The longest time-out that a campaign may have is one that every timer takes, and no alarm is lost."""

import signal
import time
import weakref
from threading import Thread

import pytest

from gfmd_numba.campaign.execution import TooLongError, watched
from gfmd_numba.campaign.file import LONGEST_TIMEOUT, load_campaign
from gfmd_numba.scene import InputError
from support.campaigns import campaign

THIRTY_TWO_BITS_OF_MILLISECONDS = 2**32 / 1000  # the shortest of the timers: that of threads on Windows


def with_timeout(folder, seconds):
    path = campaign(folder)
    path.write_text(f"{path.read_text()}\ncase_timeout: {seconds}\n")
    return path


def test_a_timeout_beyond_the_longest_is_refused(tmp_path):
    assert load_campaign(with_timeout(tmp_path, LONGEST_TIMEOUT))[0].case_timeout == LONGEST_TIMEOUT
    for seconds in (1.001 * LONGEST_TIMEOUT, 1e300):
        with pytest.raises(
            InputError, match=r"case_timeout: you gave .*; gfmd allows a number above 0 and at most 2592000"
        ):
            load_campaign(with_timeout(tmp_path, seconds))


def test_the_longest_timeout_overflows_no_timer(tmp_path):
    assert LONGEST_TIMEOUT < THIRTY_TWO_BITS_OF_MILLISECONDS
    with watched(LONGEST_TIMEOUT):
        pass
    ended = []

    def block():
        with watched(LONGEST_TIMEOUT, tmp_path / "trace"):
            ended.append(True)

    thread = Thread(target=block)
    thread.start()
    thread.join()
    assert ended


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no alarms")
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_an_alarm_that_falls_into_a_collection_of_garbage_is_repeated():
    """Python swallows what is raised there."""

    class Garbage:
        pass

    def collected(_):
        begun = time.perf_counter()
        while time.perf_counter() < begun + 0.3:
            pass

    def block():
        garbage = Garbage()
        kept = weakref.ref(garbage, collected)
        del garbage
        assert kept() is None
        time.sleep(30)

    with pytest.raises(TooLongError), watched(0.1):
        block()
