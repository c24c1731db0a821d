"""Analysis of campaign datasets: reads plain xarray Datasets and knows nothing of the solver."""

from importlib import import_module
from typing import Any

from gfmd_numba.analysis.contact_statistics import contact_statistics
from gfmd_numba.analysis.extrapolation import fit_tfc
from gfmd_numba.analysis.forms import UnusableDataError
from gfmd_numba.analysis.secant_stiffness import secant_stiffness
from gfmd_numba.analysis.selection import ensemble_mean, select_limit
from gfmd_numba.analysis.smooth_function import smooth_function

_LATER = {  # by their modules, which are loaded when they are asked for: Matplotlib and sparse solvers take time
    **dict.fromkeys(("gap_percolation", "leakage"), "channels"),
    "plot_accuracy": "plots.accuracy",
    "plot_body": "plots.bodies",
    **dict.fromkeys(("plot_campaign", "plot_fit"), "plots.campaign"),
    **dict.fromkeys(("plot_contact", "plot_statistics"), "plots.contact"),
    "plot_curve": "plots.curve",
    **dict.fromkeys(("plot_conductance", "plot_leakage"), "plots.map_image"),
    "plot_rounds": "plots.rounds",
    "plot_surface": "plots.surface",
}
__all__ = ["UnusableDataError", "contact_statistics", "ensemble_mean", "fit_tfc", "secant_stiffness", "select_limit"]
__all__ += ["smooth_function", *_LATER]  # noqa: PLE0604


def __getattr__(name: str) -> Any:
    """Return a function whose module is loaded late; raises AttributeError for what is not here."""
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_LATER[name]}"), name)


def __dir__() -> list[str]:
    """Return the names that are public."""
    return __all__
