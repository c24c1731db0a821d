"""Analysis of campaign datasets: reads plain xarray Datasets and knows nothing of the solver."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from gfmd_numba.analysis.contact_statistics import contact_statistics
from gfmd_numba.analysis.contact_stiffness import contact_stiffness
from gfmd_numba.analysis.extrapolation import fit_tfc
from gfmd_numba.analysis.forms import UnusableDataError
from gfmd_numba.analysis.selection import ensemble_mean, select_limit
from gfmd_numba.analysis.smooth_function import smooth_function

if TYPE_CHECKING:
    from gfmd_numba.analysis.channels import gap_percolation, leakage
    from gfmd_numba.analysis.plots.accuracy import plot_accuracy
    from gfmd_numba.analysis.plots.bodies import plot_body
    from gfmd_numba.analysis.plots.campaign import plot_campaign, plot_fit
    from gfmd_numba.analysis.plots.contact import plot_contact, plot_statistics
    from gfmd_numba.analysis.plots.curve import plot_curve
    from gfmd_numba.analysis.plots.map_image import plot_conductance, plot_leakage
    from gfmd_numba.analysis.plots.rounds import plot_rounds
    from gfmd_numba.analysis.plots.surface import plot_surface

_LATER = {  # by their module, which is loaded with the first that is asked for: Matplotlib and sparse solvers take time
    "channels": ("gap_percolation", "leakage"),
    "plots.accuracy": ("plot_accuracy",),
    "plots.bodies": ("plot_body",),
    "plots.campaign": ("plot_campaign", "plot_fit"),
    "plots.contact": ("plot_contact", "plot_statistics"),
    "plots.curve": ("plot_curve",),
    "plots.map_image": ("plot_conductance", "plot_leakage"),
    "plots.rounds": ("plot_rounds",),
    "plots.surface": ("plot_surface",),
}

__all__ = [
    "UnusableDataError",
    "contact_statistics",
    "contact_stiffness",
    "ensemble_mean",
    "fit_tfc",
    "gap_percolation",
    "leakage",
    "plot_accuracy",
    "plot_body",
    "plot_campaign",
    "plot_conductance",
    "plot_contact",
    "plot_curve",
    "plot_fit",
    "plot_leakage",
    "plot_rounds",
    "plot_statistics",
    "plot_surface",
    "select_limit",
    "smooth_function",
]


def __getattr__(name: str) -> Any:
    """Return a function whose module is loaded late; raises AttributeError for what is not here."""
    for module, names in _LATER.items():
        if name in names:
            return getattr(import_module(f"{__name__}.{module}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """Return the names that are public."""
    return __all__
