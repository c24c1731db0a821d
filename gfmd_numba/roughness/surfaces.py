"""What a scene presses together: random surfaces, given heights, smooth forms, and sums of them."""

import hashlib
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.roughness import generators, statistics
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.measured import MeasuredSurfaces, Place, usable
from gfmd_numba.scene import Discretisation, Document, Measured, Random, Scene
from gfmd_numba.scene.form_record import Form
from gfmd_numba.scene.quantities import LARGEST, SMALLEST
from gfmd_numba.scene.records import ends_of


class _OnGrid:
    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the surface, (nx,) or (ny, nx)."""
        raise NotImplementedError

    @property
    def nx(self) -> int:
        """Number of grid points over the period."""
        return self.shape[-1]

    @property
    def nodes(self) -> int:
        """Number of its nodes."""
        return math.prod(self.shape)


@dataclass(frozen=True)
class GivenSurface(_OnGrid):
    """The user's own heights `[(ny,) nx]`, or the sum of several surfaces, in g L_x."""

    digest: str
    heights: Reals = field(repr=False, compare=False)

    @classmethod
    def of(cls, heights: Reals) -> "GivenSurface":
        """Surface of heights, which tell it from others."""
        return cls(hashlib.sha256(heights.tobytes()).hexdigest(), heights)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the surface."""
        return self.heights.shape


@dataclass(frozen=True)
class SmoothSurface:
    """A smooth form about a `middle` (x, y) on a grid of a shape; its lengths and heights are in L_x."""

    form: Form
    shape: tuple[int, ...]
    middle: tuple[float, ...] = (0.5, 0.5)

    @property
    def heights(self) -> Reals:
        """Heights `[(y,) x]`, 0 at the summit."""
        return self.moved((0.0, 0.0))

    def moved(self, way: tuple[float, ...], ends: tuple[bool, ...] = (True, True)) -> Reals:
        """Heights `[(y,) x]` after a way (x, y), of a form that goes on where it `ends` and else repeats (L_x)."""
        places = zip(self.shape[::-1], self.middle, way, strict=False)
        x, *y = (np.arange(n) / n - middle - step for n, middle, step in places)
        x, *y = (at if end else at - np.round(at) for at, end in zip((x, *y), ends[::-1], strict=False))
        return np.asarray(self.form.heights(x, *(at[:, np.newaxis] for at in y)))


@dataclass(frozen=True)
class Topography:
    """One of several surfaces that are pressed together, in units of a `gradient` and L_x.

    That of a body is `centred`: each of its realisations has zero mean.
    """

    surface: RandomSurface | GivenSurface | SmoothSurface
    gradient: float
    centred: bool

    @property
    def rms_gradient(self) -> float:
        """Rms gradient that is asked of it, or the one that it has."""
        if isinstance(self.surface, RandomSurface):
            return self.gradient
        return float(statistics.rms_gradient(self.drawn(0), (1.0,) * len(self.surface.shape)))

    def drawn(self, realisation: int) -> Reals:
        """Heights `[(y,) x]` in L_x, peaks outwards; raises ValueError for a grid that cannot hold the waves."""
        if isinstance(self.surface, RandomSurface):
            heights = np.asarray(self.gradient * self.surface.heights(range(realisation, realisation + 1))[0])
        else:
            heights = self.gradient * self.surface.heights
        return heights - heights.mean() if self.centred else heights


@dataclass(frozen=True)
class SummedSurface(_OnGrid):
    """What several surfaces are together, in L_x and units of `rms_gradient`, the g that is asked of all rough ones."""

    parts: tuple[Topography, ...]
    rms_gradient: float

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the surface, (nx,) or (ny, nx)."""
        return self.parts[0].surface.shape

    def drawn(self, realisation: int) -> list[Reals]:
        """Heights `[(y,) x]` of each part in L_x; raises ValueError for a grid that cannot hold the waves."""
        return [part.drawn(realisation) for part in self.parts]

    @property
    def alone(self) -> SmoothSurface | None:
        """The smooth form that is all there is, None where it has a roughness."""
        surface = self.parts[0].surface
        return surface if len(self.parts) == 1 and isinstance(surface, SmoothSurface) else None

    @property
    def form(self) -> Reals | None:
        """Heights `[(y,) x]` in its units of the smooth form that is one of them, None without."""
        smooth = [part.drawn(0) for part in self.parts if isinstance(part.surface, SmoothSurface)]
        return smooth[0] / self.rms_gradient if smooth else None


Surface = RandomSurface | GivenSurface | SummedSurface


def without_shortest(surface: Surface, nx: int, halvings: int) -> Surface | None:
    """Random surface on nx points whose largest wave index is halved so often; None where there is none."""
    if isinstance(surface, GivenSurface):
        return None  # measured, with no spectrum that could be cut
    if isinstance(surface, RandomSurface):
        generator = surface.generator.without_shortest(halvings)
        return None if generator is None else replace(surface, nx=nx, generator=generator)
    parts = []
    for part in surface.parts:
        if isinstance(part.surface, SmoothSurface):
            parts.append(replace(part, surface=replace(part.surface, shape=(nx,) * len(surface.shape))))
            continue
        fewer_waves = without_shortest(part.surface, nx, halvings)
        if not isinstance(fewer_waves, RandomSurface):
            return None
        parts.append(replace(part, surface=fewer_waves))
    return replace(surface, parts=tuple(parts))


def given_surface(heights: Reals, gradient: float | None = None, periodic: object = True) -> tuple[GivenSurface, float]:
    """Surface in units of a `gradient` g, by default the rms gradient of its heights (in L_x), and that gradient.

    Raises ValueError for a flat surface, without roughness to speak of, or one too large for its gradient.
    """
    scale, slope = statistics.scaled_gradient(heights, ends_of(periodic, heights.ndim))
    rounding = heights.shape[-1] * np.finfo(float).eps  # about the rms gradient of heights of order 1 that are rounded
    own = slope * scale
    if slope <= 100.0 * rounding:
        size = f"an rms gradient of {own:.2g} in heights of up to {np.abs(heights).max():.3g}"
        raise ValueError(f"{size}: it is flat but for rounding")
    if not SMALLEST <= own <= LARGEST:
        raise ValueError(f"an rms gradient of {own:.3g}, not from {SMALLEST:g} to {LARGEST:g}")
    unit = heights / scale / (slope if gradient is None else gradient / scale)
    return GivenSurface.of(unit), own if gradient is None else gradient


def random_surface(
    place: Place, scene: Scene, discretisation: Discretisation | None, seed: int, document: Document
) -> tuple[RandomSurface, float]:
    """Ensemble of the record at a place of a scene, and the rms gradient asked of it.

    Raises InputError for one that cannot be used, as lengths may not go with the period.
    """
    record = scene.in_periods.surfaces[place]
    assert isinstance(record, Random)  # any other is measured
    with usable(document, ("scene", *place)):
        return generators.random_surface(record, discretisation, scene.dimension, seed, scene.periods)


def surface_of_the_punch(
    scene: Scene, discretisation: Discretisation | None, seed: int, measured: MeasuredSurfaces, document: Document
) -> tuple[RandomSurface | GivenSurface, float] | None:
    """Roughness of a rigid punch in units of its rms gradient, and that; None without, InputError if it is unusable."""
    record = scene.roughness
    if isinstance(record, Measured):
        with usable(document, ("scene", "roughness"), record):
            return given_surface(measured["roughness",].in_periods, periodic=scene.periodic)
    return None if record is None else random_surface(("roughness",), scene, discretisation, seed, document)


def on_its_form(scene: Scene, rough: RandomSurface | GivenSurface, gradient: float) -> Surface:
    """Surface of a rigid punch, its roughness on its form, if any, in units of the rms gradient g of its roughness."""
    if scene.form is None:
        return rough
    return SummedSurface((Topography(rough, gradient, False), _smooth_part(scene, rough.shape)), gradient)


def _smooth_part(scene: Scene, shape: tuple[int, ...] | None) -> Topography:
    """Form of the punch of a scene, on the grid of its roughness, or its own where the shape of that is None.

    It stands on the middle of a measured field: where the mirror image doubles that, on a quarter of the period.
    """
    form = scene.in_periods.form
    assert form is not None  # the caller's promise
    if shape is None:
        assert form.points is not None  # the promise of a scene without roughness
        shape = (form.points,) * scene.dimension
    mirrored = any(isinstance(each, Measured) and each.periodic == "mirror" for each in scene.surfaces.values())
    middle = tuple(0.25 if mirrored and not end else 0.5 for end in scene.ends[::-1])
    return Topography(SmoothSurface(form, shape, middle), 1.0, False)


def sum_of_surfaces(
    scene: Scene, discretisation: Discretisation | None, seed: int, measured: MeasuredSurfaces, document: Document
) -> SummedSurface:
    """All surfaces of a scene, in its order, and its form; raises InputError for unusable ones.

    A random body faces a random punch or counter body with the next seed. The rms gradient is what the scene asks for
    of all, wherever the roughness lies: random surfaces are independent of all others, so that mean squares add up in
    the mean over them; measured ones are what they are, so that their heights do. Of a form alone it is its own.
    """
    parts: dict[Place, Topography] = {}
    asked: dict[Place, float] = {}
    for place, record in scene.surfaces.items():
        centred = place != ("roughness",)
        if isinstance(record, Measured):
            parts[place] = Topography(GivenSurface.of(measured[place].in_periods), 1.0, centred)
        else:
            surface, asked[place] = random_surface(place, scene, discretisation, seed, document)
            parts[place] = Topography(surface, asked[place], centred)
            seed = (seed + 1) % 2**32
    shape = _common_shape(parts, document)
    smooth = () if scene.form is None else (_smooth_part(scene, shape),)
    given = [part.drawn(0) for place, part in parts.items() if place not in asked]
    own = [math.prod(statistics.scaled_gradient(np.sum(given, axis=0), scene.ends))] if given else []
    gradient = math.hypot(*asked.values(), *own)
    if smooth and not gradient:
        try:
            gradient = given_surface(smooth[0].drawn(0), periodic=scene.periodic)[1]
        except ValueError as error:
            raise document.refused(("scene", "form"), f"a form that is not flat, not {error}") from None
    return SummedSurface((*parts.values(), *smooth), gradient)


def _common_shape(parts: Mapping[Place, Topography], document: Document) -> tuple[int, ...] | None:
    """Shape of all surfaces, by their places; raises InputError where they differ, None where a campaign varies all."""
    fixed = (part.surface.shape for place, part in parts.items() if ("scene", *place) not in document.elsewhere)
    shape = next(fixed, None)
    for place, part in parts.items():
        if shape is not None and part.surface.shape != shape:
            told, allowed = (" x ".join(map(str, each)) for each in (part.surface.shape, shape))
            wanted = f"as many heights as the other surface has, {allowed}"
            raise document.fault(("scene", *place), f"{told} heights", wanted)
    return shape
