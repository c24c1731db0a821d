"""A measured surface from its record: read, filled, levelled and made periodic, for contacts and `gfmd surface` alike.

`length` is always the period L_x of the result. A file with positions or physical sizes tells the size of the field,
and with it the period: the same, or twice as much if the field is mirrored. Without them, `length` does.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.roughness import plausibility, statistics
from gfmd_numba.roughness.measurements import Content, Measurement, at_spacing, counts_points, measurement
from gfmd_numba.roughness.processing import ORDERS, closed, detrended, fill_gaps, largest_square, made_periodic
from gfmd_numba.roughness.spikes import without_spikes
from gfmd_numba.roughness.surface_files import content_of, read_content
from gfmd_numba.scene import Document, Scene
from gfmd_numba.scene.measured_record import Measured
from gfmd_numba.scene.records import ends_of
from gfmd_numba.scene.units import METRES, PERIOD, WithUnit, in_unit_of
from gfmd_numba.text.numbers import with_prefix
from gfmd_numba.text.recorded_scene import KIND

Reader = Callable[[Path], Content]
Place = tuple[str, ...]  # of a roughness in the scene

_FADED = (
    "periodic: window fades the measured surface to a plane at its ends, and area, gap and pressure are those of the "
    "faded surface: take periodic: mirror for a contact, and a window for spectra"
)
_SAME = (
    "both bodies have the same heights, so that each peak meets itself, which no real surfaces do: measure another "
    "piece for one of them"
)
_UNEQUAL = 1e-3  # of the size of a map, by which its two sizes may differ
_FLAT = 1e-12  # of the largest height in the file, below which a range of heights is rounding
_SIZES = 1e-6  # by which a period in a file and one in the scene may differ,
_OF_A_HEADER = 0.01  # by which a rounded one in a header may, and
_SHARPEST = 5  # nodes
_RINGS = (
    "points are added by the Fourier series, which rings where measured heights are as sharp as here, as at edges of "
    "grooves: the highest ones may lie too high, and the contact area be a third too small, so take a cutoff of at "
    "least 4 spacings, or leave out points"
)
_UNCUT = ": give a cutoff if the instrument resolves longer waves only"
_SPACING = 1e-3  # of the spacing, by which positions are rounded


@dataclass(frozen=True)
class MeasuredSurface:
    """Heights `[nx]` or `[ny, nx]` and periods (L_x,) or (L_y, L_x) in m, or in L_x if their `unit` is "1".

    `found` tells what was measured, `done` what was done to it, and `doubts` what makes it implausible. A surface that
    `is_design` has no roughness; one that `has_cutoff`, no waves shorter than a cutoff. Along axes it may have `ends`.
    """

    heights: Reals
    lengths: tuple[float, ...]
    unit: Literal["m", "1"]
    found: str
    done: tuple[str, ...]
    doubts: tuple[str, ...]
    is_design: bool = False
    has_cutoff: bool = False
    ends: tuple[bool, ...] = ()

    @property
    def in_periods(self) -> Reals:
        """Heights in L_x."""
        return self.heights / self.lengths[-1]

    @property
    def outcome(self) -> tuple[str, ...]:
        """What was measured, what was done, and the size of the surface that came out."""
        height = float(statistics.rms_height(self.heights, self.lengths))
        gradient = float(statistics.rms_gradient(self.heights, self.lengths, self.ends))
        size = _size(height, self.unit)
        short, share = statistics.median_wave(*closed(self.heights, self.lengths, self.ends))
        made = (
            f"the measured surface has an rms height of {size} and an rms gradient of {gradient:.4g}; waves of "
            f"{_size(short, self.unit, 3)} and shorter make up {100.0 * share:.3g} % of its mean square gradient"
        )
        return self.found, *self.done, made if self.has_cutoff else made + _UNCUT


@dataclass(frozen=True)
class MeasuredField:
    """What a record measures, before it is made periodic: `fields` of it, side by side, are a period along x."""

    record: Measured
    found: Measurement
    fields: float

    @property
    def period(self) -> float | None:
        """Period L_x in m that positions or sizes tell, None without them or if they are in L_x."""
        return self.fields * self.found.lengths[-1] if self.found.unit == "m" and self.found.lengths else None


MeasuredSurfaces = Mapping[Place, MeasuredSurface]


def measured_surfaces(
    scene: Scene, document: Document, read: Reader = read_content
) -> tuple[dict[Place, MeasuredSurface], float | None]:
    """Measured surfaces of a scene by their places, and the period in m: that of the scene, or else that of a file.

    `read` gives the content of a file. Raises InputError for files that cannot be used, or that tell different periods.
    """
    fields = {}
    for place, record in scene.surfaces.items():
        if isinstance(record, Measured):
            with usable(document, ("scene", *place), record):
                fields[place] = measured_field(record, read)
    told = {place: field.period for place, field in fields.items() if field.period is not None}
    first = next(iter(told), None) if scene.length is None else None
    length, told_by = (scene.length, "length") if first is None else (told[first], ".".join(first))
    dimension = scene.dimension if "dimension" in scene.model_fields_set else None
    surfaces: dict[Place, MeasuredSurface] = {}
    for place, field in fields.items():
        at, own = ("scene", *place), None if place == first else length  # whose period is told by nobody else
        with usable(document, at, field.record):
            found = periodic_surface(field, own, dimension, scene.has_moduli, told_by, scene.periodic)
        _check_square(found, field, at, document)
        doubts = (*found.doubts, _FADED) if field.record.periodic == "window" else found.doubts
        for of_other, other in surfaces.items():
            one_file = field.record.file is not None and field.record.file == fields[of_other].record.file
            if not found.is_design and (one_file or np.array_equal(found.heights, other.heights)):
                doubts += (_SAME,)
        surfaces[place] = replace(found, doubts=doubts)
    return surfaces, length


def _check_square(found: MeasuredSurface, field: MeasuredField, place: Place, document: Document) -> None:
    """Raise InputError for a map of more points, or a larger size, along one axis than along the other."""
    unequal = max(found.lengths) > min(found.lengths) * (1.0 + _UNEQUAL)
    if len(set(found.heights.shape)) > 1 or unequal:
        record, parts = field.record, field.fields
        points = " x ".join(f"{n / parts:g}" for n in found.heights.shape[::-1])
        sizes = " x ".join(_size(length / parts, found.unit) for length in found.lengths[::-1])
        given = f"{record.shown} ({points} points over {sizes} along x and y)"
        remedy = (
            "crop: square cuts one out"
            if unequal
            else f"points: {max(found.heights.shape)} resamples it to as many points both ways"
        )
        allowed = f"a map of as many points, and the same size, both ways; {remedy}"
        raise document.fault((*place, record.key), given, allowed)


@contextmanager
def usable(document: Document, place: Place, record: Measured | None = None) -> Iterator[None]:
    """Raise InputError for a surface at a place that cannot be used, by its file or heights if it is measured."""
    try:
        yield
    except ValueError as error:
        if record is None:
            raise document.refused(place, f"a usable surface, not {error}") from None
        allowed = "a table of equidistant heights in units that are stated"
        raise document.fault((*place, record.key), f"{record.shown} ({error})", allowed) from None


def measured_field(record: Measured, read: Reader = read_content) -> MeasuredField:
    """Heights of a record in the units that are stated; `read` gives the content of a file.

    Raises ValueError, saying what is wrong and what to do.
    """
    units = {} if record.units is None else record.units.model_dump(exclude_none=True)
    content = read(Path(record.file or "")) if record.heights is None else content_of(record.heights)
    if record.spacing is not None and counts_points(content):
        content = at_spacing(content, float(record.spacing))
    elif record.spacing is not None:
        if content.positions or (content.sizes and not content.rounded):
            raise ValueError("positions or sizes in the file, so that spacing has to be left out")
        for axis, n in content.nodes.items():
            unit = content.units.get(axis, "m")
            stated, given = content.sizes.get(axis, 0.0) / n, record.spacing / METRES[unit]
            if stated and abs(stated - given) > _OF_A_HEADER * stated:
                told = f"points {stated:.6g} {unit} apart along {axis} in the header of the file"
                raise ValueError(f"{told}, not {given:.6g} {unit}: leave spacing out, or correct it")
        in_metres = {**content.units, **dict.fromkeys(content.nodes, "m")}
        sizes = {axis: n * float(record.spacing) for axis, n in content.nodes.items()}
        content = replace(content, sizes=sizes, units=in_metres, rounded=False)
    found = measurement(content, units, resample=record.points is not None)
    if record.crop == "square":
        found = largest_square(found)
    return MeasuredField(record, found, 2.0 if record.periodic == "mirror" else 1.0)


def measured_surface(record: Measured, length: float | None, dimension: int | None = None) -> MeasuredSurface:
    """Surface of a record on its own, as `periodic_surface` makes it."""
    return periodic_surface(measured_field(record), length, dimension)


def periodic_surface(
    field: MeasuredField,
    length: float | None,
    dimension: int | None = None,
    in_si: bool = False,
    told_by: str = "length",
    periodic: object = True,
) -> MeasuredSurface:
    """Periodic surface of a field, of period `length` in m, or that of the file, or 1 if heights are in L_x.

    `dimension` is what the caller can use, if not both. `in_si` is said of a scene with moduli in Pa, where no unit is
    assumed even without a length. `told_by` names what the length stands in. Along an axis
    that is not `periodic` there is no seam to be doubted. Raises ValueError, saying what is wrong and what to do.
    """
    record, found = field.record, field.found
    if dimension is not None and found.heights.ndim != dimension:
        kind, shape = KIND[found.heights.ndim], " x ".join(map(str, found.heights.shape))
        raise ValueError(f"a {kind} of {shape} heights, where dimension: {dimension} needs a {KIND[dimension]}")
    sizes, unit = _sizes(field, length, in_si, told_by)
    if unit == "1" and isinstance(record.cutoff, WithUnit):
        raise ValueError("a cutoff with a unit, as neither the file nor a length tells the period in m: give length")
    heights, filled = fill_gaps(found.heights, record.fill)
    heights, replaced = without_spikes(heights) if record.despike else (heights, ())
    heights, levelled = detrended(heights, record.detrend)
    ends = ends_of(periodic, heights.ndim)
    if np.ptp(heights) <= _FLAT * float(abs(found.heights[~np.isnan(found.heights)]).max()):
        raise ValueError(
            f"a flat surface{'' if record.detrend == 'none' else ' once the trend is gone'}, but for rounding"
        )
    mirrored = field.fields == 2.0 and not any(ends)
    signs = plausibility.of_field(
        plausibility.LevelledField(
            found.heights, heights, sizes, found.units, mirrored, record.cutoff, ORDERS[record.detrend]
        )
    )
    made = made_periodic(heights, sizes, record.periodic, record.cutoff, record.points, ends)
    doubts = signs.sentences + plausibility.of_surface(
        made.heights, made.lengths, signs, ends, found.units, record.cutoff or 0.0
    )
    doubts += plausibility.of_sizes(signs, made.lengths[-1]) if unit == "m" else ()
    doubts += plausibility.of_no_unit(signs) if found.unit is None else ()
    if record.points is not None:  # which a map may have more of along one axis, and fewer along the other
        finer = np.divide(made.heights.shape, made.lengths) > np.divide(heights.shape, sizes)
        doubts += (_RINGS,) * bool(finer.any() and record.cutoff is None and _is_sharp(heights))
        whole = made_periodic(heights, sizes, record.periodic, record.cutoff, None, ends)
        doubts += plausibility.of_resampling((made.heights, whole.heights), made.lengths, ends)
    doubts += plausibility.of_cutoff(record.cutoff or 0.0, sizes)
    is_design = plausibility.is_design(made.heights)
    done = (*found.done, *filled, *replaced, *levelled, *made.done)
    has_cutoff = record.cutoff is not None
    return MeasuredSurface(
        made.heights, made.lengths, unit, _found(found, sizes, unit), done, doubts, is_design, has_cutoff, ends
    )


def _size(length: float, unit: str, digits: int = 4) -> str:
    return with_prefix(length, "m", digits) if unit == "m" else f"{length:.{digits}g} L_x"


def _found(found: Measurement, sizes: tuple[float, ...], unit: str) -> str:
    """Say what was measured: whoever knows the instrument sees whether the file was understood."""
    shape = found.heights.shape[::-1]
    points, spacing, size = (
        " x ".join(some)
        for some in (
            map(str, shape),
            (_size(length / n, unit) for length, n in zip(sizes[::-1], shape, strict=True)),
            (_size(length, unit) for length in sizes[::-1]),
        )
    )
    heights = f"heights in {found.units.get('z', PERIOD)}"
    return f"found {points} {heights}, {spacing} apart, over {size}"


def _is_sharp(heights: Reals) -> bool:
    """Whether a field is bent most where its neighbours are not, as at edges of grooves and between nodes of noise."""
    near, far = (np.ravel(each) for each in statistics.bends(heights, (True,) * heights.ndim))
    most = np.argsort(-abs(near))[:_SHARPEST]
    return bool((near[most] ** 2).sum() > statistics.SHARP**2 * (far[most] ** 2).sum())


def _sizes(
    field: MeasuredField, length: float | None, in_si: bool, told_by: str
) -> tuple[tuple[float, ...], Literal["m", "1"]]:
    """Sizes of the measured field in m or L_x, and which of the two: the one place where a file meets a length."""
    found = field.found
    if found.unit is None and (length is not None or in_si):
        known, units = ("a length in m", "{z: um}") if length is not None else ("moduli in Pa", "{z: um}, or {z: L_x},")
        raise ValueError(f"heights without a unit, but {known}: write units: {units} with theirs, in the same block")
    if found.unit == "1" and length is not None:
        if told_by != "length":
            raise ValueError(f"heights in units of the period, but {length:.7g} m in {told_by}: give both in m or L_x")
        raise ValueError("heights in units of the period, so that length has to be left out")
    shape = found.heights.shape
    if found.lengths is None:
        if found.unit == "m" and length is None:
            raise ValueError(
                f"a {KIND[len(shape)]} of {' x '.join(map(str, shape))} heights without positions: give spacing, the "
                "distance of neighbouring points, or length, the period"
            )
        if length is not None and field.fields == 2.0 and told_by == "length":
            field_of, period_of = (in_unit_of(length, length / part / shape[-1], "m") for part in (1.0, 2.0))
            whole = in_unit_of(length, length, "m")
            raise ValueError(
                f"heights without positions that are to be mirrored, so that a length of {whole} may be that of the "
                f"field or of twice the field: write spacing: {field_of} in its place if the field is {whole} long, "
                f"or spacing: {period_of} if the period is"
            )
        spacing = (length or 1.0) / field.fields / shape[-1]
        return tuple(n * spacing for n in shape), "m" if found.unit == "m" else "1"
    period = field.fields * found.lengths[-1]
    wanted = 1.0 if found.unit == "1" else length
    off = _OF_A_HEADER if found.rounded else max(_SIZES, _SPACING / shape[-1])
    if wanted is not None and abs(period - wanted) > off * period:
        mirrored = " once mirrored" if field.fields == 2.0 else ""
        own = f"{period:.7g}{' m' if found.unit == 'm' else ''}{mirrored}"
        if told_by != "length":
            raise ValueError(f"positions over a period of {own}, not {length:.7g} m as in {told_by}")
        named = "1, the period" if found.unit == "1" else f"length = {length} m"
        raise ValueError(
            f"positions over a period of {own}, one spacing for each of the {shape[-1]} points, not {named}: leave "
            "length out, or correct it"
        )
    factor = wanted / period if wanted is not None and found.rounded else 1.0
    return tuple(factor * size for size in found.lengths), "m" if found.unit == "m" else "1"
