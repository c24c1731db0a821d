"""What a run takes in addition to its contacts: starting, workers, the results file, and the fit with its picture."""

import subprocess
import sys
from dataclasses import dataclass

from gfmd_numba.campaign.axes import DISCRETISATIONS
from gfmd_numba.campaign.cases import groups
from gfmd_numba.campaign.cost import remember, remembered
from gfmd_numba.campaign.plan import Plan

UNSURE = 1.4  # factor below which it stays with 90 % probability, whatever else the machine does

_IMPORTED = "distributed, matplotlib.figure, netCDF4, scipy.optimize, gfmd_numba.analysis, gfmd_numba.campaign.run"
_START = "start of a process"  # key of its run time
# of the start of a process, which tells how fast a machine runs Python:
_KERNELS, _WORKER, _RESULTS, _CASE, _PICTURE = 0.16, 1.6, 0.1, 7e-4, 0.4  # loading them, what one of the others takes
_FIT, _VALUE = 0.012, 5e-7  # of a limit of a group, to a factor of 3 as exponents and levels are, and of a simulation


@dataclass(frozen=True)
class Overhead:
    """Processor time in s of the `start` of the program, of each `worker`, of the `results` file and of the `fit`."""

    start: float
    worker: float
    results: float
    fit: float

    def cpu_seconds(self, workers: int) -> float:
        """Processor time of all of it."""
        return self.wall_seconds(0) + workers * self.worker

    def wall_seconds(self, workers: int) -> float:
        """Time that it adds to a run; workers start together, on a core each."""
        return self.start + self.results + self.fit + (self.worker if workers else 0.0)


def overhead(planned: Plan) -> Overhead:
    """Return what a run takes in addition to its contacts on this machine, with compiled kernels in the cache."""
    start = _start()
    limits = len({case.limit for case in planned.cases} & set(DISCRETISATIONS))
    fit, fitted = planned.campaign.fit, 0.0
    if limits:
        steps = (
            1 if fit.is_of_path or fit.step is not None else 1 + len(planned.campaign.path)
        )  # each of which is fitted
        each = _FIT * limits * len(groups(planned.cases)) + _VALUE * planned.n_asked
        fitted = (steps * each + _PICTURE) * start
    results = (_RESULTS + _CASE * len(planned.cases)) * start
    return Overhead((1 + _KERNELS) * start, _WORKER * start, results, fitted)


def _start() -> float:
    """Return the processor time in s of a process that imports what a run imports; it is measured once."""
    times = remembered()
    if _START not in times:
        script = f"import time, {_IMPORTED}; print(time.process_time())"
        said = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
        times[_START] = float(said.stdout)
        remember(times)
    return times[_START]
