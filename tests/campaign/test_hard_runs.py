"""Long runs: many cases one after another leave no memory, no file handles and no temporary files behind."""

from itertools import count, islice

import psutil
import pytest

from gfmd_numba.campaign.cases import Block
from gfmd_numba.campaign.execution import perform
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.shards import Finished, path_of
from support.campaigns import campaign


@pytest.mark.long
def test_memory_and_file_handles_stay_flat_over_many_cases(tmp_path):
    (tmp_path / "shards").mkdir()
    problems = plan(campaign(tmp_path)).problems
    tasks = ((Block(problem, first, first + 1),) for first in count() for problem in problems)
    process = psutil.Process()

    def perform_some(number):
        for task in islice(tasks, number):
            assert perform(task, tmp_path, None) == {}
            assert Finished(tmp_path).read(task[0].name)["status"].tolist() == [0]
            path_of(tmp_path, [task[0].name]).unlink()
        return process.memory_info().rss, process.num_fds()

    memory, handles = perform_some(20)
    more_memory, more_handles = perform_some(500)
    assert more_handles <= handles
    assert more_memory - memory < 8e6, f"{more_memory - memory} bytes more"
    assert not list((tmp_path / "shards").iterdir())
