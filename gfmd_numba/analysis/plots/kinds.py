"""The table of what can be drawn without a fit: what tells a kind of dataset, and its picture."""

from collections.abc import Callable

import xarray as xr
from matplotlib.figure import Figure

from gfmd_numba.analysis.plots.accuracy import plot_accuracy
from gfmd_numba.analysis.plots.bodies import plot_body, plot_flow, plot_loaded_body
from gfmd_numba.analysis.plots.campaign import plot_fit
from gfmd_numba.analysis.plots.contact import plot_contact, plot_statistics
from gfmd_numba.analysis.plots.curve import plot_curve
from gfmd_numba.analysis.plots.map_image import plot_conductance, plot_leakage
from gfmd_numba.analysis.plots.path import plot_path
from gfmd_numba.analysis.plots.rounds import plot_rounds
from gfmd_numba.analysis.plots.surface import plot_surface

Draw = Callable[..., Figure]  # draws a dataset, as it suits a screen or in the `width` of a journal's column
KINDS: dict[str, tuple[str, Draw]] = {  # a variable that no later kind has
    "fields inside a body": ("von_mises", plot_body),
    "body that flows": ("equivalent_plastic_strain", plot_flow),
    "surface": ("spectral_density", plot_surface),
    "accuracy": ("study", plot_accuracy),
    "statistics of a contact": ("pressure_density", plot_statistics),
    "leakage": ("local_flow", plot_leakage),
    "conductance": ("current_density", plot_conductance),
    "load curve": ("prescribed_load", plot_curve),
    "fit": ("fit_status", plot_fit),
    "loaded body": ("normal_traction", plot_loaded_body),
    "loading path": ("step", plot_path),
    "creep curve": ("time", plot_curve),
    "friction curve": ("speed", plot_curve),
    "contact": ("pressure", plot_contact),
}


def picture_of(dataset: xr.Dataset) -> Draw | None:
    """Function that draws this kind of dataset; None for one that is drawn with its fit: a campaign without a path."""
    if "case" in dataset.dims and "step" not in dataset.dims:
        return None
    tells = {*dataset.dims, *(name for name, each in dataset.variables.items() if each.dims)}
    return next((draw for variable, draw in KINDS.values() if variable in tells), None)


def second_picture_of(dataset: xr.Dataset) -> tuple[str, Draw] | None:
    """What the name of a second picture ends in, and the function that draws it; None where one picture shows all."""
    if "round" in dataset.dims and (dataset["round_error"] > 0).any():
        return "rounds", plot_rounds
    return ("last-step", plot_contact) if picture_of(dataset) is plot_path and "pressure" in dataset else None
