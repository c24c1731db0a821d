"""A deformable body whose own surface is rough, and what its topography leaves room for."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.problem import DeformableBody
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid

STEEPEST = 0.030  # rms gradient that the thesis allows order 0 (5.3.4)
THICKNESS = 0.01  # change of a film's thickness, over the thickness, above which order 0 is doubted


@dataclass(frozen=True)
class RoughBody:
    """A deformable body, its stress-free topography `[(y,) x]` of zero mean in L_x, and its part E*/E_i* of 1/E*.

    `side` is -1 for the upper one of two, on which the lower one pulls the opposite way.
    """

    elastic: ElasticBody
    heights: Reals
    share: float
    side: int = 1


def rough_body(body: DeformableBody, drawn: Sequence[Reals], order: int) -> RoughBody:
    """A deformable body, the surfaces `[(y,) x]` having `drawn` these heights (L_x).

    Raises ValueError for a topography that reaches through it, or at an order above 0 through its topmost layer.
    """
    heights = np.zeros_like(drawn[0]) if body.part is None else drawn[body.part]
    if allowed := allowed_topography(heights, body.elastic, order):
        span = f"from {heights.min():.3g} to {heights.max():.3g} L_x"
        raise ValueError(f"a topography {span} in place of {allowed}")
    return RoughBody(body.elastic, heights, body.share, body.side)


def allowed_topography(heights: Reals, body: ElasticBody, order: int) -> str:
    """What is allowed in place of heights `[(y,) x]` that a body has no room for; nothing if it has."""
    lowest, highest = float(heights.min()), float(heights.max())
    if body.aspect_ratio is not None and max(-lowest, highest) >= body.aspect_ratio:
        return f"one within the height of the body, {body.aspect_ratio:g} L_x, of its mean plane"
    if order > 0 and body.stack is not None and -lowest >= -body.top.base:
        return (
            f"valleys above the lower side of the topmost layer, {body.top.base:g} L_x, or a numerics.topography_order "
            "of 0, as interfaces are flat at higher orders"
        )
    return ""


def change_of_thickness(body: RoughBody) -> float:
    """Largest height over the thickness in waves so long that the body is a film to them, q z_m <= 1; 0 if none are.

    Of a layered body the film is the topmost layer.
    """
    thickness = body.elastic.top.aspect_ratio
    if thickness is None:
        return 0.0
    waves = grid.coefficients(body.heights, body.heights.ndim)
    waves[grid.magnitudes(body.heights.shape) * thickness > 1.0] = 0.0
    return float(abs(grid.signal(waves, *body.heights.shape)).max()) / thickness
