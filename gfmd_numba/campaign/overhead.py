"""What a run takes in addition to its contacts: starting, workers, the results file, and the fit with its picture."""

import json
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import xarray as xr

from gfmd_numba.analysis import UnusableDataError, fit_tfc
from gfmd_numba.campaign.cases import groups
from gfmd_numba.campaign.coordinates import described_coordinates
from gfmd_numba.campaign.cost import remember, remembered
from gfmd_numba.campaign.plan import Plan

UNSURE = 1.4  # factor below which it stays with 90 % probability, whatever else the machine does

_IMPORTED = "distributed, matplotlib.figure, netCDF4, scipy.optimize, gfmd_numba.analysis, gfmd_numba.campaign.run"
_START = "start of a process"  # key of its run time
# of the start of a process, which tells how fast a machine runs Python:
_KERNELS, _WORKER, _RESULTS, _CASE, _PICTURE = 0.16, 1.6, 0.1, 7e-4, 0.4  # loading them, what one of the others takes
_REHEARSED = 6  # groups
_REALISATIONS = 20_000  # of a rehearsal at most: the time of a fit of more is proportional to them


def overhead(planned: Plan, workers: int) -> dict[str, float]:
    """Return the parts of processor time in s that a run takes in addition to its contacts on this machine, by name.

    Compiled kernels are in the cache.
    """
    start = _start()
    extrapolated = any(case.limit != "reference" for case in planned.cases)
    fitted = _rehearsed(planned) + _PICTURE * start if extrapolated else 0.0
    results = (_RESULTS + _CASE * len(planned.cases)) * start
    begun = {"start": (1 + _KERNELS) * start, "workers": workers * _WORKER * start}
    return begun | {"results": results, "fit and picture": fitted}


def _start() -> float:
    """Return the processor time in s of a process that imports what a run imports; it is measured once."""
    times = remembered()
    if _START not in times:
        script = f"import time, {_IMPORTED}; print(time.process_time())"
        said = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
        times[_START] = float(said.stdout)
        remember(times)
    return times[_START]


def _rehearsed(planned: Plan) -> float:
    """Return the seconds of the fit, from a fit of some groups of made-up results."""
    members = groups(planned.cases)
    cases = [case for group in members[:_REHEARSED] for case in group]
    asked = max(case.realisations for case in cases)
    fewer = [replace(case, realisations=min(case.realisations, _REALISATIONS)) for case in cases]
    fit, rng = planned.campaign.fit, np.random.default_rng(0)
    counts = np.array([case.realisations for case in fewer])
    # corrections with likely exponents, and scatter
    values = 2.0 + 0.1 * rng.standard_normal(counts.max()) + 0.03 * rng.standard_normal((len(fewer), counts.max()))
    for name, exponent in fit.fixed:
        eps = np.array([getattr(case.discretisation, name) for case in fewer])
        values += 0.1 * (eps[:, np.newaxis] / eps.max()) ** np.mean(exponent or 1.0)
    values[np.arange(counts.max()) >= counts[:, np.newaxis]] = np.nan
    coordinates = described_coordinates(planned.campaign.scene, fewer)
    results = xr.Dataset({fit.variable: (("case", "realisation"), values)}, coordinates)
    options = json.loads(fit.model_dump_json(exclude_none=True, exclude={"step"}))
    steps = 1 if fit.is_of_path or fit.step is not None else 1 + len(planned.campaign.path)  # each of which is fitted
    seconds: list[float] = []
    try:
        for _ in range(2):  # the first one imports
            begun = time.thread_time()
            fit_tfc(results, **options)
            seconds.append(time.thread_time() - begun)
    except UnusableDataError:
        return 0.0
    return steps * seconds[1] * len(members) / min(len(members), _REHEARSED) * asked / min(asked, _REALISATIONS)
