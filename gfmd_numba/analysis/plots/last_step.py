"""The last step of a path in words, for the pictures that draw it alone."""

import xarray as xr

from gfmd_numba.analysis.plots.style import prefix, told

_PRESCRIBED = (
    ("reduced_pressure", "$p^*$", ""),
    ("punch_displacement", "punch displacement", "L_x"),
    ("sliding", "sliding", "L_x"),
    ("sliding_y", "sliding along $y$", "L_x"),
)


def named_last_step(dataset: xr.Dataset) -> str:
    """Return which step of a path is drawn, and its loading; nothing for a dataset without a path."""
    if dataset.sizes.get("step", 1) == 1:
        return ""
    said = f"Step {dataset.sizes['step'] - 1}, the last"
    for name, symbol, natural in _PRESCRIBED:
        if name in dataset and dataset[name].any():
            factor, unit = prefix(dataset[name], natural) if natural else (1.0, "")
            said += f", {symbol} = {told(factor * float(dataset[name][-1]), unit)}"
    return said
