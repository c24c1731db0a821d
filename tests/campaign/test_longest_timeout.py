"""The longest time-out that a campaign may have is one that every timer takes."""

from threading import Thread

import pytest

from gfmd_numba.campaign.file import LONGEST_TIMEOUT, load_campaign
from gfmd_numba.campaign.watchdog import watched
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
        with pytest.raises(InputError, match=r"case_timeout: given .*; allowed: a number above 0 and at most 2592000"):
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
