"""Active-set Newton method for the hard wall on profiles whose compliance is a sum of decays."""

from dataclasses import dataclass, replace
from functools import lru_cache
from math import sqrt
from threading import get_ident
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.elasticity.spectral_response import Window
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import Transform, aligned_rows
from gfmd_numba.kernels.exponential_sums import POWERS
from gfmd_numba.solvers.active_set_newton import ActiveSetNewton
from gfmd_numba.solvers.exponential_sums.exponential_sum import ExponentialSum
from gfmd_numba.solvers.iteration import Batch
from gfmd_numba.solvers.table import SOLVERS, Options

# 32 decays, within 1e-5 to 4e-5 of 1/q at 2^13 to 2^20 nodes; alternating ones, (-1)^m exp(-rate m), for the kink of
# |q| at Nyquist
_SMOOTH, _ALTERNATING = 20, 12
_SLOWEST, _FASTEST = 0.5, 3.0  # smooth: half the longest wave's, and a rate per node that leaves little but the node
_SLOWEST_ALTERNATING = 1e-3
_SAMPLES = 100  # wave numbers fitted, as many near q = 0, on a logarithmic scale, as twice that near Nyquist
_RIDGE = 1e-8  # of the size of columns: keeps weights small where fewer decays would do
_SPACING, _FAINT = 2.0, 1e-3  # of the preconditioner's decays: fewer factor faster, and are close enough here
_CLOSE = 0.06  # relative error up to which a sum of decays is taken for the compliance
_CLOSER = 0.03  # and up to which steps are so few that they pay in denser contacts, too
_LONGER = 16  # times the padded grid of a window: the period whose waves are fitted there
_CUT = 0.2  # over the number of nodes: relative error that the end of the kernel makes, at 256 to 2048 nodes
_COARSENING = 4
_COARSEST = 256  # nodes up to which the first guess is full contact


@dataclass(frozen=True, eq=False)
class DecayModel:
    """Sum of decays close to a compliance on n nodes, as `kernels.decay_contact` takes it.

    `error` is its largest relative error. `compliance` and `stiffness` `[n // 2 + 1]` are zero at q = 0 where they do
    not count there. `coarser` is the model of every fourth node, for the first guess.
    """

    n: int
    compliance: Reals
    stiffness: Reals
    error: float
    powers: Reals
    weights: Reals
    white: float
    mean: float
    preconditioner: ExponentialSum
    coarser: "DecayModel | None"


def decay_model(stiffness: Reals, n: int, free_mean: bool, window: Window | None = None) -> DecayModel | None:
    """Model of a stiffness on the n nodes of a profile, None where decays are far; made once for both.

    In a `window` of a half-space decays are fitted to that itself and have no images: no decay ends as its kernel does.
    """
    if window is not None and window.stiffness(np.zeros(1))[0] > 0.0:  # the kernel of a slab has ended before
        window = None
    return _of_stiffness(stiffness.tobytes(), n, free_mean, window)


@lru_cache(maxsize=32)  # bodies and grids
def _of_stiffness(stiffness: bytes, n: int, free_mean: bool, window: Window | None) -> DecayModel | None:
    return _made(np.frombuffer(stiffness), n, free_mean, window)


def _made(stiffness: Reals, n: int, free_mean: bool, window: Window | None) -> DecayModel | None:
    with np.errstate(divide="ignore"):
        compliance = np.where(stiffness > 0.0, 1.0 / stiffness, 0.0)
    if n < 3 or not (compliance[1:] > 0.0).all():
        return None
    period = n if window is None else _LONGER * n
    decays = _decays(period)
    rates, signs = decays.rates, decays.signs
    if window is None:
        weights, white, error = _fit(compliance[decays.waves], decays)
    else:
        first = 2.0 * np.pi * window.shape[0] / (window.padded[0] * _LONGER)
        weights, white, error = _fit(1.0 / window.stiffness(np.multiply(first, decays.waves)), decays)
        error = max(error, _CUT / n)
    if not error <= _CLOSE:
        return None
    preconditioner = ExponentialSum(compliance, n, _SPACING, _FAINT)
    if not preconditioner.is_safe:
        return None
    coarser = None
    if n > _COARSEST:
        nodes = -(-n // _COARSENING)
        coarser = _made(stiffness[: nodes // 2 + 1], nodes, free_mean, window)
        if coarser is None:
            return None
    mean = 0.0
    if window is not None:
        images = np.zeros(rates.size)
        if not free_mean:
            mean = _offset(compliance, n, rates, signs, weights)
    else:
        images = 1.0 / (1.0 - signs**n * np.exp(-n * rates))
        if not free_mean:  # a constant makes up for what the decays have at q = 0
            mean = float(compliance[0] - (_symbols(np.zeros(1), rates, signs)[0] * weights).sum() - white) / n
    white += float(weights.sum())  # sweeps go from node to node
    return DecayModel(
        n, compliance / n, np.where(np.isfinite(stiffness), stiffness, 0.0) / n, error, _powers(n, period),
        np.stack((weights, images)), white, mean, preconditioner, coarser,
    )  # fmt: skip


class _Decays(NamedTuple):
    """Decays `[decay]` of a period, and the `waves` `[wave]` where they are compared, some of them `fitted`.

    `symbols` are `[wave, decay]`. A body that creeps or wears has another stiffness at each step, but the same decays.
    """

    rates: Reals
    signs: Reals
    waves: Indices
    fitted: npt.NDArray[np.bool_]
    symbols: Reals


@lru_cache(maxsize=32)  # grids
def _decays(n: int) -> _Decays:
    slowest = _SLOWEST * np.pi / n
    rates = np.concatenate(
        (np.geomspace(slowest, _FASTEST, _SMOOTH), np.geomspace(_SLOWEST_ALTERNATING, _FASTEST, _ALTERNATING))
    )
    signs = np.repeat([1.0, -1.0], [_SMOOTH, _ALTERNATING])
    order = np.argsort(rates, kind="stable")
    rates, signs = rates[order], signs[order]
    half = n // 2
    near_zero, near_nyquist = np.geomspace(1, half, 2 * _SAMPLES), half + 1 - np.geomspace(1, half, _SAMPLES)
    sampled = np.unique(np.round(np.concatenate((near_zero, near_nyquist))).astype(np.int64))
    waves = np.unique(np.concatenate((sampled, (sampled[:-1] + sampled[1:]) // 2)))
    return _Decays(rates, signs, waves, np.isin(waves, sampled), _symbols(np.pi * waves / n, rates, signs))


@lru_cache(maxsize=32)
def _powers(n: int, period: int) -> Reals:
    """Decays `[distance, decay]` over all distances below `POWERS`, and over these times each of its powers up to n."""
    rates, signs, *_ = _decays(period)
    digits, top = [], 1
    while top <= n:
        exponents = top * np.arange(POWERS, dtype=np.float64)
        digits.append(np.exp(-np.outer(exponents, rates)) * np.where(np.outer(exponents % 2, signs < 0), -1.0, 1.0))
        top *= POWERS
    return np.concatenate(digits)


def _symbols(phase: Reals, rates: Reals, signs: Reals) -> Reals:
    """Fourier transforms `[phase, decay]` of decays on the nodes, at half the angles given."""
    trigonometric = np.where(signs > 0.0, np.sin(phase)[:, np.newaxis], np.cos(phase)[:, np.newaxis])
    return np.asarray(np.sinh(rates) / (2.0 * (np.sinh(rates / 2.0) ** 2 + trigonometric**2)))


def _offset(compliance: Reals, n: int, rates: Reals, signs: Reals, weights: Reals) -> float:
    """Constant between a kernel and a sum of decays, from distances within a window of n // 2 nodes."""
    kernel = grid.influence(compliance, n)
    distances = np.unique(np.geomspace(1, n // 2 - 1, _SAMPLES).astype(np.int64))[:, np.newaxis]
    decays = np.exp(-distances * rates) * signs**distances
    return float((kernel[distances[:, 0]] - (decays * weights).sum(axis=1)).mean())


def _fit(compliance: Reals, decays: _Decays) -> tuple[Reals, float, float]:
    """Weights of the decays and of the node itself, by least squares of the relative error, and the largest error."""
    symbols, fitted = decays.symbols, decays.fitted
    ratios = np.column_stack((symbols, np.ones(len(symbols)))) / compliance[:, np.newaxis]
    scale = np.sqrt((ratios[fitted] ** 2).sum(axis=0))
    ridge = _RIDGE * np.eye(scale.size)
    matrix = np.concatenate((ratios[fitted] / scale, ridge))
    right = np.concatenate((np.ones(np.count_nonzero(fitted)), np.zeros(scale.size)))
    weights = np.empty(scale.size)
    kernels.least_squares(matrix, right, weights)
    weights /= scale
    error = np.abs((ratios * weights).sum(axis=1) - 1.0).max()
    return weights[:-1], float(weights[-1]), float(error)


_COARSE_ERROR = 0.01  # relative error of a first guess
_EXACT = 0.1  # relative error of the pressure asked for, over the residual
_TIGHTEN = 0.1  # factor on it where the certificate finds a larger residual
_DENSE, _DENSE_OF_MANY_STEPS = 0.25, 0.1  # share of nodes in contact from which on transforms are cheaper than decays
_HEAVY = 0.32  # load over the rms pressure of full contact at which that share is expected, by (4.16)
_SMALL = 2**10  # nodes up to which they are not
_NEXT = 4  # times as many nodes at most as a coarser grid on which twice that share tells as much
_LARGE = 2**17  # nodes beyond which arrays are not kept
_WIDER = 1.0  # nodes open by at most this many times the mean misfit of the contact may join it
_SURE = 0.5  # share of the residual within which an expected error is taken for reached


def decay_newton(batch: Batch, options: Options) -> "DecayNewton | None":
    """Begin without a hardness, where a sum of decays is close to the compliance."""
    if batch.interface.hardness is not None:
        return None
    model = decay_model(batch.response.normal, batch.punch.shape[1], batch.load is not None, batch.response.window)
    return None if model is None else DecayNewton(batch, options, model)


class DecayNewton:
    """Pressure of a batch, found by solving the contact of a sum of decays and correcting it by transforms.

    Each step takes two transforms for the exact gap under the pressure. Then one compiled function solves for contact
    and pressure with a sum of decays in place of the compliance. The error left is the relative error of the sum times
    the change of the pressure, so that each step gains the same number of digits, whatever the contact. The first guess
    is found in the same way on coarser grids. `certificate.py` measures the residual once the expected error is small.
    """

    check_every = 1

    def __init__(self, batch: Batch, options: Options, model: DecayModel) -> None:
        rows, n = batch.punch.shape
        self._model, self._level = model, _Level(model) if model.n > _LARGE else _kept(model, get_ident())
        self.field = self._level.field
        self.wall, self.load = batch.punch, batch.loads
        self._free_mean = batch.load is not None
        self.pressure, self._u, self._restoring = (aligned_rows(rows, n) for _ in range(3))
        self.state = kernels.SurfaceState.of_normal(self._u, self._restoring, self.wall, self.load)
        self.certificate = batch.certificate()
        self._residual = options.residual
        limit = SOLVERS[options.solver].gives_up_after
        self._steps_left = options.max_iterations if limit is None else min(options.max_iterations, limit)
        self._transforms = np.zeros(rows)
        self._expected = np.full(rows, np.inf)
        self._looks = np.zeros(rows, dtype=np.bool_)
        self._target = np.full(rows, _EXACT * options.residual)
        self._rounding = np.finfo(np.float64).eps * np.ptp(batch.punch, axis=1)
        self._most = _DENSE if model.error <= _CLOSER else _DENSE_OF_MANY_STEPS
        start, dense = batch.uniform_pressure, []
        for i in range(rows):
            if self._guess(i, float(start[i])) or (n > _SMALL and np.count_nonzero(self.pressure[i]) > self._most * n):
                dense.append(i)
        self._dense = {i: k for k, i in enumerate(dense)}
        self._by_transforms = ActiveSetNewton(_rows(batch, dense), options) if dense else None

    @property
    def n_transforms(self) -> npt.NDArray[np.int64]:
        """Transforms made so far for each realisation, those of coarser grids in proportion to their cost."""
        transforms = np.ceil(self._transforms).astype(np.int64)
        if self._by_transforms is not None:
            transforms[list(self._dense)] += self._by_transforms.n_transforms
        return transforms

    def advance(self, active: Indices) -> None:
        """Correct the contact and pressure of each active row by one pair of transforms."""
        for i in active:
            if self._by_transforms is not None and i in self._dense:
                self._by_transforms.advance(np.array([self._dense[i]]))
                continue
            self._level.field.transfer(self._model.compliance, self.pressure[i], self._level.displacement)
            self._transforms[i] += 2
            change = self._level.solve(
                self.pressure[i],
                self.wall[i],
                self.load[i],
                self._rounding[i],
                self._free_mean,
                self._target[i] if self._looks[i] else _COARSE_ERROR,
                _WIDER if self._looks[i] or not self._free_mean else 0.0,
            )
            self._expected[i] = self._model.error * change if self._looks[i] else np.inf
            self._looks[i] = True
        self._steps_left -= 1

    def residual(self, active: Indices) -> Reals:
        """Relative violation of the contact conditions, infinite where it is not yet expected to be small enough."""
        residual = np.full(active.size, np.inf)
        sure = (self._expected[active] <= _SURE * self._residual) | (self._steps_left <= 0)
        sure &= [i not in self._dense for i in active]
        if sure.any():
            looked = active[sure]
            residual[sure] = self._violation(looked)
            self._target[looked[residual[sure] > self._residual]] *= _TIGHTEN
        for k, i in enumerate(active):
            if self._by_transforms is not None and i in self._dense:
                residual[k] = self._of_dense(i, self._dense[i], self._by_transforms)
        return residual

    def _of_dense(self, i: int, k: int, solver: ActiveSetNewton) -> float:
        """Residual of a row in dense contact, row k of another solver, with all that it leaves behind."""
        n = self.field.n
        residual = float(solver.residual(np.array([k]))[0])
        for mine, found in zip(self.state[:2], solver.state[:2], strict=True):
            mine[i, :, :n] = found[k, :, :n]
        self.load[i] = solver.load[k]
        self.certificate.found[:, i] = solver.certificate.found[:, k]
        return residual

    def _violation(self, active: Indices) -> Reals:
        n, field = self.field.n, self.field
        for i in active:
            field.transfer(self._model.compliance, self.pressure[i], self._level.displacement)
            kernels.touching_displacement(
                self.pressure[i], self._level.displacement, self.wall[i], n, self._free_mean, self._u[i]
            )
            field.transfer(self._model.stiffness, self._u[i], self._restoring[i])
        self._transforms[active] += 4
        if self.certificate.rigid_mean is not None:  # the mean pressure is the multiplier of a zero mean
            self.load[active] = self.pressure[active, :n].mean(axis=1)
        return self.certificate.look(self.state, active, n)

    def _guess(self, i: int, start: float) -> bool:
        """Begin a row with the pressure of the waves that coarser grids hold, from the coarsest to its own.

        Returns whether a coarser grid has so much contact already that it will be dense.
        """
        level = self._level
        if level.coarser is None:
            self.pressure[i, : self.field.n] = start
            return False
        level.displacement[: self.field.n] = self.wall[i]
        level.field.read(level.displacement)
        if self._free_mean and self.field.n > _SMALL:
            scale = sqrt(2.0 * kernels.power(level.field.waves[0], self._model.stiffness))
            if self.load[i] > _HEAVY * scale:  # for the wall whose spectrum the grid holds
                return True
        levels = [level]
        while levels[-1].coarser is not None:
            levels.append(levels[-1].coarser)
        for other in levels[1:]:
            other.filter(level.field.waves[0], self.field.n)
        level.flatten(level.field.waves[0], self.field.n)
        levels[-1].pressure[: levels[-1].n] = start
        levels[-1].displacement[: levels[-1].n] = 0.0 if self._free_mean else start * levels[-1].at_zero
        # contact that no load holds may vanish altogether while nodes only leave it
        wider = 0.0 if self._free_mean else _WIDER
        cost = 1.0
        price = self.field.n * np.log(self.field.n)
        for other, finer in zip(levels[:0:-1], levels[-2::-1], strict=True):
            if other.coarser is not None:
                other.field.transfer(other.model.compliance, other.pressure, other.displacement)
            cost += (1.0 + 2.0 * (other.coarser is not None)) * other.n * np.log(other.n) / price
            other.solve(
                other.pressure, other.wall, self.load[i], self._rounding[i], self._free_mean, _COARSE_ERROR, wider
            )
            if (
                self.field.n > _SMALL
                and _NEXT * other.n >= self.field.n
                and np.count_nonzero(other.pressure) > 2.0 * self._most * other.n
            ):
                return True
            pressure = self.pressure[i] if finer is level else finer.pressure
            kernels.refined_pressure(
                other.pressure, other.n, self.load[i], self._free_mean, finer.n, finer.fine, pressure
            )
        self._transforms[i] += cost
        return False


def _rows(batch: Batch, some: list[int]) -> Batch:
    """Some rows of a batch alone."""
    rows = np.array(some)
    load = None if batch.load is None else batch.load[rows]
    begun = None if batch.begun is None else batch.begun.rows(rows)
    return replace(batch, punch=batch.punch[rows], load=load, begun=begun)


@lru_cache(maxsize=16)
def _kept(model: DecayModel, thread: int) -> "_Level":
    """Grid of a model, kept for the next batch of a thread."""
    return _Level(model)


class _Level:
    """A grid at work: its transforms and the arrays that one row after the other needs."""

    def __init__(self, model: DecayModel) -> None:
        self.model, self.n = model, model.n
        n = model.n
        self.field = Transform(1, n, sources=0)
        self.displacement, self.wall, self.pressure, self.fine = aligned_rows(4, n)
        self.at_zero = float(model.compliance[0]) * n
        near = np.empty((POWERS + 2 * (n // POWERS + 1), model.weights.shape[1]))
        near[:POWERS] = model.powers[:POWERS]
        level = kernels.DecayLevel(
            kernels.DecaySum(model.powers, near, model.weights, model.white, model.mean),
            model.preconditioner.decays,
            model.preconditioner.room(n),
            kernels.Lists(np.empty(n, dtype=np.bool_), *np.empty((6, n), dtype=np.int64)),
            kernels.Values(*np.empty((9, n))),
        )
        self._level = tuple(map(tuple, level))
        self.coarser = None if model.coarser is None else _Level(model.coarser)

    def filter(self, spectrum: Any, n: int) -> None:
        """Take the waves that this grid holds from the spectrum of a wall on n nodes."""
        field = self.field
        np.multiply(spectrum[: field.half], 1.0 / n, out=field.waves[0, : field.half])
        if self.n % 2 == 0:  # a pair of waves on the finer grid
            field.waves[0, field.half - 1] *= 2.0
        field.write(self.wall)
        self.flatten(spectrum, n)

    def flatten(self, spectrum: Any, n: int) -> None:
        """Pressure that flattens the waves which the next coarser grid does not hold."""
        if self.coarser is None:
            return
        field, known = self.field, self.coarser.field.half
        field.waves[0, :known] = 0.0
        waves = slice(known, field.half)
        np.multiply(spectrum[waves], self.model.stiffness[known:] * (0.5 * self.n / n), out=field.waves[0, waves])
        field.write(self.fine)

    def solve(
        self,
        pressure: Reals,
        wall: Reals,
        load: float,
        rounding: float,
        free_mean: bool,
        target: float,
        wider: float,
    ) -> float:
        """Find the contact and pressure of the sum of decays; the relative change of the pressure."""
        task = kernels.Task(self.n, load, rounding, free_mean, target, self.model.error, wider)
        return float(kernels.decay_contact(pressure, self.displacement, wall, tuple(task), self._level))
