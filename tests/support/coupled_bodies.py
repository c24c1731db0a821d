"""Bodies whose normal and tangential displacements are coupled."""

import mpmath
import numpy as np

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.solvers.boundary_value_problem import deform
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options

NX = 128
X = np.arange(NX) / NX
FREE = np.full((2, NX), np.nan)


def body(nu, aspect_ratio, nx=NX):
    return ElasticBody(nu, None if np.isinf(aspect_ratio) else aspect_ratio).response((nx,))


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


def compliance_of_wave(k, nu, aspect_ratio):
    """Tangential and normal displacement sin and cos under tractions T1 sin and T3 cos of one wave, (2.12), (6.58)."""
    with mpmath.workdps(60):
        # nu = 1/2 is a limit
        nu = mpmath.mpf(nu) - (mpmath.mpf(10) ** -40 if nu == 0.5 else 0)
        q, s = 2 * mpmath.pi * k, (1 - 2 * nu) / (2 * (1 - nu))
        r, c11 = (1 - s) / (1 + s), (1 - nu) ** 2 / (1 - 2 * nu)
        qz = min(q * mpmath.mpf(aspect_ratio), mpmath.mpf(200))
        sinh, cosh = mpmath.sinh(qz), mpmath.cosh(qz)
        f = sinh**2 - (r * qz) ** 2
        m11, m33 = ((1 - r) * (cosh * sinh + sign * r * qz) / f for sign in (-1, 1))
        m13 = (1 - r) / (1 + r) * ((1 - r) * sinh**2 - 2 * (r * qz) ** 2) / f
        inverse = mpmath.matrix([[m11, -m13], [-m13, m33]]) ** -1 / (q * c11)
        return np.array(inverse.tolist(), dtype=float)
