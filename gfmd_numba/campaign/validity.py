"""Warnings about a campaign, one sentence each: its bodies and grids before it runs, and then what it has recorded."""

from collections.abc import Iterator, Sequence
from itertools import chain
from math import pi

import numpy as np
import xarray as xr

from gfmd_numba.analysis.selection import at_nyquist
from gfmd_numba.campaign.cases import Case
from gfmd_numba.contact import relative_softening, validity
from gfmd_numba.contact.rough_surfaces import STEEPEST, rough_body
from gfmd_numba.elasticity.scales import scales_of
from gfmd_numba.roughness.surfaces import SummedSurface
from gfmd_numba.scene import Numerics
from gfmd_numba.solvers.status import Status
from gfmd_numba.text.numbers import steps_told

_SINGLE_NODES = 1.25  # mean width in nodes of contacts of which few have a second node
# Means over the contact. 1 % of it is above `LARGEST_PRESSURE` where pressures have a Rayleigh distribution, and 13 %
# above `STEEPEST_SLOPE` where slopes have a normal one; those of a single wave are still below it
_MEAN_OF_PRESSURES, _MEAN_OF_SLOPES = validity.LARGEST_PRESSURE / 2.42, validity.STEEPEST_SLOPE / 1.5
_OF_WIDTHS = ("contact_area_fraction", "contact_area_fraction_counted", "contact_area_fraction_error", "n_segments")


def rough_body_warnings(cases: Sequence[Case]) -> str:
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
    return "\n".join(filter(None, (steep if steepest > STEEPEST else "", validity.thin_film_warning(films))))


def unresolved_law_warning(cases: Sequence[Case]) -> str:
    """Return a warning about interaction laws that the grids do not resolve, with the worst case; else nothing."""
    if not cases[0].scene.interface.reaches_across:
        return ""
    affected = [case for case in cases if relative_softening.softening(case.problem) > relative_softening.COARSEST]
    if not affected:
        return ""
    worst = least_resolved(affected)
    return f"in {len(affected)} of {len(cases)} cases {relative_softening.warning(worst.problem, worst.discretisation)}"


def least_resolved(cases: Sequence[Case]) -> Case:
    """Case whose grid resolves its law least."""
    return max(cases, key=lambda case: relative_softening.softening(case.problem))


def result_warnings(cases: Sequence[Case], numerics: Numerics, dataset: xr.Dataset) -> Iterator[str]:
    """Warnings about the contacts that are reported, those of the references where there are limits."""
    references = np.flatnonzero(dataset["is_reference"].values).tolist()
    found = _ok(dataset.isel(case=references))
    told = chain(
        validity.coarse_times(numerics, found),
        validity.coarse_flow(found),
        validity.at_the_edge(found),
        validity.past_asperities(found),
    )
    for affected, sentence in told:
        if np.any(affected):
            yield f"in {_of_cases(xr.DataArray(affected))}: {sentence}"
    scene = cases[0].scene
    if scene.length is not None or scene.has_moduli:
        read = found.variables
        # whose mean pressure or slope is beyond the theory of small strains
        slope = read["rms_gradient_contact"].mean("realisation")
        strained, largest = slope > _MEAN_OF_SLOPES, f"the rms slope in the contact is up to {float(slope.max()):.2g}"
        if not scene.creeps:  # fast pressures strain what creeps less
            moduli = xr.Variable("case", [scales_of(cases[case].scene).modulus for case in references])
            area = read["contact_area_fraction"]
            pressures = (read["mean_pressure"] / area.where(area > 0.0)).mean("realisation") / moduli
            strained = strained | (pressures > _MEAN_OF_PRESSURES)
            largest += f", and the mean pressure {float(pressures.max()):.2g} E*"
        if strained.any():
            yield (
                f"strains are no longer small in {_of_cases(strained)}, where {largest} (small are up to "
                f"{_MEAN_OF_SLOPES:.1g} and {_MEAN_OF_PRESSURES:.1g} E*): linear elasticity is wrong by about these "
                "fractions; check load, moduli and heights"
            )
    if scene.interface.hard_wall is None:
        return
    if "eps_c" not in dataset["limit"].values:
        yield from _narrow(found)
        return
    # a limit in eps_c takes account of narrow contacts, but not of those of single nodes at a level that is fitted
    fitted = (dataset["is_reference"] | ~at_nyquist(dataset["eps_c"])).values
    yield from _narrow(_ok(dataset[["status", *_OF_WIDTHS]].isel(case=fitted)), of_limit=True)


def _ok(dataset: xr.Dataset) -> xr.Dataset:
    """The results that are ok, others nan; variable by variable, as none has to be aligned."""
    ok = dataset.variables["status"] == Status.ok
    return dataset.assign({name: dataset.variables[name].where(ok) for name in dataset.data_vars})


def _narrow(cases: xr.Dataset, of_limit: bool = False) -> Iterator[str]:
    """A warning about contacts that are hardly wider than a node, whose means differ by more than their errors say."""
    read = cases.variables
    dimension = int(read["dimension"].max())
    area = read["contact_area_fraction"].sum("realisation")
    counted = (read["contact_area_fraction_counted"] * read["nx"] ** dimension).sum("realisation")
    segments = read["n_segments"].sum("realisation")
    width = (counted / segments.where(segments > 0)) ** (1.0 / dimension)
    known = (read["contact_area_fraction_error"] ** 2).sum("realisation") ** 0.5 / area.where(area > 0.0)
    off = known.fillna(0.0).where(~(width < validity.NARROW), np.maximum(known.fillna(0.0), validity.LARGEST_OFF))
    narrow = width < _SINGLE_NODES if of_limit else off > validity.LEAST_OFF
    if narrow.any():
        narrowest = float(width.min())
        wrong = validity.off_by(narrowest, float(off.max()))
        finer = "a finer eps_c" if "eps_c" in cases.coords else "more points"
        if of_limit:
            wrong, finer = f"{wrong}, and a limit from them too", "finer levels, or a higher pressure"
        yield (
            f"{validity.NARROW_CONTACTS} in {_of_cases(narrow)}, {narrowest:.1f} nodes wide on average where they are "
            f"narrowest: the contact area, and kappa with it, {wrong}, whatever the printed errors say; take {finer}"
        )


def _of_cases(affected: xr.DataArray | xr.Variable) -> str:
    """How many cases are affected at any step, and at which."""
    affected = affected.any([dim for dim in affected.dims if dim not in ("case", "step")])
    cases = affected.any([dim for dim in affected.dims if dim == "step"])
    steps = affected.any("case").values
    where = steps_told(np.atleast_1d(steps).tolist(), steps.size - 1)
    return f"{int(cases.sum())} of {cases.size} cases{where and f', in {where}'}"
