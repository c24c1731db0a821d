"""Work-precision diagrams: what accuracy costs in time."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

TITLES = {
    "solver residual": "Solver and residual",
    "precision": "Double and single precision",
    "damping of Verlet": "Damping and time step of Verlet",
    "eps_c": "Continuum: 1/eps_c",
    "eps_f": "Fractal: 1/eps_f",
    "eps_t": "Thermodynamic: 1/eps_t",
    "surfaces": "Number of surfaces",
}


def plot_accuracy(dataset: xr.Dataset) -> Figure:
    """Draw error in kappa against seconds for each study of `gfmd accuracy`; settings stand beside the points."""
    shown = [name for name in TITLES if name in dataset["study"].values]
    figure = Figure(figsize=(13, 4 * -(-len(shown) // 3)), layout="constrained")
    for position, name in enumerate(shown, start=1):
        axes = figure.add_subplot(-(-len(shown) // 3), 3, position)
        study = dataset.isel(point=dataset["study"].values == name)
        damping, by_residual = name == "damping of Verlet", name in ("solver residual", "precision")
        for curve in dict.fromkeys(study["curve"].values.tolist()):
            points = study.isel(point=study["curve"].values == curve)
            good = points.isel(point=(points["failed"].values == 0))
            if damping:
                axes.plot(good["setting"], good["seconds"], "o-", label=curve, markersize=4)
                continue
            # what agrees to the last bit is drawn at the lower edge
            error = np.maximum(good["error"].values, 1e-10 if by_residual else 1e-5)
            axes.plot(good["seconds"], error, "o-", label=curve, markersize=4)
            if not by_residual:
                for x, y, setting in zip(good["seconds"].values, error, good["setting"].values, strict=True):
                    label = f"{setting:g}" if name == "surfaces" else f"{1 / setting:g}"
                    axes.annotate(label, (x, y), textcoords="offset points", xytext=(4, 4), fontsize=7)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_title(TITLES[name], fontsize=10)
        axes.set_xlabel("damping over critical damping of the slowest mode" if damping else "processor time / s")
        axes.set_ylabel("processor time / s" if damping else r"relative error of $\kappa$")
        axes.grid(which="major", alpha=0.3)
        axes.tick_params(which="minor", labelsize=6)
        axes.legend(fontsize=7)
    return figure
