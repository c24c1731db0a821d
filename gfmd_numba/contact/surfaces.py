"""Surfaces of a problem that are not random: given heights, smooth forms, and sums of surfaces."""

import hashlib
import math
from dataclasses import dataclass, field, replace

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.roughness import statistics
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.scene.form_record import Form


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
    def nx(self) -> int:
        """Number of grid points over the period."""
        return self.shape[-1]

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
