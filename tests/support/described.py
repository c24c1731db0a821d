"""Made-up campaigns whose coordinates say what they are, as those that gfmd writes do."""

from gfmd_numba.campaign.axes import AXES


def with_axes(dataset):
    """Dataset whose coordinates have the attributes of the table of axes."""
    described = dataset.copy()
    for rank, axis in enumerate(AXES):
        if axis.coordinate in described.coords:
            described[axis.coordinate].attrs = {
                "long_name": axis.long_name,
                "units": "1",
                "symbol": axis.symbol,
                "label": axis.label,
                "axis": "physics" if axis.forms_groups else "discretisation",
                "rank": rank,
            }
    return described
