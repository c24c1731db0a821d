"""Made-up results of campaigns with cross levels."""

import xarray as xr

from support.synthetic_campaigns import ALPHA, REFERENCE, C, campaign

LEVELS = {"eps_c": [1 / 2, 1 / 4, 1 / 8], "eps_f": [1 / 512, 1 / 1024, 1 / 2048], "eps_t": [1, 1 / 2, 1 / 4]}


def crossed(*levels, n=40):
    """Noise-free campaign with cross levels, whose corrections add up."""
    dataset = campaign(levels=LEVELS, realisations=n)
    parts = [dataset]
    for number, level in enumerate(levels):
        case = dataset.isel(case=[0]).copy(deep=True)
        added = [C[axis] * (eps ** ALPHA[axis] - REFERENCE[axis] ** ALPHA[axis]) for axis, eps in level.items()]
        case["kappa"] += sum(added)
        for name, value in {"limit": "cross", "is_reference": False, "case_id": f"cross-{number}", **level}.items():
            case[name] = ("case", [value], dataset[name].attrs)
        parts.append(case)
    return xr.concat(parts, "case")
