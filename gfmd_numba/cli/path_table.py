"""What a campaign along a loading path has found, as a table on the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gfmd_numba.cli.arguments import LIMITS
from gfmd_numba.cli.columns import print_table
from gfmd_numba.cli.quantities import column
from gfmd_numba.cli.sentences import say
from gfmd_numba.cli.tables import MOST_ROWS, cells_of_parameters

if TYPE_CHECKING:
    import xarray as xr

_SHOWN = (
    *("pull_off_pressure", "hysteresis", "mean_tangential_traction", "mean_tangential_traction_y", "stick_fraction"),
    *("contact_area_fraction", "mean_plastic_depth"),
)


def show_paths(dataset: xr.Dataset) -> None:
    """Print the means of every case: what its path lost and pulled, and what of the contact its last step left.

    Of a campaign with limits only the references are shown.
    """
    from gfmd_numba.analysis import ensemble_mean

    if LIMITS.keys() & set(dataset["limit"].values):
        dataset = dataset.isel(case=dataset["is_reference"].values)
    shown = dataset.isel(case=slice(MOST_ROWS), step=-1)
    names = [name for name in _SHOWN if name in dataset]
    means = shown.drop_vars(names)
    for name in names:
        mean, error = ensemble_mean(shown, name)
        means[name], means[f"{name}_standard_error"] = ("case", mean, dataset[name].attrs), ("case", error)
    steps = dataset.sizes["step"] - 1
    print_table(
        f"end of the path of {steps} steps, mean of the realisations (one standard error)",
        cells_of_parameters(shown, dataset),
        dict(column(means, name) for name in names),
    )
    if dataset.sizes["case"] > MOST_ROWS:
        say("note", f"{dataset.sizes['case'] - MOST_ROWS} more cases are in the file")
