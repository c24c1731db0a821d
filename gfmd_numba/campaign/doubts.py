"""Reasons to doubt a campaign, in sentences: its bodies and grids before it runs, and then what it has recorded."""

from collections.abc import Iterator, Sequence
from math import pi

import numpy as np
import xarray as xr

from gfmd_numba.arrays import Reals
from gfmd_numba.campaign.cases import Case
from gfmd_numba.contact import doubts, law_resolution
from gfmd_numba.contact.rough_surfaces import STEEPEST, rough_body
from gfmd_numba.contact.scales import scales_of
from gfmd_numba.contact.surfaces import SummedSurface
from gfmd_numba.scene import Numerics
from gfmd_numba.solvers.status import Status

# Means over the contact. 1 % of it is above `LARGEST_PRESSURE` where pressures have a Rayleigh distribution, and 13 %
# above `STEEPEST_SLOPE` where slopes have a normal one; those of a single wave are still below it
_MEAN_OF_PRESSURES, _MEAN_OF_SLOPES = doubts.LARGEST_PRESSURE / 2.42, doubts.STEEPEST_SLOPE / 1.5


def doubt_of_bodies(cases: Sequence[Case]) -> str:
    """Return warnings about slopes above the thesis's limit and about films at order 0, one sentence a line."""
    if cases[0].problem.rough is None:
        return ""
    followed = dict.fromkeys((case.problem.surface, case.problem.rough) for case in cases)
    bodies = [(surface, rough) for surface, rough in followed if isinstance(surface, SummedSurface) and rough]
    own = ((surface, body.part) for surface, rough in bodies for body in rough.bodies)
    steepest = max((surface.parts[part].rms_gradient for surface, part in own if part is not None), default=0.0)
    steep = (
        f"a deformable surface has an rms gradient of up to {steepest:.3g}, above {STEEPEST:g}: "
        "`next_order` says what the next order in the slope would add to displacements, and the error is of that size"
    )
    films = []  # by the first realisation of each surface
    for surface, rough in bodies:
        thicknesses = (body.elastic.top.aspect_ratio for body in rough.bodies)
        # thin compared with the longest waves
        if rough.order == 0 and any(each is not None and 2.0 * pi * each <= 1.0 for each in thicknesses):
            drawn = surface.drawn(0)
            films += [rough_body(body, drawn, rough.order) for body in rough.bodies]
    return "\n".join(filter(None, (steep if steepest > STEEPEST else "", doubts.too_thin(films))))


def unresolved(cases: Sequence[Case]) -> str:
    """Return a warning about interaction laws that the grids do not resolve, with the worst case; else nothing."""
    if not cases[0].scene.interface.reaches_across:
        return ""
    doubtful = [case for case in cases if law_resolution.resolution(case.problem) > law_resolution.COARSEST]
    if not doubtful:
        return ""
    worst = least_resolved(doubtful)
    return f"in {len(doubtful)} of {len(cases)} cases {law_resolution.doubt(worst.problem, worst.discretisation)}"


def least_resolved(cases: Sequence[Case]) -> Case:
    """Case whose grid resolves its law least."""
    return max(cases, key=lambda case: law_resolution.resolution(case.problem))


def of_results(cases: Sequence[Case], numerics: Numerics, dataset: xr.Dataset) -> Iterator[str]:
    """Reasons to doubt the contacts that are reported, those of the references where there are limits."""
    references = np.flatnonzero(dataset["is_reference"].values).tolist()
    found = dataset.isel(case=references).where(dataset["status"].isel(case=references) == Status.ok)
    if "time_error" in found:
        yield from filter(None, [doubts.coarse_times(numerics, _arrays(found, "time_error"))])
    if "increment_error" in found:
        yield from doubts.coarse_increments(_arrays(found, "increment_error", "largest_plastic_strain"))
    scene = cases[0].scene
    if scene.length is not None or scene.has_moduli:
        # whose mean pressure or slope is beyond the theory of small strains
        slope = found["rms_gradient_contact"].mean("realisation")
        strained, largest = slope > _MEAN_OF_SLOPES, f"the rms slope in the contact is up to {float(slope.max()):.2g}"
        if not scene.creeps:  # fast pressures strain what creeps less
            moduli = xr.DataArray([scales_of(cases[case].scene).modulus for case in references], dims="case")
            area = found["contact_area_fraction"]
            pressures = (found["mean_pressure"] / area.where(area > 0.0)).mean("realisation") / moduli
            strained = strained | (pressures > _MEAN_OF_PRESSURES)
            largest += f", and the mean pressure {float(pressures.max()):.2g} E*"
        if strained.any():
            yield (
                f"strains are no longer small in {_of_cases(strained)}, where {largest}: linear elasticity is wrong by "
                "about these fractions; check load, moduli and heights"
            )
    has_limit_of_grids = "eps_c" in dataset["limit"].values  # that takes account of narrow contacts
    if scene.interface.hard_wall is not None and not has_limit_of_grids:
        yield from _narrow(found)


def _arrays(cases: xr.Dataset, *names: str) -> dict[str, Reals]:
    return {name: cases[name].values for name in names}


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
