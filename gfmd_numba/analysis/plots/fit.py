"""Figure of a fit: kappa in the limit against a parameter, drawn without pyplot so that no state is shared."""

import xarray as xr
from matplotlib.figure import Figure

from gfmd_numba.analysis.plots.parameter import over_parameter
from gfmd_numba.analysis.selection import UnusableDataError, axes
from gfmd_numba.arrays import Reals

_SYMBOLS = {"kappa": r"$\kappa$", "kappa_counted": r"$\kappa$ of counted nodes", "kappa_r": r"$\kappa_r$"}


def plot_fit(fit: xr.Dataset) -> Figure:
    """Draw the limits that `fit_tfc` found, with standard errors, against the parameter that has most values.

    Groups whose fit is refused are left out. UnusableDataError for anything but a fit, or one without a limit.
    """
    if not {"kappa_tfc", "kappa_tfc_error", "fit_status"} <= set(fit.variables) or not axes(fit):
        raise UnusableDataError("given no fit; allowed: what `gfmd fit -o` leaves")
    accepted = fit[["kappa_tfc", "kappa_tfc_error"]].isel(group=(fit["fit_status"] == "ok").values)
    if not accepted.sizes["group"]:
        raise UnusableDataError("given a fit that was refused in every group; allowed: one with a limit")
    symbol = _SYMBOLS.get(fit.attrs["variable"], str(fit.attrs["variable"]))
    return over_parameter(accepted.drop_vars("group").rename(group="case"), _limits, f"{symbol} in the TFC limit")


def _limits(groups: xr.Dataset) -> tuple[Reals, Reals]:
    return groups["kappa_tfc"].values, groups["kappa_tfc_error"].values
