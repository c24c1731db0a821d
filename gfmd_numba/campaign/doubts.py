"""Reasons to doubt the contacts of a campaign, in sentences, from what it has recorded of them."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from gfmd_numba.campaign.plan import Plan
from gfmd_numba.contact import doubts
from gfmd_numba.contact.scales import scales_of
from gfmd_numba.solvers.status import Status

# Means over the contact. 1 % of it is above `LARGEST_PRESSURE` where pressures have a Rayleigh distribution, and 13 %
# above `STEEPEST_SLOPE` where slopes have a normal one; those of a single wave are still below it
_MEAN_OF_PRESSURES, _MEAN_OF_SLOPES = doubts.LARGEST_PRESSURE / 2.42, doubts.STEEPEST_SLOPE / 1.5


def of_results(planned: Plan, dataset: xr.Dataset) -> Iterator[str]:
    """Reasons to doubt the contacts that are reported, those of the references where there are limits."""
    references = np.flatnonzero(dataset["is_reference"].values)
    cases = dataset.isel(case=references).where(dataset["status"].isel(case=references) == Status.ok)
    if "time_error" in cases:
        yield from filter(None, [doubts.coarse_times(planned.campaign.numerics, _arrays(cases, "time_error"))])
    if "increment_error" in cases:
        yield from doubts.coarse_increments(_arrays(cases, "increment_error", "largest_plastic_strain"))
    scene = planned.cases[0].scene
    if scene.length is not None or scene.has_moduli:
        moduli = np.array([scales_of(planned.cases[case].scene).modulus for case in references])
        yield from _large_strains(cases, None if scene.creeps else moduli)  # fast pressures strain what creeps less
    if (
        scene.interface.hard_wall is not None and "eps_c" not in dataset["limit"].values
    ):  # whose limit takes account of it
        yield from _narrow(cases)


def _arrays(cases: xr.Dataset, *names: str) -> dict[str, np.ndarray]:
    return {name: cases[name].values for name in names}


def _large_strains(cases: xr.Dataset, moduli: np.ndarray | None) -> Iterator[str]:
    """A warning about contacts whose mean pressure or slope is beyond the theory of small strains."""
    slope = cases["rms_gradient_contact"].mean("realisation")
    strained, largest = slope > _MEAN_OF_SLOPES, f"the rms slope in the contact is up to {float(slope.max()):.2g}"
    if moduli is not None:
        area = cases["contact_area_fraction"]
        pressures = (cases["mean_pressure"] / area.where(area > 0.0)).mean("realisation")
        pressures = pressures / xr.DataArray(moduli, dims="case")
        strained = strained | (pressures > _MEAN_OF_PRESSURES)
        largest += f", and the mean pressure {float(pressures.max()):.2g} E*"
    if strained.any():
        yield (
            f"strains are no longer small in {_of_cases(strained)}, where {largest}: linear elasticity is wrong by "
            "about these fractions; check load, moduli and heights"
        )


def _narrow(cases: xr.Dataset) -> Iterator[str]:
    """A warning about contacts that are hardly wider than a node, whose means differ by more than their errors say."""
    dimension = int(cases["dimension"].max())
    area = cases["contact_area_fraction"].sum("realisation")
    counted = (cases["contact_area_fraction_counted"] * cases["nx"] ** dimension).sum("realisation")
    segments = cases["n_segments"].sum("realisation")
    width = (counted / segments.where(segments > 0)) ** (1.0 / dimension)
    known = (cases["contact_area_fraction_error"] ** 2).sum("realisation") ** 0.5 / area.where(area > 0.0)
    off = known.fillna(0.0).where(~(width < doubts.NARROW), np.maximum(known.fillna(0.0), doubts.LARGEST_OFF))
    narrow = off > doubts.LEAST_OFF
    if narrow.any():
        narrowest = float(width.min())
        wrong = doubts.off_by(narrowest, float(off.max()))
        finer = "a finer eps_c" if "eps_c" in cases.coords else "more points"
        yield (
            f"{doubts.NARROW_CONTACTS} in {_of_cases(narrow)}, {narrowest:.1f} nodes wide on average where they are "
            f"narrowest: the contact area, and kappa with it, {wrong}, whatever the printed errors say; take {finer}"
        )


def _of_cases(doubtful: xr.DataArray) -> str:
    """How many cases are doubtful at any step."""
    cases = doubtful.any([dim for dim in doubtful.dims if dim != "case"])
    return f"{int(cases.sum())} of {cases.size} cases"
