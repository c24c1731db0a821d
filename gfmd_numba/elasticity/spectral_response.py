"""Response of a body to tractions on its periodic surface, wave by wave.

One matrix for each wave links its displacements to their tractions: the normal displacement alone, both of a profile,
or all three of a map. A wave of wave vector q = |q| (c, s) splits in two. The part along q and out of the surface is
the wave of a profile, with K11, K13 and K33 of (6.57). The part across q is a wave of shear alone, which does not
couple to the other part, of stiffness K22, G |q| for a half-space. In the axes x, y of the map, with z out of the
surface, the stiffness is the Hermitian matrix

    [[xx, xy, i xz], [xy, yy, i yz], [-i xz, -i yz, zz]],    xx = K11 c^2 + K22 s^2,    xy = (K11 - K22) c s,
    yy = K11 s^2 + K22 c^2,    xz = K13 c,    yz = K13 s,    zz = K33,

and the compliance, its inverse, is of the same form: the phases drop out, so that real symmetric matrices are inverted.
A profile has xx = K11, xz = K13 and zz = K33 alone, and the normal displacement alone has zz.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from gfmd_numba.arrays import Complexes, Reals
from gfmd_numba.elasticity.stiffness import in_series
from gfmd_numba.fourier import grid

_UNIT = np.array([1.0, 0.0, 1.0, 0.0, 0.0, 1.0])  # xx, xy, yy, xz, yz, zz of displacements that are not followed
_FOLLOWED = {1: [5], 3: [0, 3, 5], 6: [0, 1, 2, 3, 4, 5]}  # which of these there are, by their number
_DIAGONAL = {1: [0], 3: [0, 2], 6: [0, 2, 5]}  # of these
_ODD = {1: [], 3: [[1]], 6: [[1, 3], [1, 4]]}  # that couple x to others, and y: they change sign with q_x, and with q_y
_OUT_OF_PLANE = {1: [], 3: [1], 6: [3, 4]}  # that couple either to z


@dataclass(frozen=True)
class Window:
    """The corner of (ny,) nx nodes that alone is ever touched, on the padded grid of a body without a period.

    The `padded` grid has (ny,) nx nodes of its own. `stiffness` is that of the normal displacement in the body's own
    waves of some numbers, in E*/L_x.
    """

    shape: tuple[int, ...]
    padded: tuple[int, ...]
    stiffness: Callable[[Reals], Reals] = field(compare=False)


@dataclass(frozen=True)
class SpectralResponse:
    """Elements of the stiffness `[element, (ny,) nx // 2 + 1]`, in E*/L_x: zz, or xx, xz and zz, or all six.

    At q = 0 they are 0 where nothing restores a mean displacement, and infinite where it is rigid. `window` is that of
    the normal displacement of a body without a period, and None with one.
    """

    elements: Reals
    window: Window | None = None

    @classmethod
    def of_normal(cls, stiffness: Reals, window: Window | None = None) -> "SpectralResponse":
        """Response of the normal displacement alone, of a stiffness `[(ny,) nx // 2 + 1]`."""
        return cls(stiffness[np.newaxis], window)

    @classmethod
    def on_grid(cls, shape: tuple[int, ...], k11: Reals, k13: Reals, k33: Reals, k22: Reals) -> "SpectralResponse":
        """Response on (ny,) nx nodes from the stiffness of waves along q and, which count on maps, of those across.

        All are `[(ny,) nx // 2 + 1]`.
        """
        qy, qx = grid.wavevectors((1, *shape)[-2:], (1.0, 1.0))
        q = np.hypot(qy, qx)
        q[0, 0] = 1.0
        c, s = (each.reshape(k11.shape) for each in (qx / q, qy / q))
        c.flat[0] = 1.0  # the uniform displacements, one as stiff as the other
        along, both, across = k11 * c**2 + k22 * s**2, (k11 - k22) * c * s, k11 * s**2 + k22 * c**2
        every, components = np.array([along, both, across, k13 * c, k13 * s, k33]), len(shape) + 1
        return cls(_free_at_nyquist(every[_FOLLOWED[components * (components + 1) // 2]], shape))

    @property
    def components(self) -> int:
        """Number of displacements that are followed, the normal one last."""
        return len(_DIAGONAL[len(self.elements)])

    @property
    def diagonal(self) -> Reals:
        """Stiffness of each displacement alone `[component, (ny,) nx // 2 + 1]`."""
        return diagonal(self.elements)

    @property
    def normal(self) -> Reals:
        """Stiffness of the normal displacement alone `[(ny,) nx // 2 + 1]`."""
        return np.asarray(self.elements[-1])

    @property
    def lags(self) -> bool:
        """Whether displacements lag behind tractions, as those of viscoelastic bodies do under a punch that slides."""
        return bool(np.iscomplexobj(self.elements))

    @property
    def is_rigid(self) -> bool:
        """Whether the mean normal displacement is rigid, as the body keeps its volume."""
        return not np.isfinite(self.normal.flat[0])

    @property
    def drifts(self) -> bool:
        """Whether nothing restores the mean tangential displacement."""
        return bool(self.elements[0].flat[0] == 0.0)

    def condensed(self) -> "SpectralResponse":
        """Response of the normal displacement where no tangential traction acts (Schur complement, 6.75)."""
        if self.components == 1:
            return self
        xx, xy, yy, xz, yz, zz = _whole(self.elements)
        plane = xx * yy - xy**2
        softer = xz**2 * yy - 2.0 * xy * xz * yz + yz**2 * xx
        return self.of_normal(zz - np.divide(softer, plane, out=np.zeros_like(plane), where=softer != 0.0))

    def inverse(self) -> Reals:
        """Elements of the compliance, in the same order; zero for a mean displacement that nothing restores, or rigid.

        In L_x/E*.
        """
        mean = _mean(self.elements)
        held = self.elements.copy()
        _mean(held)[:] = _UNIT[_FOLLOWED[len(held)]]
        found = inverse(held)
        _mean(found)[:] = np.divide(1.0, mean, out=np.zeros_like(mean), where=mean > 0.0)
        return found

    def apply(self, traction: Reals) -> Reals:
        """Displacement `[component, (y,) x]` under tractions of its shape in E*; 0 in a mean that nothing restores."""
        shape = traction.shape[1:]
        return grid.signal(self.displaced(grid.coefficients(traction, len(shape))), *shape)

    def displaced(self, traction: Complexes) -> Complexes:
        """Coefficients `[component, (k_y,) k_x]` of the displacement under tractions of such coefficients."""
        *along, z = traction
        x, y = (*along, 0.0, 0.0)[:2]
        xx, xy, yy, xz, yz, zz = _whole(self.inverse())
        moved = xx * x + xy * y + 1j * xz * z, xy * x + yy * y + 1j * yz * z
        out = zz * z - 1j * (xz * x + yz * y)
        return np.array([*moved[: len(along)], out])

    def in_series(self, other: "SpectralResponse", compliance_fraction: float) -> "SpectralResponse":
        """Response of two bodies that face each other: of their approach and relative tangential displacement.

        Compliances add up wave by wave, but the couplings xz and yz subtract: one pressure moves both surfaces along x
        the same way. The difference on half-spaces is 2 beta/q with Dundurs' beta. Each body counts in its own E*, the
        result in the E* of both together; `compliance_fraction` is the part of the other body in 1/E*.
        """
        window = None
        if self.window is not None and other.window is not None:
            ways = self.window.stiffness, other.window.stiffness
            window = replace(self.window, stiffness=lambda q: in_series(ways[0](q), ways[1](q), compliance_fraction))
        facing = other.inverse()
        facing[_OUT_OF_PLANE[len(facing)]] *= -1.0
        compliance = (1.0 - compliance_fraction) * self.inverse() + compliance_fraction * facing
        _mean(compliance)[:] = _UNIT[_FOLLOWED[len(facing)]]
        found, own = inverse(compliance), _mean(self.elements)
        _mean(found)[:] = np.where(own > 0.0, in_series(own, _mean(other.elements), compliance_fraction), 0.0)
        return SpectralResponse(found, window)

    def coarsened(self, shape: tuple[int, ...]) -> "SpectralResponse":
        """Return the response of the waves that a coarser grid of a shape holds."""
        waves = grid.wave_indices(shape)
        return SpectralResponse(_free_at_nyquist(np.array([element[waves] for element in self.elements]), shape))

    def restored(self) -> "SpectralResponse":
        """The same with means that nothing restores as stiff as the softest wave of theirs: contact makes them so."""
        elements = self.elements.copy()
        for place in _DIAGONAL[len(elements)]:
            waves = elements[place].reshape(-1)
            waves[0] = waves[0] if waves[0] > 0.0 else waves[1:].min()
        return SpectralResponse(elements)

    def with_mean(self, stiffness: float) -> "SpectralResponse":
        """The same with another stiffness of the mean normal displacement: with 0 it follows the load freely."""
        if self.normal.flat[0] == stiffness:
            return self
        elements = self.elements.copy()
        elements[-1].flat[0] = stiffness
        return SpectralResponse(elements, self.window)

    def scaled(self, factor: float) -> "SpectralResponse":
        """The same of a body that is stiffer by a factor."""
        if factor == 1.0:
            return self
        window = self.window
        if window is not None:
            of_waves = window.stiffness
            window = replace(window, stiffness=lambda q: factor * of_waves(q))
        return SpectralResponse(factor * self.elements, window)

    def with_yielding(self, compliance: float) -> "SpectralResponse":
        """Response with a wall that yields to the pressure at each node.

        The wall yields by `compliance` (L_x/E*) times the pressure. A mean displacement that nothing restores remains
        free.
        """
        window = self.window
        if window is not None:
            of_waves = window.stiffness
            window = replace(window, stiffness=lambda q: _yielding(of_waves(q), compliance))
        xx, xy, yy, xz, yz, zz = _whole(self.elements)
        left = 1.0 / (1.0 + compliance * zz)  # of the couplings
        taken = compliance * left
        whole = xx - taken * xz**2, xy - taken * xz * yz, yy - taken * yz**2, left * xz, left * yz
        of_all = *whole, _yielding(zz, compliance)
        return SpectralResponse(np.array([of_all[place] for place in _FOLLOWED[len(self.elements)]]), window)

    def principal(self) -> tuple[Reals, Reals]:
        """Smallest and largest stiffness of the decoupled modes of each wave (6.84) `[(ny,) nx // 2 + 1]`."""
        if self.components == 1:
            return self.normal, self.normal
        xx, xy, yy, xz, yz, zz = _whole(self.elements)
        if self.components == 2:
            larger = 0.5 * (xx + zz) + np.hypot(0.5 * (xx - zz), xz)
            return np.divide(xx * zz - xz**2, larger, out=np.zeros_like(larger), where=larger > 0.0), larger
        found = np.linalg.eigvalsh(np.moveaxis(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), (0, 1), (-2, -1)))
        return found[..., 0], found[..., 2]

    def extremes(self) -> tuple[float, float]:
        """Stiffness of the softest mode that anything restores, and of the stiffest one."""
        smaller, larger = self.principal()
        return float(smaller[smaller > 0.0].min()), float(larger.max())


def diagonal(elements: Reals) -> Reals:
    """Elements of each component alone `[component, ...]` of a stiffness or a compliance."""
    return elements[_DIAGONAL[len(elements)]]


def _yielding(stiffness: Reals, compliance: float) -> Reals:
    with np.errstate(divide="ignore"):
        return np.asarray(1.0 / (1.0 / stiffness + compliance))


def _mean(elements: Reals) -> Reals:
    """Elements of the mean displacements, to be read or written."""
    return elements.reshape(len(elements), -1)[:, 0]


def _whole(elements: Reals) -> list[Reals]:
    """All elements xx, xy, yy, xz, yz and zz: a displacement that is not followed has a unit stiffness of its own."""
    whole = list(_UNIT)
    for place, element in zip(_FOLLOWED[len(elements)], elements, strict=True):
        whole[place] = element
    return whole


def inverse(elements: Reals) -> Reals:
    """Inverses of real symmetric matrices `[element, ...]`, by their adjugates."""
    if len(elements) == 1:
        return 1.0 / elements
    xx, xy, yy, xz, yz, zz = _whole(elements)
    adjugate = (
        yy * zz - yz**2,
        xz * yz - xy * zz,
        xx * zz - xz**2,
        xy * yz - xz * yy,
        xy * xz - xx * yz,
        xx * yy - xy**2,
    )
    determinant = xx * adjugate[0] + xy * adjugate[1] + xz * adjugate[3]
    return np.array([adjugate[place] / determinant for place in _FOLLOWED[len(elements)]])


def _free_at_nyquist(elements: Reals, shape: tuple[int, ...]) -> Reals:
    """Elements, which are overwritten at Nyquist, on a grid of a shape.

    There the grid does not tell the waves q_x and -q_x (or q_y and -q_y): what both give way is averaged, as if all
    that vanishes on every node were free. One of the waves q_x and -q_x lags as far as the other leads.
    """
    for axis, odd in zip((-1, -2), _ODD[len(elements)], strict=False):
        if shape[axis] % 2 == 0:
            at_nyquist = np.moveaxis(elements, axis, 1)[:, shape[axis] // 2]
            compliance = inverse(at_nyquist)
            compliance[odd] = 0.0
            at_nyquist[:] = inverse(compliance.real if axis == -1 else compliance)
    return elements
