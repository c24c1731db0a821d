"""Figure of a fit: its variable in the limit against a parameter, drawn without pyplot so that no state is shared."""

from typing import Annotated

import xarray as xr
from matplotlib.figure import Figure

from gfmd_numba.analysis.arguments import checked
from gfmd_numba.analysis.fit_dataset import in_the_limit
from gfmd_numba.analysis.forms import FIT, UnusableDataError
from gfmd_numba.analysis.plots.parameter import over_parameter
from gfmd_numba.analysis.plots.style import with_unit
from gfmd_numba.analysis.selection import axes
from gfmd_numba.arrays import Reals

_SYMBOLS = {"kappa": r"$\kappa$", "kappa_counted": r"$\kappa$ of counted nodes", "kappa_r": r"$\kappa_r$"}


@checked
def plot_fit(fit: Annotated[xr.Dataset, FIT]) -> Figure:
    """Draw the limits that `fit_tfc` found, with standard errors, against the parameter that has most values.

    Groups whose fit is refused are left out. UnusableDataError for anything but a fit, or one without a limit.
    """
    variable = str(fit.attrs.get("variable"))
    if not {f"{variable}_tfc", f"{variable}_tfc_error", "fit_status"} <= set(fit.variables) or not axes(fit):
        raise UnusableDataError("you gave no fit; gfmd allows what `gfmd fit -o` leaves")
    accepted = fit[[f"{variable}_tfc", f"{variable}_tfc_error"]].isel(group=(fit["fit_status"] == "ok").values)
    if not accepted.sizes["group"]:
        raise UnusableDataError("you gave a fit that was refused in every group; gfmd allows one with a limit")
    label = with_unit(f"{_SYMBOLS.get(variable, variable)} in the TFC limit", fit[f"{variable}_tfc"])
    return over_parameter(accepted.drop_vars("group").rename(group="case"), _limits, label)


def _limits(groups: xr.Dataset) -> tuple[Reals, Reals]:
    value, error = in_the_limit(groups)
    return value.values, error.values
