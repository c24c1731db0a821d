"""Analysis of campaign datasets: reads plain xarray Datasets and knows nothing of the solver."""

from gfmd_numba.analysis.channels import gap_percolation, leakage
from gfmd_numba.analysis.contact_statistics import contact_statistics
from gfmd_numba.analysis.contact_stiffness import contact_stiffness
from gfmd_numba.analysis.forms import UnusableDataError
from gfmd_numba.analysis.plots.accuracy import plot_accuracy
from gfmd_numba.analysis.plots.bodies import plot_body
from gfmd_numba.analysis.plots.campaign import plot_campaign, plot_fit
from gfmd_numba.analysis.plots.contact import plot_contact, plot_statistics
from gfmd_numba.analysis.plots.curve import plot_creep, plot_curve, plot_friction
from gfmd_numba.analysis.plots.map_image import plot_conductance, plot_leakage
from gfmd_numba.analysis.plots.rounds import plot_rounds
from gfmd_numba.analysis.plots.surface import plot_surface
from gfmd_numba.analysis.selection import ensemble_mean, select_limit
from gfmd_numba.analysis.smooth_function import smooth_function
from gfmd_numba.analysis.tfc import fit_tfc

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
    "plot_creep",
    "plot_curve",
    "plot_fit",
    "plot_friction",
    "plot_leakage",
    "plot_rounds",
    "plot_statistics",
    "plot_surface",
    "select_limit",
    "smooth_function",
]
