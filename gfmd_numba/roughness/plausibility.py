"""Signs that a measured surface is not what it was taken for: each a sentence with its number and what to do.

The thresholds are far beyond what random self-affine surfaces reach, so that a sentence is worth reading. Heights are
`[nx]` or `[ny, nx]`, their periods `lengths` (L_x,) or (L_y, L_x) in the same unit, m or L_x.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np

from gfmd_numba.arrays import Flags, Reals
from gfmd_numba.roughness import statistics
from gfmd_numba.roughness.form import FEWEST, WAVY, form, polynomial, radii
from gfmd_numba.roughness.processing import MOST, fill_gaps
from gfmd_numba.roughness.spikes import despiked, quantum
from gfmd_numba.scene.units import METRES, PERIOD

SEAM = 5.0  # rms steps: one Gaussian step in two million is larger
SEAM_OVER_LARGEST = 1.5  # of the largest step: a surface made of walls may have one of them at its seam
TILT = 0.9  # of the mean square height: a sine over the whole period has 6/pi^2 = 0.61, a sawtooth 1
TILTED = 0.2  # of the mean square height, of a tilt that does not close a period: every instrument has one
FORM = 0.5  # of the mean square height: less of it changes the contact less than another piece of the surface would
WAVES = 0.9  # of the mean square height without a tilt
STANDS_OUT = {1: 20.0, 2: 8.0}  # by dimension, times the square that higher powers lead one to expect
LONGEST = 10.0  # m: of profilometers and microscopes none sees as far
GRADIENT = 0.3  # sin(x), tan(x) and x differ by 3 to 5 per cent: the elasticity is linear in slopes
SMOOTHEST = 2e-4  # rms gradient: polished steel, silicon and glass have more, between neighbours of micrometres
ATOM = 1e-10  # m
_OF_METRES = (1e-8, 1e-3)  # of heights in m taken for L_x, for true gradients from 0.01 (fields of 1 um) to 0.1 (1 cm)
FILLED = 0.05  # of all heights: as much of the contact may lie where nothing was measured
_STEP_WIDTHS = (1, 4, 16)  # points whose means are compared on both sides of a place
_STEP_STANDARDS = 8.0  # standard differences of such means
_STEP_OVER_NEXT = 2.0  # the largest of all other differences: a surface made of walls has many
_STEP_SHARE = 0.5  # of the rms height, which a step is at least
_MOST_STEPS = 4  # steps
_BACK = 0.25  # of the larger of two steps, by which the heights after them differ from those before
_LASTS = 8  # points over which half of a step lasts
_SAMPLES = 24  # independent differences, of which a standard one can be told
_OFTEN = 4.0  # times as often as the heights next to it in size,
_ROUNDED = 8  # and as many more times where those repeat themselves, too, as in files of few digits
_EQUAL_SHARE = 5e-4  # of all heights, that are equal
_FEWEST_EQUAL = 5  # equal heights
_EXACT, _WHOLE = 1e-9, 0.01  # of the largest height and of a step, by which equal heights and whole steps may be off
_FEWEST_STEPS = 2  # of a digitiser, in the range of heights: with fewer, the surface is a grating
_ROUNDED_SHARE = 0.05  # of the mean square gradient: contact areas are then off by 3 per cent
_LOST = 0.05  # of the rms gradient
_LEVELS = 12  # different heights: with fewer, the surface is a grating, or counts
_BEYOND = 0.1  # of the range of all other heights, by which a mark of missing heights lies outside
_FAR = {1: 100.0, 2: 1.0}  # the same of a single height and of a few equal ones, which then are no spikes
_NEXT = 8  # heights above and below, with which one is compared
_RUN = 3.0  # equal neighbours in the mean, from which on heights are stuck
_PARTS = {1: 256, 2: 8}  # of a field, of which the outer ones tell the values and the slopes at its ends
_ACROSS = {1: 1.6, 2: 1.2}  # standard deviations of a tilt and a curvature, by which these differ along one axis
_FEWEST_WAVES = 8.0  # of a cutoff in a field: ISO 4288 takes five of lambda_c, and hundreds of lambda_s
_DESIGN = 0.005  # of the second difference, by which it changes between neighbours on wedges, parabolas and circles

Cause = Literal["top", "bottom", "mark", "stuck"]


@dataclass(frozen=True)
class LevelledField:
    """A measured field of sizes `lengths`: `heights` `[nx]` or `[ny, nx]` after levelling, all of them numbers.

    `as_measured` are those before, of which missing ones are not-a-number. `units` are the user's for x and z. One
    to be `mirrored` is no period of waves. Waves shorter than a `cutoff` are left out. The levelling has `subtracted` a
    polynomial of that order.
    """

    as_measured: Reals
    heights: Reals
    lengths: tuple[float, ...]
    units: Mapping[str, str]
    mirrored: bool = False
    cutoff: float | None = None
    subtracted: int = 0

    def said(self, length: float, axis: str = "z", digits: int = 3) -> str:
        """Return a length in the user's unit of x or z."""
        return said(self.units, length, axis, digits)


@dataclass(frozen=True)
class Signs:
    """Sentences about a field, and its rms gradient and range of heights without what they name."""

    sentences: tuple[str, ...]
    rms_gradient: float
    range: float


@dataclass(frozen=True)
class Repeated:
    """A height, how often it occurs in how many runs, what it may be, and where it is `[nx]` or `[ny, nx]`."""

    height: float
    runs: int
    cause: Cause
    at: Flags


def said(units: Mapping[str, str], length: float, axis: str = "z", digits: int = 3) -> str:
    """Return a length in the user's unit of x or z."""
    name = units.get(axis) or units.get("z") or PERIOD
    return f"{length / METRES.get(name, 1.0):.{digits}g} {name}"


def of_field(field: LevelledField) -> Signs:
    """Signs of form, spikes, steps and heights that are none, of a field before it is made periodic."""
    again = repeated(field.as_measured)
    heights, marked = field.heights, np.zeros(field.heights.shape, dtype=bool)
    for each in again:
        marked |= each.at & (each.cause == "mark")
    if 0.0 < marked.mean() <= MOST:  # what is marked is filled from its neighbours
        heights = fill_gaps(np.where(marked, np.nan, heights), "interpolate")[0]
    step, coarse = _digitised(field)
    raised = heights
    heights, spikes = despiked(heights, step)
    deep = bool((raised[spikes] < heights[spikes]).all())
    if (
        field.subtracted > 0 and (marked | spikes).any()
    ):  # of a polynomial that was fitted to marks and spikes, too, something is left
        heights = heights - polynomial(heights, field.subtracted)
    formed, order = _form(field, heights)
    level = heights - polynomial(heights, order)
    rounding = _EXACT * float(np.ptp(heights))
    steps = [each for each in offsets(level) if abs(each[2]) > max(2.0 * step, rounding)]
    share = float(np.isnan(field.as_measured).mean())
    filled = (
        f"{100 * share:.3g} % of the heights were missing and filled: measure again, or cut out a part without gaps"
    )
    found = (*_repeated(field, again), *formed, coarse, _spikes(spikes, deep), _steps(field, steps))
    sentences = tuple(filter(None, (filled if share > FILLED else "", *found)))
    for axis, i, step in steps:
        level -= step * np.expand_dims(np.arange(level.shape[axis]) > i, tuple(range(axis + 1, 0)))
    if not sentences or np.ptp(level) <= rounding:
        level = field.heights
    # the median is no matter of single heights that are left, but in a field of few digits it may be 0
    slopes = _slopes(level, field.lengths)
    rms = float(np.sqrt(sum((each**2).mean() for each in slopes)))
    usual = 1.4826 * float(np.sqrt(sum(np.median(abs(each)) ** 2 for each in slopes)))
    told = min(rms, usual) if sentences and usual > 0.0 and not step else rms
    return Signs(sentences, told, float(np.ptp(level)))


def of_surface(
    heights: Reals,
    lengths: tuple[float, ...],
    signs: Signs | None = None,
    ends: tuple[bool, ...] = (),
    units: Mapping[str, str] = MappingProxyType({}),
    cutoff: float = 0.0,
) -> tuple[str, ...]:
    """Sentences about a surface, whose size is not blamed on units if the signs of its field explain it.

    It is periodic but for axes along which it `ends`, and has no wave shorter than a `cutoff`. `units` are the user's
    for x and z.
    """
    named = signs if signs is not None and signs.sentences else None
    found = [*_seams(heights, ends or (False,) * heights.ndim, [cutoff / length for length in lengths], units)]
    blamed = named is None or named.rms_gradient > GRADIENT
    if blamed and (gradient := float(statistics.rms_gradient(heights, lengths, ends))) > GRADIENT:
        found.append(
            f"an rms gradient of {gradient:.3g}, above {GRADIENT:g}, where linear elasticity is no longer good: check "
            "the units of the file, or leave out short waves by a cutoff"
        )
    periods = float(np.ptp(heights)) / min(lengths)
    if periods > 1.0 and (named is None or named.range > min(lengths)):
        found.append(f"heights that range over {periods:.3g} periods: check the units of the file, and the length")
    return tuple(found)


def of_resampling(
    surfaces: tuple[Reals, Reals], lengths: tuple[float, ...], ends: tuple[bool, ...] = ()
) -> tuple[str, ...]:
    """Sentence about the gradient that the first of two surfaces, on other points, has lost of that of the second."""
    after, before = (float(statistics.rms_gradient(each, lengths, ends)) for each in surfaces)
    if after >= (1.0 - _LOST) * before:
        return ()
    fewer, all_of = (" x ".join(map(str, each.shape)) for each in surfaces)
    return (
        f"{fewer} points leave out {100.0 * (1.0 - after / before):.3g} % of the rms gradient that {all_of} points "
        "have, and contact areas grow as it falls: give more points, or leave them out",
    )


def of_cutoff(cutoff: float, sizes: tuple[float, ...]) -> tuple[str, ...]:
    """Sentence about a cutoff, 0 without one, of which few waves fit into a field of these sizes."""
    if cutoff * _FEWEST_WAVES <= min(sizes):
        return ()
    return (
        f"only {min(sizes) / cutoff:.2g} waves as long as the cutoff fit into the field, so that waviness alone is "
        "left: a cutoff is the shortest wave that is kept (lambda_s), not the longest one (lambda_c)",
    )


def of_sizes(signs: Signs, length: float) -> tuple[str, ...]:
    """Sentences about a surface of a period L_x in m, larger or smoother than any."""
    found = []
    if length > LONGEST:
        found.append(f"a period of {length:.3g} m: check the units of positions and sizes")
    if 0.0 < signs.rms_gradient < SMOOTHEST:
        found.append(
            f"an rms gradient of {signs.rms_gradient:.2g} between neighbours, below {SMOOTHEST:g}, is smoother than "
            "polished glass: check the units of heights and positions"
        )
    elif 0.0 < signs.range < ATOM:
        found.append(f"heights that range over {signs.range:.2g} m, less than an atom: check their units")
    return tuple(found)


def of_no_unit(signs: Signs) -> tuple[str, ...]:
    """Sentence about heights that look like metres, but count in periods, as nobody stated a unit."""
    if not _OF_METRES[0] < signs.rms_gradient < _OF_METRES[1]:
        return ()
    return (
        f"an rms gradient of {signs.rms_gradient:.2g} between neighbours, because heights without a unit count in "
        "periods: if they are in m, write units: {z: m} and the length; if not, units: {z: L_x}",
    )


def offsets(level: Reals) -> list[tuple[int, int, float]]:
    """Axis, -2 or -1, index of the last point before, and height of the steps of level heights `[(ny,) nx]`."""
    found = []
    for axis in range(-level.ndim, 0):
        steps = np.moveaxis(np.diff(level, axis=axis), axis, 0)
        line = np.append(0.0, np.cumsum(np.median(steps.reshape(len(steps), -1), axis=1)))
        found += [(axis, int(i), float(step)) for i, step in _of_line(line, float(level.std()))]
    return found


def repeated(heights: Reals) -> list[Repeated]:
    """Heights of a field that occur too often, or lie too far out; missing ones are not-a-number.

    The most frequent is the first.
    """
    values, counts = np.unique(heights[~np.isnan(heights)], return_counts=True)
    if len(values) < _LEVELS or is_design(heights):
        return []
    least = max(_FEWEST_EQUAL, _EQUAL_SHARE * heights.size)
    found = []
    for end in (0, len(values) - 1):
        gap, span = _beyond(values, end)
        if counts[end] < least and gap > _FAR[min(int(counts[end]), 2)] * span:
            found.append(_described(heights, values, end))
    for i in np.flatnonzero(counts >= least):
        nearest = np.concatenate([counts[max(i - _NEXT, 0) : i], counts[i + 1 : i + 1 + _NEXT]])
        if counts[i] > _OFTEN * nearest.mean() + (_ROUNDED if nearest.max() > 1 else 0):
            found.append(_described(heights, values, int(i)))
    return sorted(found, key=lambda each: -each.at.sum())


def is_design(heights: Reals) -> bool:
    """Whether a surface has no roughness at all: its second difference along x hardly changes between neighbours."""
    second = np.diff(heights, 2, axis=-1)
    rounding = 64.0 * float(np.finfo(np.float64).eps * np.nanmax(abs(heights)))
    return float(np.nanmedian(abs(np.diff(second, axis=-1)))) <= _DESIGN * float(np.nanmedian(abs(second))) + rounding


def _repeated(field: LevelledField, found: list[Repeated]) -> Iterator[str]:
    for each in found[:2]:
        are = "are" if each.at.sum() > 1 else "is"
        times = f"{each.at.sum()} of {field.as_measured.size} heights {are} exactly {field.said(each.height, 'z', 6)}"
        if each.cause in ("top", "bottom"):
            end = "largest" if each.cause == "top" else "smallest"
            yield f"{times}, the {end} height: if the instrument was saturated, measure again with a wider range"
        elif each.cause == "stuck":
            runs = f"{each.runs} run{'s' if each.runs > 1 else ''}"
            yield f"{times}, in {runs}: if the instrument was stuck there, write nan for them, and fill: interpolate"
        else:
            yield f"{times}: if that marks missing heights, write nan for them, and fill: interpolate"


def _form(field: LevelledField, heights: Reals) -> tuple[list[str], int]:
    """Sentences about the form of heights, and the order of the polynomial that follows it."""
    if min(heights.shape) < FEWEST or is_design(heights):
        variance = float(heights.var())
        share = float(polynomial(heights, 1).var()) / variance if variance > 0.0 else 0.0
        return [_tilted(share)] if share > TILT else [], 2
    found, stands_out, order = form(heights), STANDS_OUT[heights.ndim], 2
    sentences = []
    if found.tilt.share > TILTED and (found.tilt.over_expected > stands_out or _closes_not(heights, 1)):
        sentences.append(_tilted(found.tilt.share))
    opens = field.mirrored and _closes_not(heights, 2)
    if found.curvature.share > FORM and (opens or found.curvature.over_expected > stands_out):
        shown = " and ".join(
            f"{field.said(abs(radius), 'x')} ({'convex' if radius > 0.0 else 'concave'})"
            for radius in radii(heights, field.lengths)
        )
        sentences.append(
            f"a curvature of radius {shown} makes up {_percent(found.curvature.share)} % of the mean square height: "
            "detrend: curvature subtracts it; leave it only if the form is to be pressed too"
        )
    elif found.waves.share > WAVES and found.waves.over_expected > stands_out and found.rest > quantum(heights) ** 2:
        order = WAVY
        sentences.append(
            f"waves longer than two fifths of the field make up {_percent(found.waves.share)} % of the mean square "
            "height: filter the waviness out, as ISO 16610-21 does; leave it only if it is to be pressed too"
        )
    return sentences, order


def _closes_not(heights: Reals, order: int) -> bool:
    """Whether values (order 1) or slopes (2) at opposite ends differ as in the polynomial; those of waves do not."""
    power = polynomial(heights, order) - polynomial(heights, order - 1)
    for axis, n in enumerate(heights.shape):
        of_power, of_heights = (
            [float(part.mean()) for part in np.array_split(np.moveaxis(each, axis, 0), min(_PARTS[order], n))]
            for each in (power, heights)
        )
        apart, across = (
            each[-1] - each[0] if order == 1 else each[-1] - each[-2] - each[1] + each[0]
            for each in (of_heights, of_power)
        )
        if abs(across) > _ACROSS[order] * float(power.std()) and apart / across > 0.5:
            return True
    return False


def _percent(share: float) -> str:
    """Share in per cent, which never rounds up to all."""
    return f"{np.floor(1e4 * share) / 1e2:.4g}"


def _tilted(share: float) -> str:
    return f"a tilt makes up {_percent(share)} % of the mean square height: detrend: tilt subtracts it"


def _spikes(found: Flags, deep: bool) -> str:
    count = int(found.sum())
    if count == 0:
        return ""
    index = ", ".join(map(str, np.argwhere(found)[0]))
    what = f"a spike at index {index}" if count == 1 else f"{count} heights in spikes, the first at index {index}"
    kept = "; as all lie below these, leave them if the surface has such grooves" if deep and count > 1 else ""
    return f"{what}: despike: true interpolates the heights there{kept}"


def _steps(field: LevelledField, found: list[tuple[int, int, float]]) -> str:
    if not found:
        return ""
    shown = ", ".join(f"by {field.said(step)} behind {('row', 'index')[axis]} {i}" for axis, i, step in found)
    back = abs(sum(step for *_, step in found)) < _BACK * max(abs(step) for *_, step in found)
    if len(found) == 2 and back and found[0][0] == found[1][0]:
        return (
            f"the heights step {shown}, and are back: if dust or a hole of the instrument lies between, write nan "
            "there, and fill: interpolate"
        )
    return f"the heights step {shown}, and stay there: if the instrument slipped, measure again or cut out a part"


def _digitised(field: LevelledField) -> tuple[float, str]:
    """Step of a digitiser that makes up much of the gradient, and a sentence about it; 0 and nothing where none does.

    Rounding of heights that change by s between neighbours, normally distributed, to multiples of q adds q^2/6 to the
    mean square s^2 if s is not far below q. Else few steps of q remain, of mean square q E|s| = q s sqrt(2/pi).
    """
    heights = field.as_measured
    spacings = [length / n for n, length in zip(heights.shape, field.lengths, strict=True)]
    steps = [each[~np.isnan(each)] for axis in range(heights.ndim) for each in [abs(np.diff(heights, axis=axis))]]
    every = np.concatenate(steps)
    changes = every[every > _EXACT * np.nanmax(abs(heights))]
    quantum = float(changes.min(initial=np.inf))
    whole = bool((abs(changes / quantum - np.round(changes / quantum)) < _WHOLE).all())
    span = np.nanmax(heights) - np.nanmin(heights)
    if not (whole and 0 < len(changes) < len(every) and span >= _FEWEST_STEPS * quantum):
        return 0.0, ""
    kinks = (abs(np.diff(heights, 2, axis=-1)) > 0.5 * quantum).sum()
    if kinks < 0.25 * (steps[-1] > 0.5 * quantum).sum():  # flanks of a design go on
        return 0.0, ""
    ratios = [float((each**2).mean()) / quantum**2 for each in steps]
    shares = [1.0 - 0.5 * np.pi * r if r < 1.0 / np.pi else 1.0 / (6.0 * r) for r in ratios]
    weights = [r / spacing**2 for r, spacing in zip(ratios, spacings, strict=True)]
    share = float(np.average(shares, weights=weights))
    lags = (2**i for i in range(int(np.log2(heights.shape[-1])) - 1))
    lag = next((k for k in lags if np.nanmean((heights[..., k:] - heights[..., :-k]) ** 2) > 4.0 * quantum**2), 0)
    shortest = 2.0 * lag * spacings[-1]
    if share < _ROUNDED_SHARE or (lag and (field.cutoff or 0.0) >= 0.99 * shortest):
        return 0.0, ""
    remedy = f", or leave out short waves by cutoff: {field.said(shortest, 'x')}" if lag else ""
    return quantum, (
        f"heights in steps of {field.said(quantum, 'z')}, whose rounding makes up {min(100.0 * share, 99.0):.2g} % of "
        f"the mean square gradient: measure with a finer step{remedy}"
    )


def _slopes(heights: Reals, lengths: tuple[float, ...]) -> list[Reals]:
    """Slopes between neighbours along each axis."""
    spacings = [length / n for n, length in zip(heights.shape, lengths, strict=True)]
    return [np.diff(heights, axis=axis) / spacing for axis, spacing in enumerate(spacings)]


def _seams(heights: Reals, ends: tuple[bool, ...], cutoffs: list[float], units: Mapping[str, str]) -> Iterable[str]:
    """Sentences about heights that jump where a period closes; a cutoff, in periods, spreads a jump over its half."""
    names = ("y", "x")[-heights.ndim :]
    for axis, name, end, cutoff in zip(range(-heights.ndim, 0), names, ends, cutoffs, strict=True):
        if end:
            continue
        lines = np.moveaxis(heights, axis, -1)
        lag = max(1, min(round(cutoff * lines.shape[-1] / 2.0), lines.shape[-1] // 8))
        inner = _rms(lines[..., lag:] - lines[..., :-lag])
        jump = float(_rms(lines[..., :lag] - lines[..., -lag:]).max())
        rms, largest = float(np.sqrt((inner**2).mean())), float(inner.max())
        if jump > SEAM * rms and jump > SEAM_OVER_LARGEST * largest:
            yield (
                f"the heights jump by {said(units, jump)} where the period along {name} closes, {jump / rms:.3g} rms "
                f"steps between {'neighbours' if lag == 1 else 'points half a cutoff apart'}: periodic: mirror makes "
                "the ends meet"
                if rms > 0.0
                else f"the heights jump by {said(units, jump)} where the period along {name} closes, and nowhere else"
            )


def _rms(steps: Reals) -> Reals:
    """Root mean square over all rows of steps `[..., n]`."""
    return np.asarray(np.sqrt((steps**2).mean(axis=tuple(range(steps.ndim - 1)))))


def _of_line(line: Reals, rms: float) -> list[tuple[int, float]]:
    n = len(line)
    sums = np.append(0.0, np.cumsum(line))
    for width in _STEP_WIDTHS:
        if n < _SAMPLES * width or n < 4 * _LASTS:
            break
        ends = np.arange(width, n - width + 1)
        steps = (sums[ends + width] - 2.0 * sums[ends] + sums[ends - width]) / width
        least = max(_STEP_STANDARDS * 1.4826 * float(np.median(abs(steps))), _STEP_SHARE * rms)
        left, at = abs(steps), []  # the largest, none nearer to another than two widths
        for _ in range(_MOST_STEPS + 1):
            at.append(int(left.argmax()))
            left[max(at[-1] - 2 * width, 0) : at[-1] + 2 * width + 1] = 0.0
        sizes = abs(steps[at])
        for count in range(min(_MOST_STEPS, len(at) - 1), 0, -1):
            if sizes[count - 1] > max(least, _STEP_OVER_NEXT * sizes[count]):
                places = [int(ends[i]) - 1 for i in sorted(at[:count])]
                kept = [(i, step) for i in places if (step := _lasting(line, i)) != 0.0]
                if len(kept) == count:
                    return kept
    return []


def _lasting(line: Reals, i: int) -> float:
    """Height of a step after index i, which is 0 if it is gone after some points, or took some points to rise."""
    before, after = line[max(i - _LASTS + 1, 0) : i + 1], line[i + 1 : i + 1 + _LASTS]
    step = float(np.median(after) - np.median(before))
    sharp = float(abs(np.diff(line[max(i - 1, 0) : i + 4])).max())
    return step if sharp > 0.5 * abs(step) and abs(step) > 0.5 * abs(line[i + 1] - line[i]) else 0.0


def _beyond(values: Reals, i: int) -> tuple[float, float]:
    """By how much one of some values that rise lies outside the range of the others, and this range."""
    others = np.delete(values, i)
    return float(max(others[0] - values[i], values[i] - others[-1])), float(others[-1] - others[0])


def _described(heights: Reals, values: Reals, i: int) -> Repeated:
    at, (gap, span) = heights == values[i], _beyond(values, i)
    runs = int(at[..., 0].sum() + (np.diff(at.astype(np.int8), axis=-1) == 1).sum())
    cause: Cause = "stuck"
    if gap > _BEYOND * span:
        cause = "mark"
    elif gap > 0.0:
        cause = "top" if i else "bottom"
    elif at.sum() < _RUN * runs:
        cause = "mark"
    return Repeated(float(values[i]), runs, cause, at)
