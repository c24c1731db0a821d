"""What can be said of the limit of a campaign before it runs: the fit itself looks at its cases."""

import numpy as np
import xarray as xr

from gfmd_numba.analysis.tfc import refusals
from gfmd_numba.campaign.coordinates import described_coordinates
from gfmd_numba.campaign.plan import Plan


def refused_limits(planned: Plan) -> list[str]:
    """Return a sentence for each reason for which the fit is going to refuse the limit; none without limits."""
    cases = planned.cases
    if all(case.limit == "reference" for case in cases):
        return []
    coordinates, ones = described_coordinates(cases[0].scene, cases), np.ones((len(cases), 1))
    found = []
    for fit, _ in planned.campaign.fits():
        described = xr.Dataset({fit.variable: (("case", "realisation"), ones)}, coordinates)
        for reason, count in refusals(described, fit.variable, fit.exponents, fit.options["fixed"]).items():
            groups = f"{count} group{'s' * (count > 1)} of cases"
            found.append(f"a run will print no limit of {fit.variable} ({groups}): {'; '.join(reason.splitlines())}")
    return found
