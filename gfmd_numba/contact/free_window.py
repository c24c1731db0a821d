"""A contact without a period, as the solvers see it: the window of the punch in a padded grid that nothing touches.

The elastic body is free around the window (`elasticity/free_body.py`), where the punch is flat and far away. Most
solvers run on the whole padded grid; `tiles/newton.py` runs on the window alone. All results are those of the window.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity import free_body
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.interface.normal_law import NormalLaw
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw
from gfmd_numba.solvers.equilibrium import Equilibrium
from gfmd_numba.solvers.iteration import Start

# times the mean pressure over E*, in L_x: a flat punch sinks in by at most 0.88 of that, and slabs bulge around it
_ABOVE = 2.0
FARTHER = (1.0, 10.0, 100.0, 1000.0)  # of which the first that nothing touches is enough
_PULLED = 3.0  # times the traction of a law over E*, in L_x: more than that pulls up even the whole window
_NO_TRACTION = 1e-17  # of that at zero gap, which a law has where it acts no more
_RANGES = 45.0  # of a law of gap and slip, at which it has as little
_SHORTEST = 1e-9  # range of a law, in L_x
_APART = 1.0  # of the size of the punch, at which it is where its displacement is prescribed


def around(punch: Reals, load: float | None, laws: Interactions, factor: float = 1.0, farther: float = 1.0) -> Reals:
    """Height `[realisation, (1,) 1]` of a punch around its window, so far away that nothing touches there.

    The height is no larger than needed, as rounding of residuals grows with the heights of the punch. A punch under a
    `load` sinks in by less than a flat one at its highest point. The body is stiffer than E* by a `factor`. Slabs that
    keep their volume may bulge so far that they need a punch that is `farther` by a factor.
    """
    along = tuple(range(1, punch.ndim))
    highest = punch.max(axis=along, keepdims=True)
    if load is None:
        far = np.maximum(highest, 0.0) + farther * _APART * np.abs(punch).max(axis=along, keepdims=True)
    else:
        far = highest + farther * _ABOVE * load / factor
    for law in (laws.normal_law, laws.cohesive):
        if law is not None:
            far = far + _PULLED * abs(law.strength) / factor + reach(law)
    return np.asarray(far)


def reach(law: NormalLaw | XuNeedlemanLaw) -> float:
    """Gap beyond which a law acts no more, or up to twice that."""
    none, gap = np.zeros(1), _SHORTEST
    if isinstance(law, XuNeedlemanLaw):
        return _RANGES * law.normal
    while abs(float(law.traction(none + gap)[0])) > _NO_TRACTION * abs(law.strength):
        gap *= 2.0
    return gap


def area_fraction(ends: tuple[bool, ...]) -> float:
    """Share of the padded grid that the window is: of a mean pressure there."""
    return float(free_body.WIDER ** -sum(ends))


def start(
    window: Start, before: Equilibrium, sunk: Reals | float, response: SpectralResponse, ends: tuple[bool, ...]
) -> Start:
    """Initial state on the padded grid of one in the window: around that, what the tractions before do to the body.

    The solver has the body at rest higher by what the punch has `sunk` in.
    """
    corner, along = grid.corner(window.displacement.shape[1:]), before.tangential
    tractions = -before.pressure[:, np.newaxis]
    if along is not None:
        tractions = np.concatenate((along.traction, tractions), axis=1)
    wide = np.zeros((*tractions.shape[:2], *free_body.padded_shape(tractions.shape[2:], ends)))
    wide[corner] = tractions
    moved = np.stack([response.apply(each) for each in wide])
    displacement = np.asarray(sunk + moved[:, -1])
    open_nodes = displacement[corner]
    displacement[corner] = np.where(before.touching, window.displacement, open_nodes)
    if along is None:
        return replace(Start.at_rest(displacement), displacement=displacement)
    sideways = moved[:, :-1]
    sideways[corner] = window.tangential
    return Start(displacement, sideways, window.dragged)


def sunk_in(found: Equilibrium, response: SpectralResponse, ends: tuple[bool, ...]) -> Reals:
    """How far a load has pushed the body at rest up to the punch `[realisation, (1,) 1]`, whose place is arbitrary."""
    along = tuple(range(1, found.pressure.ndim))
    assert found.mean_displacement is not None  # of a corner it is known
    compressed = area_fraction(ends) * found.pressure.mean(axis=along, keepdims=True) / response.normal.flat[0]
    return np.asarray(found.mean_displacement.reshape(compressed.shape) + compressed)


def in_corner(values: npt.NDArray[Any], around: npt.NDArray[Any], ends: tuple[bool, ...]) -> npt.NDArray[Any]:
    """Values `[realisation, (y,) x]` in the corner of the padded grid, and others around them, of that shape or 1."""
    whole = np.broadcast_to(around, (len(values), *free_body.padded_shape(values.shape[1:], ends))).astype(values.dtype)
    whole[grid.corner(values.shape[1:])] = values
    return whole
