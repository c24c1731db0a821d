"""The largest square about the centre of a measured map, as instruments rarely see as far both ways."""

import math
from dataclasses import replace

from gfmd_numba.roughness.measurements import Measurement

_EQUAL = 1e-3  # by which sizes of the square may differ without a word: positions and sizes in files are rounded
_WHOLE = 1e-6  # of a spacing, likewise


def largest_square(found: Measurement) -> Measurement:
    """Cut the largest square about the centre out of a map `[ny, nx]`.

    Where the spacings along x and y differ, so do the numbers of points, and the sides agree to half of the finer
    spacing. A map without sizes has square pixels. Raises ValueError for a profile, and for fewer than 4 points a side.
    """
    if found.heights.ndim == 1:
        raise ValueError("a profile, where crop: square needs a map: leave crop out")
    shape = found.heights.shape
    sizes = found.lengths if found.lengths is not None else tuple(map(float, shape))
    spacings = [size / n for size, n in zip(sizes, shape, strict=True)]
    coarse = max(spacings)
    side = math.floor(min(sizes) / coarse + _WHOLE) * coarse
    counts = [min(n, round(side / spacing)) for n, spacing in zip(shape, spacings, strict=True)]
    if tuple(counts) == shape and max(sizes) <= min(sizes) * (1.0 + _WHOLE):
        return found
    if min(counts) < 4:
        raise ValueError(f"{' x '.join(map(str, counts))} heights in the largest square, not at least 4")
    begins = [(n - count) // 2 for n, count in zip(shape, counts, strict=True)]
    heights = found.heights[tuple(slice(begin, begin + count) for begin, count in zip(begins, counts, strict=True))]
    said = f"cut out the middle {counts[0]} x {counts[1]} of {shape[0]} x {shape[1]} points, a square"
    misfit = max(abs(count * spacing / side - 1.0) for count, spacing in zip(counts, spacings, strict=True))
    if misfit > _EQUAL:
        said += f" once stretched by {100 * misfit:.2g} %"
    lengths = (side, side) if found.lengths is not None else None
    return replace(found, heights=heights, lengths=lengths, done=(*found.done, said))
