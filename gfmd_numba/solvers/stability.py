"""How far an equilibrium under a law of the gap is from a fold of its branch: the smallest curvature of its energy."""

import warnings

import numpy as np
import numpy.typing as npt
from scipy.sparse.linalg import LinearOperator, lobpcg

from gfmd_numba.arrays import Reals
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import NormalLaw

_VECTORS, _ITERATIONS, _TOLERANCE = 3, 60, 1e-5


def smallest_curvature(gap: Reals, held: npt.NDArray[np.bool_], stiffness: Reals, law: NormalLaw) -> float:
    """Smallest second derivative of the energy over that of the body alone, of one contact `[(y,) x]`.

    1 where the law does nothing, 0 at a fold (jump-in or pull-off), below 0 where the equilibrium is unstable. Nodes
    that are `held` by the wall do not move. `stiffness` is K(q) `[(ny,) nx // 2 + 1]`; a mean that nothing restores
    counts as stiff as the softest wave. By Knyazev's method (SIAM J. Sci. Comput. 23:517, 2001).
    """
    shape, free = gap.shape, np.flatnonzero(~held)
    if len(free) == 0:
        return 1.0
    positive = np.where(stiffness > 0.0, stiffness, stiffness.ravel()[1:].min())
    curvature = law.stiffness(gap).ravel()[free]

    def filtered(symbol: Reals, x: Reals) -> Reals:
        whole = np.zeros((x.shape[1], *shape))
        whole.reshape(len(whole), -1)[:, free] = x.T
        filtered = grid.signal(symbol * grid.coefficients(whole, len(shape)), *shape)
        return filtered.reshape(len(whole), -1)[:, free].T

    def operator(product: object) -> LinearOperator:
        return LinearOperator((len(free), len(free)), matvec=product, matmat=product, dtype=np.float64)

    def columns(x: Reals) -> Reals:
        return x.reshape(len(free), -1)

    body = operator(lambda x: filtered(positive, columns(x)))
    energy = operator(lambda x: filtered(stiffness, columns(x)) + curvature[:, np.newaxis] * columns(x))
    compliance = operator(lambda x: filtered(1.0 / positive, columns(x)))
    if len(free) < 5 * _VECTORS:  # too few for iterations
        every = np.eye(len(free))
        lower = np.linalg.inv(np.linalg.cholesky(body.matmat(every)))
        return float(np.linalg.eigvalsh(lower @ energy.matmat(every) @ lower.T)[0])
    guess = np.random.default_rng(0).normal(size=(len(free), _VECTORS))
    if curvature.any():  # about where the law softens most; a mode exactly would end the search for a lower one
        guess[:, 0] = np.abs(curvature) / np.abs(curvature).max() + 0.1 * guess[:, 0]
    with warnings.catch_warnings(action="ignore", category=UserWarning):  # of the larger ones, which nobody needs
        values, _ = lobpcg(energy, guess, body, compliance, tol=_TOLERANCE, maxiter=_ITERATIONS, largest=False)
    return float(values.min())
