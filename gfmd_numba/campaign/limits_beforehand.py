"""What can be said of the limit of a campaign before it runs: the fit itself looks at its cases."""

import numpy as np
import xarray as xr

from gfmd_numba.analysis.tfc import refusals
from gfmd_numba.campaign.coordinates import described_coordinates
from gfmd_numba.campaign.plan import Plan


def refused_limits(planned: Plan) -> list[str]:
    """Return a sentence for each reason for which the fit is going to refuse the limit; none without limits."""
    cases, fit = planned.cases, planned.campaign.fit
    if all(case.limit == "reference" for case in cases):
        return []
    values = xr.Dataset({fit.variable: (("case", "realisation"), np.ones((len(cases), 1)))})
    described = values.assign_coords(described_coordinates(cases[0].scene, cases))
    fixed = {name: exponent for name, exponent in fit.fixed if exponent is not None}
    found = refusals(described, fit.variable, fit.exponents, fixed)
    return [
        f"a run will print no limit of {fit.variable} ({count} group{'s' * (count > 1)} of cases): "
        + "; ".join(reason.splitlines())
        for reason, count in found.items()
    ]
