"""Rounds of a run whose errors are known in closed form: nothing is solved, nothing is fitted."""

from dataclasses import dataclass, fields, replace
from math import ceil, hypot

import numpy as np
import xarray as xr

from gfmd_numba.analysis import UnusableDataError
from gfmd_numba.analysis.allocation import Prediction
from gfmd_numba.analysis.fit_dataset import SOURCES
from gfmd_numba.analysis.selection import LIMITS
from gfmd_numba.campaign.goal import Goal
from gfmd_numba.campaign.limits import limit_of, nodes_of
from gfmd_numba.campaign.next_round import Known
from gfmd_numba.campaign.rounds import Round, Rounds

HELD = 100  # surfaces of each case, which leave a relative error of 10 %
LEVELS = ((1 / 2, 1 / 64, 1 / 4), (1 / 2, 1 / 16, 1 / 4))
VALUE = -2.0  # of the limit


@dataclass(frozen=True)
class Pilot:
    """An error of `scatter` over the root of the fewest surfaces, and parts that no surfaces mend."""

    scatter: float = 1.0
    exponents: float = 0.0
    interactions: float = 0.0
    factor: float = 1.0
    caution: float = 1.0
    steps: float = 1.0  # of a path, whose first one has the largest error

    @classmethod
    def of(cls, cases, variable, fixed):
        return cls(**{each.name: float(cases[each.name].values[0]) for each in fields(cls) if each.name in cases})

    @property
    def floor(self):
        return hypot(self.exponents, self.interactions)

    def predictions(self, counts):
        whole = hypot(self.scatter / np.sqrt(min(counts)), self.floor), self.exponents, self.interactions
        steps = range(1, int(self.steps) + 1)
        return [Prediction(*(each / step for each in whole), self.factor, step * self.caution) for step in steps]

    def cheapest_design(self, price, target):
        left = (target / self.caution) ** 2 - self.floor**2
        if left <= 0.0 or self.scatter**2 / left > 5e5:  # some levels would need twice as many
            raise UnusableDataError("out of reach")
        return np.full(len(price), ceil(self.scatter**2 / left * (1 - 1e-12)))


def known(groups=({},), held=HELD, fixed=None, levels=LEVELS, variable="kappa", **more):
    """What a round has found; each group says how its error differs from 10 % at 100 surfaces."""
    each = [(i, group, level) for i, group in enumerate(groups) for level in group.get("levels", levels)]
    first = [group.get("levels", levels)[0] for _, group, _ in each]
    n, names = len(each), {field.name for field in fields(Pilot)} & {name for group in groups for name in group}
    coords = {name: ("case", [level[i] for *_, level in each]) for i, name in enumerate(LIMITS)}
    coords |= {name: ("case", [group.get(name, getattr(Pilot, name)) for _, group, _ in each]) for name in names}
    coords |= {
        "hurst": ("case", [group.get("hurst", 0.1 * i) for i, group, _ in each], {"axis": "physics", "rank": 0}),
        "case_id": ("case", [f"{group.get('twin', i)}-{level}" for i, group, level in each]),
        "limit": ("case", [limit_of(reference, level) for reference, (*_, level) in zip(first, each, strict=True)]),
        "realisations": ("case", np.full(n, held)),
        "nx": ("case", [nodes_of(level, 1) for *_, level in each]),
        "dimension": ("case", np.ones(n, dtype=int)),
    }
    ran = {
        "n_transforms": (("case", "realisation"), np.full((n, 2), 40.0)),
        "status": (("case", "realisation"), np.zeros((n, 2), dtype=int)),
    }
    results = xr.Dataset(ran, coords, {"cpu_seconds": 3.0}).assign(more)
    of_nothing = xr.Dataset(
        {"error_budget": (("group", "source"), np.zeros((1, len(SOURCES))))}, {"source": list(SOURCES)}
    )
    return Known(results, of_nothing, variable, fixed or {})


def fitted(found, errors=(0.1,), variable="kappa", bridged=None, residual=0.1, **more):
    """A fit with relative errors of some groups, all by their surfaces, and what the distance in each limit adds.

    The rms distance of its four means from the laws is a `residual` of the limit.
    """
    n, value = len(errors), np.full(len(errors), VALUE)
    by_limit = np.zeros((n, 3))
    for name, shares in (bridged or {}).items():
        by_limit[:, LIMITS.index(name)] = shares
    shares = {"sampling": errors, "rivals": 0.0} | {name: more.pop(name) for name in SOURCES if name in more}
    budget = np.array([np.broadcast_to(shares.get(source, 0.0), n) for source in SOURCES])
    each = ("group", "limit")
    variables = {
        f"{variable}_tfc": ("group", value),
        f"{variable}_tfc_error": ("group", abs(value) * errors),
        "error_budget": (("group", "source"), (abs(value) * budget).T),
        "extrapolation_error": (each, abs(value[:, None]) * by_limit),
        "extrapolated": (each, np.ones((n, 3))),
        "finest_eps": (each, np.full((n, 3), 1 / 64)),
        "alpha": (each, np.ones((n, 3))),
        "law": (each, np.full((n, 3), "power")),
        "contradiction": (each, np.zeros((n, 3))),
        "fit_status": ("group", np.full(n, "ok", dtype=object)),
        "misfit": ("group", np.ones(n)),
        "rms_residual": ("group", abs(value) * residual),
        "n_cases": ("group", np.full(n, 4)),
        "n_stretches": ("group", np.full(n, np.nan)),
        "message": ("group", np.full(n, "", dtype=object)),
    }
    for name, given in more.items():
        variables[name] = (variables[name][0], given)
    made = xr.Dataset(variables, {"limit": list(LIMITS), "source": list(SOURCES)}, {"variable": variable})
    return replace(found, fitted=made)


def state(found, targets, levels=(), budget=None, rounds=1, **now):
    """The rounds of a run whose last one has ended, on a machine that takes half a second for a unit of price."""
    last = {"is_last": False, "variable": next(iter(targets))} | now
    each = Round(realisations=tuple(found.held.tolist()), levels=levels, **last)
    goal = Goal(targets=targets, budget=budget and 0.5 * budget)
    return Rounds(goal=goal, campaign_sha256="", rounds=(each,) * rounds, seconds_per_price=0.5)
