"""The certificate of a contact: how far displacement and traction are from static equilibrium.

A contact is `ok` once its residual is at most `numerics.residual`, by default 1e-8. The residual is the largest of

    violation / peak,    |imbalance| / load,    and the drift,

which `Certificate` explains. The peak is the largest pressure, or the strongest traction of a law if that is larger. `status.py` lists the later checks that may withdraw `ok`. The certificate does not depend
on how a solver keeps bodies from penetrating: Newton's methods choose the nodes that touch and solve for their
pressures (`active_set_newton.py`), and time steps clip displacements at the wall (`kernels/steps.py`).
"""

from dataclasses import dataclass

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid

_NO_TRACTION = 1e-140  # in E*, below which the squares of tractions underflow
_AT_ONCE = 2**18  # nodes that are transformed at once: a map may fill a good part of the memory


@dataclass(frozen=True)
class RigidMean:
    """The condition of bodies that keep their volume, like an incompressible slab: the mean displacement is zero.

    `stiffest` turns a mean displacement into a traction, in E*/L_x. `impossible` `[realisation]` is where the punch is
    pressed so deep that its mean lies below zero and leaves no room for the body.
    """

    stiffest: float
    impossible: Flags

    @classmethod
    def of(cls, punch: Reals, response: SpectralResponse) -> "RigidMean | None":
        """Return the condition for punches `[realisation, (y,) x]`; None where the body may change its volume."""
        if not response.is_rigid:
            return None
        mean = punch.reshape(len(punch), -1).mean(axis=1)
        stiffness = response.normal
        return cls(float(stiffness[np.isfinite(stiffness)].max()), mean < 0.0)

    def violation(self, u: Reals, active: Indices, n: int) -> Reals:
        """Return the violation `[active]` by the mean of the displacements, as a traction in E*."""
        return np.asarray(self.stiffest * np.abs(u[active, :n].mean(axis=1)))

    @staticmethod
    def drift(u: Reals, active: Indices, n: int) -> Reals:
        """Return the mean of the displacements over the largest one `[active]`."""
        mean, largest = np.abs(u[active, :n].mean(axis=1)), np.abs(u[active, :n]).max(axis=1)
        return np.asarray(np.divide(mean, largest, out=np.zeros(mean.shape), where=largest > 0.0))


class Certificate:
    """Violations of the contact conditions in E*, in the rows last looked at, and the scales of the `residual`.

    `violation`: traction on a free node, tension on a touching one, or a tangential traction that friction does not
    balance. Penetration counts as the traction that is left when the surface has been moved back to the wall. Under a
    hardness H, a touching node bears 0 <= p <= H and a penetrating one p = H; what differs from that is the violation.
    `peak`: the largest pressure of the wall. `imbalance`: the mean traction that nothing carries. With a `rigid_mean` a
    mean displacement is a violation too; `drift` is that over the largest displacement. (A uniform pressure deforms
    nothing there: were it huge, it would make any other violation look small.) If the state has the nodes of a corner
    of the grid alone, `mean_displacement` is the mean over the whole grid. `bears` `[realisation]`: these rows of the
    state hold the pressure itself, not the restoring traction. `full_contact` `[realisation]` is the `pressure_scale`,
    if a solver has found it on its way.
    """

    mean_displacement: Reals | None = None
    bears: Flags | None = None
    full_contact: Reals | None = None

    def __init__(self, rows: int, limits: kernels.ContactLimits, rigid_mean: RigidMean | None = None) -> None:
        self.limits, self.rigid_mean = limits, rigid_mean
        self.violation, self.peak, self.imbalance, self.drift = self.found = np.zeros((4, rows))

    def look(self, state: kernels.SurfaceState, active: Indices, n: int, strongest: Reals | float = 0.0) -> Reals:
        """Measure the violations of a state, which may penetrate under a hardness alone; return its `residual`."""
        kernels.wall_violation(state, self.limits, active, n, self.violation, self.peak, self.imbalance)
        if self.rigid_mean is not None:
            u = state.u[:, -1]
            self.violation[active] = np.maximum(self.violation[active], self.rigid_mean.violation(u, active, n))
            self.violation[self.rigid_mean.impossible] = np.inf
            self.drift[active] = self.rigid_mean.drift(u, active, n)
        return self.residual(state.load, active, strongest)

    def bounded(self, i: int, load: Reals, bound: float, peak: float, imbalance: float) -> float:
        """Residual of a row whose violations are known to be below a bound, over the largest pressure."""
        self.violation[i], self.peak[i], self.imbalance[i] = bound * peak, peak, imbalance
        return float(self.residual(load, np.array([i]))[0])

    def residual(self, load: Reals, active: Indices, strongest: Reals | float = 0.0) -> Reals:
        """Worst violation over the largest pressure, or if larger, imbalance over the load, or drift `[active]`.

        Tractions of an interaction law may be far larger than the pressure: the `strongest` one `[active]` is the least
        value of the peak pressure. Surfaces far beyond the range of a law have nothing to balance.
        """
        worst, peak = self.violation[active], np.maximum(self.peak[active], strongest)
        # nothing touches and nothing is violated: the surfaces are apart
        local = np.divide(worst, peak, out=np.where(worst > 0.0, np.inf, worst), where=peak > 0.0)
        loaded = load[active] > 0.0
        balance = np.divide(self.imbalance[active], load[active], out=np.zeros_like(worst), where=loaded)
        found = np.maximum(np.maximum(local, balance), self.drift[active])
        return np.where((worst < _NO_TRACTION) & ~loaded, 0.0, found)


def pressure_scale(punch: Reals, response: SpectralResponse) -> Reals:
    """Root-mean-square pressure fluctuation of full contact `[realisation]`, in E*; in a window as if it went on."""
    window = response.window
    stiffness = response.condensed().normal if window is None else window.stiffness(grid.magnitudes(window.shape))
    shape = punch.shape[1:]
    weight = grid.multiplicity(shape[-1]) * abs(stiffness) ** 2
    weight.flat[0] = 0.0
    some_rows = np.array_split(punch, min(len(punch), -(-punch.size // _AT_ONCE)))
    powers = (np.abs(grid.coefficients(some, len(shape))) ** 2 * weight for some in some_rows)
    return np.asarray(np.sqrt(np.concatenate([power.reshape(len(power), -1).sum(axis=1) for power in powers])))
