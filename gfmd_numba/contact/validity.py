"""Warnings about a solved contact, a sentence each: effects that linear elasticity, the grid or orders leave out."""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from math import ceil, dist, inf, nan, sqrt
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gfmd_numba.arrays.regions import closed
from gfmd_numba.contact import relative_softening
from gfmd_numba.contact.area_correction import edge, radius
from gfmd_numba.contact.contact_input import ContactInput, Input
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.rough_surfaces import STEEPEST, RoughBody, change_of_thickness
from gfmd_numba.contact.solution import condensed_stiffness
from gfmd_numba.roughness import statistics
from gfmd_numba.scene import Numerics
from gfmd_numba.scene.records import TIME_TOLERANCE
from gfmd_numba.solvers.status import Status
from gfmd_numba.text.numbers import steps_told, with_prefix

# of E*, of slopes and of the contact: strains are about as large as either, and few nodes are those of sharp edges
LARGEST_PRESSURE, STEEPEST_SLOPE, LARGEST_SHARE = 0.2, 0.3, 0.01
LARGEST_UNLOCATED, LARGEST_OF_THE_WORK = 0.1, 1e-3
NEGLIGIBLE = 1e-3  # of the largest displacement: what the next order in the slope may change
FEWEST_SUBLAYERS, LARGEST_INCREMENT_ERROR, LARGEST_STRAIN = 4, 0.03, 0.1
RESOLVED_LIMIT = 1e4  # of the largest pressure times the residual: such a shear strength is known to 1e-4
FAR_FROM_BRANCHES = 100.0  # times beyond relaxation times by which a body is fully relaxed, or glassy
FARTHEST = 0.25  # of the distance of two peaks, from a peak to where the mean plane is

FEWEST = 6  # nodes across a contact under a form: with 7 the radius of Hertz is right to 6 %, with 5 to 30 %
# Nodes: narrower stretches have areas 8 to 33 % too large, for H = 0.3 and 0.8 and p* from 0.002 to 0.1
NARROW, LEAST_OFF, LARGEST_OFF = 2.0, 0.05, 0.3
# contacts of a measured field, unless as much of it touches, or Nayak's parameter is that of waves or noise
FEW, _MOSTLY_CLOSED, _ROUGH = 5, 0.5, 5.0
_OF_FEW = 0.5  # of areas, over the root of the mean number of contacts: 0.5 to 0.8 on lines (H = 0.3, 0.8; 3 to 50)
NARROW_CONTACTS = "contacts are narrow on this grid"
FEW_NODES = "the grid has too few nodes for the contact"

_A_NODE = 1.5  # width in nodes of what is hardly more than single ones
_UNKNOWN_EDGES = 0.05  # of the contact area
_HIGHEST_ORDER = 3
_NORMAL_DISPLACEMENTS = ("displacement", "counter_body_displacement", "normal_displacement")
THICKNESS = 0.01  # change of a film's thickness, over the thickness, above which order 0 is warned about

Found = Mapping[Any, Any]  # values of a dataset, whose last axes are those of the nodes
Told = tuple[Any, str]  # which of the steps, or of other axes before the nodes, have a sentence


def path_warnings(given: ContactInput, problem: Problem, dataset: xr.Dataset) -> str:
    """Return the warnings about the steps of a path, one sentence a line, and behind it the steps that have it."""
    last = len(given.file.path)
    found = {str(name): variable.values for name, variable in dataset.variables.items()}
    ends, order = given.file.scene.ends, given.surfaces.order
    told = [
        *(rough_body_warnings(given.bodies, order, ends, dataset) if given.bodies else ()),
        *coarse_times(given.file.numerics, found),
        *_coarse_flow(given, found),
        *_beyond_small_strains(given, found),
        *((True, line) for line in _outside_branches(given, found)),
        *(list(_few_nodes(given, found)) or _narrow(given, found)),
        *_sharp_peak(given, found),
        *_few_contacts(given, found),
        *_weak_interface(given, found),
        *_overlap(given, found),
        *_closer_than_known(given, found),
        *at_the_edge(found),
        *past_asperities(found),
        *_short_stretches(problem, found),
    ]
    steps = ((line, steps_told(np.atleast_1d(affected).tolist(), last)) for affected, line in told if np.any(affected))
    lines = [f"{line} (in {where})" if where else line for line, where in steps]
    return "\n".join([*input_warnings(given), *lines, *filter(None, [_coarse_steps(given, found)])])


def _nodes(given: ContactInput) -> tuple[int, ...]:
    """Axes of the nodes of each field."""
    return tuple(range(-given.file.scene.dimension, 0))


def _largest(values: NDArray[Any], axes: tuple[int, ...] | None = None) -> Any:
    """Return the largest of the values that are known, along some axes or of all, nan where none is."""
    return np.fmax.reduce(np.asarray(values), axes)


def _smallest(values: NDArray[Any], axes: tuple[int, ...] | None = None) -> Any:
    """Return the smallest of the values that are known, along some axes or of all, nan where none is."""
    return np.fmin.reduce(np.asarray(values), axes)


def input_warnings(given: Input) -> list[str]:
    """Warnings about a scene that are known before it is solved: of its surfaces, its load and its grid."""
    found = given.doubts
    if not isinstance(given, ContactInput):
        return found
    coarse = relative_softening.warning(given.reduced[0], given.file.discretisation)
    return [*found, *filter(None, (_mirrored_load(given), coarse))]


def _mirrored_load(given: ContactInput) -> str:
    scene = given.file.scene
    unit = {"force": "N", "line_load": "N/m"}.get(scene.loading.control)
    if scene.length is None or unit is None or scene.fields_in_period == 1 or scene.form is not None:
        return ""
    side, there = with_prefix(scene.length, "m", 3), with_prefix(scene.length**-scene.dimension, "Pa", 3)
    period, nominal = side, "1 kPa for 1 N/m on 1 mm"
    if unit == "N":
        period, nominal = f"{side} x {side}", "1 MPa for 1 N on 1 mm^2"
    return (
        f"a {scene.loading.control} acts on the mirrored period of {period}: 1 {unit} makes {there} there; if yours "
        f"acts on a field of another size, give a pressure, {nominal}"
    )


def _few_contacts(given: ContactInput, found: Found) -> Iterator[Told]:
    scene, counts = given.file.scene, found["n_segments"]
    designs = [surface.is_design for surface in given.measured]
    is_rough = False in designs and "nayak" in found and _largest(found["nayak"]) > _ROUGH
    touching = counts > 0  # at the steps of a path, of which the first may be at first touch
    average = float(counts[touching].mean() / scene.fields_in_period) if touching.any() else nan
    closed = _largest(found["contact_area_fraction_counted"]) > _MOSTLY_CLOSED
    if is_rough and average < FEW and not closed and scene.form is None and scene.interface.hard_wall is not None:
        yield (
            touching & (counts / scene.fields_in_period < FEW),
            f"few asperities of the measured field touch, {average:.2g} on average: on another field area, "
            f"gap, conductance and leakage would differ by {_OF_FEW / sqrt(average):.0%} or more: measure a larger "
            "one, or take larger loads",
        )


def coarse_times(numerics: Numerics, found: Found) -> Iterator[Told]:
    """Yield a warning about steps in time whose divisions do not reach the tolerance."""
    tolerance = numerics.time_tolerance or TIME_TOLERANCE
    if "time_error" in found:
        yield (
            found["time_error"] > tolerance,
            f"the divisions of steps leave an error of {_largest(found['time_error']):.2g} of pressures or "
            f"displacements, above the tolerance of {tolerance:g}: divide the longest steps of the path, or ask for a "
            "larger numerics.time_tolerance",
        )


def _coarse_steps(given: ContactInput, found: Found) -> str:
    laws, jump = given.file.scene.interface, next((name for name in found if name.startswith("jump_")), None)
    loses = laws.friction is not None or laws.cohesive is not None or given.file.scene.creeps
    # one step alone tells nothing of the way to it
    if jump is None or np.ndim(found[jump]) == 0 or loses or laws.hardness is not None:
        return ""
    lost = np.nan_to_num(found["energy_lost"])
    without = np.where(np.isnan(found[jump]), lost, 0.0)
    whole, apart = lost.sum(), without.sum()
    work = _largest(abs(found["mean_pressure"])) * np.nansum(abs(np.diff(found["mean_gap"])))
    if not apart > max(LARGEST_UNLOCATED * whole, LARGEST_OF_THE_WORK * work):
        return ""
    where = steps_told(list(without > LARGEST_UNLOCATED * apart), len(given.file.path))
    return (
        f"{apart / whole:.0%} of the energy that the path seems to lose lies in steps without a jump (most in "
        f"{where or 'all of them'}), where forces between the ends are unknown and little or nothing is lost: take "
        "shorter steps there"
    )


def _coarse_flow(given: ContactInput, found: Found) -> Iterator[Told]:
    yield from coarse_flow(found)
    if "equivalent_plastic_strain" not in found:
        return
    nodes = _nodes(given)
    flows = np.moveaxis(found["equivalent_plastic_strain"] > 0.0, nodes[0] - 1, 0)  # the depth comes first
    deep = flows.sum(0).max(nodes)
    if deep.max() < FEWEST_SUBLAYERS:
        yield (
            deep > 0,
            f"what has flowed is at most {deep.max()} sublayers deep: give more body.plasticity.sublayers, or a "
            "smaller depth",
        )


def coarse_flow(found: Found) -> Iterator[Told]:
    """Yield warnings about plastic flow that leaves its layer, that increments do not resolve, or that is large."""
    if "increment_error" not in found:
        return
    strain, error = found["largest_plastic_strain"], _largest(found["increment_error"])
    if not error <= LARGEST_INCREMENT_ERROR:
        known = f"are off by about {error:.2g}" if np.isfinite(error) else "are off by an unknown error"
        yield (
            (strain > 0.0) & ~(found["increment_error"] <= LARGEST_INCREMENT_ERROR),
            f"pressures or residual displacements {known}, because strains turn within an increment: give more "
            "body.plasticity.increments",
        )
    yield (
        found["plastic_strain_at_base"] > 0.0,
        "the body flows down to the lowest sublayer, and would flow further: give a larger body.plasticity.depth",
    )
    yield (
        strain > LARGEST_STRAIN,
        f"the largest plastic strain is {_largest(strain):.2g}, where strains are taken to be small: stresses and "
        "residual displacements next to it are off by about this share",
    )


def _short_stretches(problem: Problem, found: Found) -> Iterator[Told]:
    shape = problem.surface.shape
    short = edge(partial(condensed_stiffness, problem), 1.0 / shape[-1]).short
    across = _mean_width(found, shape)
    unknown = 2.0 * len(shape) * short / across**2
    yield (
        unknown > _UNKNOWN_EDGES,
        f"contacts are {_smallest(across):.2g} node spacings wide on average, on a body thin against these: the "
        f"correction for their edges leaves {100.0 * _largest(unknown):.2g} % of the contact area unknown, so refine "
        "the grid",
    )


def _mean_width(found: Found, shape: tuple[int, ...]) -> NDArray[Any]:
    """Mean width of touching stretches or clusters of each step, in nodes: inf where all touch, nan where none do."""
    touching = found["contact_area_fraction_counted"] * np.prod(shape)
    counts = found["n_segments"]
    areas: NDArray[Any] = np.divide(touching, counts, out=np.where(touching > 0, inf, nan), where=counts > 0)
    return areas ** (1.0 / len(shape))


def _narrow(given: ContactInput, found: Found) -> Iterator[Told]:
    """Yield a warning about contacts of a rough surface that are hardly wider than a node.

    Few contacts of a profile lie anywhere within a node; of many narrow ones the mean correction for edges is too
    small.
    """
    scene, discretisation = given.file.scene, given.file.discretisation
    if scene.interface.hard_wall is None or not scene.surfaces:
        return
    widths = _mean_width(found, found["gap"].shape[_nodes(given)[0] :])
    areas, errors = found["contact_area_fraction"], found["contact_area_fraction_error"]
    known = np.isfinite(areas) & (areas > 0.0) & np.isfinite(errors)
    uncertain = np.divide(errors, areas, out=np.zeros(areas.shape), where=known)
    off = np.maximum(uncertain, np.where(widths < NARROW, LARGEST_OFF, 0.0))
    finer = f"points: {2 * found['x'].size} or more"
    if given.measured:
        finer += " of the measured surface with a cutoff of at least 4 of its spacings, or a larger cutoff"
    if discretisation is not None:
        finer = f"eps_c = 1/{ceil(2 / discretisation.eps_c)} or finer"
    width = _smallest(widths)
    yield (
        off > LEAST_OFF,
        f"{NARROW_CONTACTS}, {width:.1f} nodes wide on average: the contact area {off_by(width, off.max())}, and the "
        f"peak pressure too; take {finer}",
    )


def _sharp_peak(given: ContactInput, found: Found) -> Iterator[Told]:
    """Yield a warning about a measured surface of which a touching node sticks out."""
    scene, axes = given.file.scene, _nodes(given)
    rough = [surface for surface in given.measured if not surface.is_design]
    if (
        not rough
        or len(given.measured) < len(scene.surfaces)
        or scene.interface.hard_wall is None
        or scene.interface.reaches_across
    ):
        return
    pressure, sound = found["pressure"], found["status"] == Status.ok
    if "plastic_area_fraction" in found:  # where any node yields, the largest pressure is the hardness on any grid
        sound = sound & (found["plastic_area_fraction"] == 0.0)
    sharp = np.zeros(sound.shape, dtype=bool)
    near, far = statistics.bends(found["height"], scene.ends)
    bears = np.where(pressure > 0.0, abs(near), -1.0)
    every = (*pressure.shape[: -len(axes)], -1)
    for places in (pressure, bears):  # of the largest pressure, and the sharpest: on a finer grid that may bear more
        node = np.argmax(places.reshape(every), axis=-1, keepdims=True)
        one, two, load = (np.take_along_axis(each.reshape(every), node, -1)[..., 0] for each in (near, far, pressure))
        sharp |= (abs(one) > statistics.SHARP * abs(two)) & (load > 0.0) & sound
    yield (
        sharp,
        "nodes that touch stick out of their neighbours, as at edges of grooves: with more nodes the largest pressure "
        "may be up to twice as large, and the contact area off by 15 %, so measure with a smaller spacing, or take a "
        "cutoff of at least 4 nodes",
    )


def off_by(width: float, off: float) -> str:
    """Say by how much areas of contacts are off, which have a width in nodes: a finer grid may find a third of some."""
    return "may be that of single nodes" if width < _A_NODE else f"may be off by {100.0 * off:.2g} %"


def _beyond_small_strains(given: ContactInput, found: Found) -> Iterator[Told]:
    """Yield a warning where the pressure or the slope of much of the contact is beyond the theory of small strains.

    Without a length or moduli, heights and pressures have a scale that is free: then mean pressures above E* count.
    """
    scene, nodes = given.file.scene, _nodes(given)
    name = "relaxed_pressure" if "relaxed_pressure" in found else "pressure"  # fast pressures strain less
    ratios = np.where(np.isfinite(found[name]), found[name], nan) / given.scales.modulus
    touching = closed(found["gap"])
    steep = _slopes(found, scene.ends, touching)
    beyond = touching & ((ratios > LARGEST_PRESSURE) | (steep > STEEPEST_SLOPE))
    shares = beyond.sum(nodes) / np.maximum(touching.sum(nodes), 1)
    strained = np.nan_to_num(ratios).mean(nodes) > 1.0
    if scene.length is not None or scene.has_moduli:
        strained = strained | (shares > LARGEST_SHARE) | (_largest(ratios, nodes) > 1.0)
    yield (
        strained,
        f"strains are no longer small on {100.0 * _largest(shares):.3g} % of the contact, where the {name} exceeds "
        f"{LARGEST_PRESSURE:g} E* or the slope {STEEPEST_SLOPE:g} (the largest are {_largest(ratios):.3g} E* and "
        f"{_largest(steep):.2g}), and linear elasticity is wrong by about these fractions: check load, moduli and "
        "heights",
    )


def _outside_branches(given: ContactInput, found: Found) -> Iterator[str]:
    """Yield warnings about times and rates far outside the relaxation times of the body.

    Waves are those of the spectral moments: 2 pi (m2 / m4)^(1/2) apart are the peaks, 2 pi (m0 / m2)^(1/2) long ones.
    """
    scene, series = given.file.scene, given.scales.relaxation
    if series is None:
        return
    shortest, longest = (given.scales.time * end for end in (min(series.times), series.longest_retardation))
    times, dwells, speeds = _times_and_speeds(given)
    if max(times, default=0.0) > FAR_FROM_BRANCHES * longest:
        yield (
            f"after some {longest:.2g} s this body is fully relaxed, and the load acts for {max(times):.4g} s: if it "
            f"should still relax then, measure frequencies below {_hertz(longest)}"
        )
    if min(dwells, default=inf) < shortest / FAR_FROM_BRANCHES:
        yield (
            f"before some {shortest:.2g} s this body is glassy, and the load acts for {min(dwells):.3g} s at first: if "
            f"it should relax by then, measure frequencies above {_hertz(shortest)}"
        )
    if not speeds or "nayak" not in found or scene.form is not None:
        return
    heights, gradient = found["height"].std(_nodes(given)), _largest(found["rms_gradient"]) / scene.dimension**0.5
    peaks = _largest(statistics.distance_of_peaks(heights**2, gradient**2, found["nayak"]))
    waves = 2.0 * np.pi * _largest(heights) / gradient
    unit, per_second = ("m", "m s-1") if scene.length else ("L_x", "L_x/s")
    for wave, speed, end, how, where in (
        (waves, min(speeds), 1.0 / longest, "relaxed", "below"),
        (peaks, max(speeds), 1.0 / shortest, "glassy", "above"),
    ):
        rate = 2.0 * np.pi * speed / wave
        if max(end / rate, rate / end) > FAR_FROM_BRANCHES and (rate < end) == (where == "below"):
            yield (
                f"at {with_prefix(speed, per_second, 3)} waves of {with_prefix(wave, unit, 3)} act at "
                f"{_hertz(1.0 / rate)}, and this body is {how} far {where} {_hertz(1.0 / end)}: if it should dissipate "
                f"more there, measure frequencies {where} that"
            )


def _times_and_speeds(given: ContactInput) -> tuple[list[float], list[float], list[float]]:
    """Times in s for which loads act, of all steps and of dwells under the same load, and speeds of passing punches."""
    times: list[float] = []
    dwells: list[float] = []
    speeds: list[float] = []
    held, before = 0.0, None
    for scene, sliding in given.steps:
        loading, duration = scene.loading, scene.loading.duration or 0.0
        now = getattr(loading, loading.control), sliding
        slides = before is not None and before[1] != sliding
        held = duration + (held if now == before else 0.0)
        dwells += [held] if now == before and held else []
        if loading.speed:
            speeds.append(loading.speed)
        elif slides and duration and scene.passes:
            assert before is not None
            speeds.append(dist(sliding, before[1]) / duration)
        elif duration:
            times.append(held)
        before = now
    return times, dwells, speeds


def _hertz(time: float) -> str:
    """Frequency at which a relaxation time dissipates most."""
    return f"{1.0 / (2.0 * np.pi * time):.3g} Hz"


def _few_nodes(given: ContactInput, found: Found) -> Iterator[Told]:
    """Yield a warning about a contact that is a single node, or narrow under a form, with a grid that would do.

    Where a law acts across the gap, the nodes that touch say little: `relative_softening` tells what the grid resolves.
    """
    scene, discretisation = given.file.scene, given.file.discretisation
    if scene.interface.reaches_across:
        return
    nodes = _nodes(given)
    sound = np.expand_dims(found["status"] == Status.ok, nodes)  # else it is where a step failed
    bears = (found["pressure"] > 0.0) & sound
    counts = bears.sum(nodes)
    if scene.form is not None and not scene.surfaces:
        across = np.min([bears.any(tuple({*nodes} - {axis})).sum(-1) for axis in nodes], axis=0)
    else:  # a stretch, or a disc, of as many nodes
        across = 2.0 * radius(counts, len(nodes))
    # of a path where it is widest: each contact begins with a node
    fewest = _largest(np.where(counts > 0, across, nan))
    least = FEWEST if scene.form is not None else _A_NODE
    if not fewest < least:
        return
    points = ceil(found["x"].size * FEWEST / fewest)
    finer = f"at least {points} {relative_softening.POINTS[len(nodes)]}"
    if discretisation is not None:
        finer = f"eps_c = 1/{ceil(points / (2 * discretisation.shortest_wave_index))} or finer ({finer})"
    off = "the radius of a ball is off by up to 30 % with 5, and by 65 % with 3"
    if scene.form is None:
        off = "area and pressure are those of the node alone"
    yield counts > 0, f"{FEW_NODES}, which is {fewest:.2g} wide: {off}; take {finer}, or a larger load"


def at_the_edge(found: Found) -> Iterator[Told]:
    """Yield a warning about a contact that reaches the edge of a window without a period."""
    if "edge_contact" in found:
        yield (
            found["edge_contact"] > 0.0,
            "the contact reaches the edge of the window, where the punch ends in a sharp edge: if the real surface "
            "goes on, take a larger patch or a smaller load",
        )


def _slopes(found: Found, ends: tuple[bool, ...], where: NDArray[np.bool_]) -> NDArray[Any]:
    """Size of the gradient of the heights between the neighbours of nodes, 0 but `where` it is asked for."""
    height = np.broadcast_to(found["height"], where.shape)
    steepness: NDArray[Any] = np.zeros(where.shape)
    nodes = np.nonzero(where)
    for axis, dim, end in zip(range(-len(ends), 0), "yx"[-len(ends) :], ends, strict=True):
        n, before, after = where.shape[axis], [*nodes], [*nodes]
        before[axis], after[axis] = nodes[axis] - 1, nodes[axis] + 1
        if end:
            before[axis], after[axis] = np.maximum(before[axis], 0), np.minimum(after[axis], n - 1)
        apart = (after[axis] - before[axis]) * found[dim][1]
        after[axis] = after[axis] % n
        steepness[nodes] = np.hypot(steepness[nodes], (height[tuple(after)] - height[tuple(before)]) / apart)
    return steepness


def past_asperities(found: Found) -> Iterator[Told]:
    """Yield a warning about sliding so far that asperities would meet others."""
    if "slid_over_peaks" in found:
        yield (
            found["slid_over_peaks"] > FARTHEST,
            f"the punch has slid past the body, {_largest(found['slid_over_peaks']):.2g} times the mean distance of "
            f"the peaks. Each node still faces the same node of the punch: beyond {FARTHEST:g} times that distance, "
            "asperities of real surfaces meet at other places",
        )


def _closer_than_known(given: ContactInput, found: Found) -> Iterator[Told]:
    law, nearest = given.file.scene.interface.law_of_the_gap, _smallest(found["gap"], _nodes(given))
    if law is not None:
        yield (
            nearest < law.known_from * law.range,
            f"the surfaces come as close as {_smallest(nearest) / law.range:.3g} times the range of the {law.title}, "
            f"whose traction goes on in a line below {law.known_from:g} times it: the law itself repels more, so check "
            "load and range",
        )


def _weak_interface(given: ContactInput, found: Found) -> Iterator[Told]:
    """Yield a warning about a shear strength that is hardly above what the residual leaves open.

    The residual counts in the largest pressure.
    """
    friction, residual = given.file.scene.interface.friction, given.file.numerics.residual
    peaks = _largest(found["pressure"], _nodes(given))
    if friction is not None and friction.limit is not None and (peak := _largest(peaks)) > 0.0:
        yield (
            friction.limit < RESOLVED_LIMIT * residual * peaks,
            f"the residual leaves open tractions of {residual * peak / friction.limit:.2g} times the limit of "
            f"friction: take a numerics.residual of at most {friction.limit / (RESOLVED_LIMIT * peak):.1g}",
        )


def _overlap(given: ContactInput, found: Found) -> Iterator[Told]:
    law = given.file.scene.interface.cohesive
    if law is not None:
        depths = -_smallest(found["gap"], _nodes(given)) / law.normal_length
        yield (
            depths > 1.0,
            f"the surfaces overlap by up to {_largest(depths):.3g} times normal_length, and without a hard_wall no "
            "area counts as contact: add one to the interface unless you mean that",
        )


def rough_body_warnings(
    bodies: tuple[RoughBody, ...], order: int, ends: tuple[bool, ...], found: xr.Dataset
) -> Iterator[Told]:
    """Yield warnings about slopes above the thesis's limit and about films at order 0. Along (y,) x bodies may end."""
    steepest = max(float(statistics.rms_gradient(body.heights, (1.0,) * len(ends), ends)) for body in bodies)
    steep = f"a deformable surface has an rms gradient of {steepest:.3g}, above {STEEPEST:g}"
    if steepest > STEEPEST and "next_order" not in found:
        yield (
            True,
            f"{steep}: order 0 in the slope, at which bodies that creep are pressed, leaves out relative errors of "
            "about that size",
        )
    elif steepest > STEEPEST:
        error, unit = float(found["next_order"].max()), found["next_order"].units
        moved = [found[name] for name in _NORMAL_DISPLACEMENTS if name in found]
        sizes = abs(xr.concat(moved, "body")).max(["body", *(dim for dim in moved[0].dims if dim != "step")])
        largest = float(sizes.max()) or 1.0
        off = f"{error:.1e} {'L_x' if unit == '1' else unit}, {error / largest:.2g} times the largest displacement"
        more = f"; numerics: {{topography_order: {order + 1}}} includes it" if 0 < order < _HIGHEST_ORDER else ""
        if error >= NEGLIGIBLE * largest:
            yield (
                (found["next_order"] >= NEGLIGIBLE * sizes.where(sizes > 0.0, 1.0)).values,
                f"{steep}: the next order in the slope would change displacements by up to {off}{more}",
            )
    if order == 0 and (film := thin_film_warning(bodies)):
        yield True, film


def thin_film_warning(bodies: Sequence[RoughBody]) -> str:
    """Return a warning about films whose thickness the roughness changes, which order 0 leaves out; else nothing."""
    body = max(bodies, key=change_of_thickness, default=None)
    change = 0.0 if body is None else change_of_thickness(body)
    if body is None or change < THICKNESS:
        return ""
    if body.elastic.stack is not None:
        return (
            f"the roughness of a deformable body changes the thickness of its topmost layer by up to {change:.2g} of "
            "it, which order 0 leaves out, as if the interface below followed the surface: if it is flat, take a "
            "numerics.topography_order of 1 or 2"
        )
    return (
        f"the roughness of a deformable body changes its thickness by up to {change:.2g} of it, which order 0 leaves "
        f"out: pressures are off by about that share, or twice that near a Poisson's ratio of 1/2; "
        "take a numerics.topography_order of 1 or 2"
    )
