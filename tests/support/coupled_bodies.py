"""Bodies whose normal and tangential displacements are coupled."""

import numpy as np

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.solvers.boundary_value_problem import deform
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.status import Status

NX = 128
X = np.arange(NX) / NX
FREE = np.full((2, NX), np.nan)


def body(nu, aspect_ratio, nx=NX):
    return ElasticBody(nu, None if np.isinf(aspect_ratio) else aspect_ratio).coupled_stiffness(nx)


def settled(*arguments, residual=1e-10):
    result = deform(*arguments, Options("verlet", residual=residual))
    assert result.status == Status.ok
    return result


def flat(nx, nodes, normal, tangential=None):
    """Displacements prescribed on the middle nodes, and their positions about the centre of the punch."""
    first, given = (nx - nodes) // 2, np.full((2, nx), np.nan)
    given[1, first : first + nodes] = normal
    if tangential is not None:
        given[0, first : first + nodes] = tangential
    return given, (np.arange(nx) - first - (nodes - 1) / 2) / nx
