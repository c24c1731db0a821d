"""From the results of one round to the next: whether the target is reached, and what to do if not."""

from math import inf

import xarray as xr

from gfmd_numba.analysis import UnusableDataError
from gfmd_numba.analysis.selection import LIMITS
from gfmd_numba.campaign.decision import (
    Fit,
    Judgement,
    UnknownExponentsError,
    decide,
    judge,
    price_of_realisations,
    whole_price,
)
from gfmd_numba.campaign.rounds import Round, Rounds

REACHED = "reached"
_MOST = 10  # rounds after the pilot: each may have four times the price of all before


def after(state: Rounds, results: xr.Dataset, fitted: xr.Dataset, fit: Fit) -> Rounds:
    """Rounds with what the last one has found, and with one more or `ended`."""
    now, target = state.now, state.goal.target
    state = state.with_now(cpu_seconds=float(results.attrs["cpu_seconds"]))
    try:
        price = whole_price(results, price_of_realisations(results), results["realisations"].values)
        found = judge(results, fitted, fit)
    except UnusableDataError as error:
        return state.ending(f"not {REACHED}: {error}")
    state = state.with_now(
        error=found.error if found.error < inf else None,
        error_factor=found.factor,
        price=price if now.price is None else now.price,
    )
    if (now.is_last or found.predicted <= target) and found.sure_error <= target:
        return state.ending(REACHED)
    if now.is_last and found.error == inf:
        refused = fitted["message"].values[fitted["fit_status"].values == "refused"]
        return state.ending(f"not {REACHED}: the fit is refused, {'; '.join(str(refused[0]).splitlines())}")
    if len(state.rounds) > _MOST:
        return state.ending(f"not {REACHED}: {_MOST} rounds did not suffice")
    return _with_another(state, results, fitted, found, fit)


def _with_another(state: Rounds, results: xr.Dataset, fitted: xr.Dataset, found: Judgement, fit: Fit) -> Rounds:
    most = inf
    if state.goal.budget is not None and state.seconds_per_price is not None:
        most = state.goal.budget / state.seconds_per_price
    try:
        decision = decide(results, found, state.goal.target, fit, most, after_pilot=len(state.rounds) == 1)
    except UnknownExponentsError as error:
        return state.ending(f"not {REACHED}: {error}{_widest(fitted)}")
    except UnusableDataError as error:
        return state.ending(f"not {REACHED}: {error}")
    if decision is None:
        return state.ending(f"not {REACHED}: the budget is too small for another round")
    another = Round(
        realisations=tuple(decision.realisations.tolist()),
        is_last=decision.is_last,
        predicted_error=decision.predicted_error,
        price=decision.price,
        target_price=decision.target_price,
    )
    return state.model_copy(update={"rounds": (*state.rounds, another)})


def _widest(fitted: xr.Dataset) -> str:
    """Say which exponent's range the error of the limit comes from mostly, where the fit tells."""
    shares = fitted["error_budget"].max("group")
    exponents = {name: float(shares.sel(source=name)) for name in LIMITS if shares.sel(source=name) > 0}
    return f" (above all that of {max(exponents, key=lambda name: exponents[name])})" if exponents else ""
