"""Tamaas and ContactMechanics beside the solvers here: same surfaces, same residual by the certificate here, one run.

pip install tamaas ContactMechanics; what is not installed is skipped. The peers take one surface at a time, the batch
here is solved anew beside each of them, and a ratio is that of neighbours in time: median and 10 % quantiles.
"""

import sys
import time

import numpy as np

from gfmd_numba.elasticity import stiffness
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.iteration import HARD_WALL, Batch, Start
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.pressure_iterate import PressureIterate

LOAD, RESIDUAL = 0.007, 1e-8
GRIDS = {8192: 30, 32768: 6, 131072: 2}  # nx and how many surfaces the peers get


def here(solver, punches):
    body = stiffness.half_space(grid.wavenumbers(punches.shape[1]))
    return equilibrate(punches, body, LOAD, Options(solver, residual=RESIDUAL)).pressure


def tamaas():
    import tamaas as tm

    tm.set_log_level(tm.LogLevel.error)

    def solve(punch, tolerance):
        model = tm.ModelFactory.createModel(tm.model_type.basic_1d, [1.0], [punch.size])
        model.E, model.nu = 1.0, 0.0
        solver = tm.PolonskyKeerRey(model, -punch, tolerance)
        solver.max_iter = 1_000_000
        solver.solve(LOAD)
        return np.asarray(model.traction).ravel().copy()

    return solve


def contact_mechanics():
    from ContactMechanics import PeriodicFFTElasticHalfSpace
    from ContactMechanics.Systems import NonSmoothContactSystem
    from SurfaceTopography import UniformLineScan

    def solve(punch, tolerance):
        substrate = PeriodicFFTElasticHalfSpace((punch.size,), 1.0, (1.0,))
        system = NonSmoothContactSystem(substrate=substrate, surface=UniformLineScan(-punch, 1.0, periodic=True))
        found = system.minimize_proxy(
            external_force=LOAD, pentol=tolerance * np.ptp(punch), forcetol=1e-30, maxiter=1_000_000
        )
        return np.abs(found.jac) * punch.size

    return solve


def residual(punch, pressure):
    """By the certificate of this package, from nothing but a pressure."""
    n = punch.size
    body = stiffness.half_space(grid.wavenumbers(n))
    body[0] = 0.0
    state = PressureIterate(
        Batch(punch[np.newaxis], body, np.array([LOAD]), HARD_WALL, Start.at_rest(punch[np.newaxis]))
    )
    compliance = np.concatenate(([0.0], 1.0 / body[1:]))
    pressure = np.maximum(pressure, 0.0)
    gap = punch + grid.signal(compliance * grid.coefficients(pressure), n)
    state.pressure[0, :n] = pressure
    state.gap[0, :n] = gap - gap[pressure > 0.0].mean()
    return float(state.violation(np.arange(1))[0])


def tolerance_for(solve, punch, tolerance):
    """Loosest tolerance, in steps of ten from the one given, that reaches the residual."""
    while residual(punch, solve(punch, tolerance)) > RESIDUAL:
        tolerance /= 10.0
    return tolerance


def seconds(solve, *arguments):
    started = time.perf_counter()
    pressure = solve(*arguments)
    return time.perf_counter() - started, pressure


peers = {}
for name, peer in (("Tamaas", tamaas), ("ContactMechanics", contact_mechanics)):
    try:
        peers[name] = peer()
    except ImportError as missing:
        print(f"{name}: skipped, {missing}")
tolerances = dict.fromkeys(peers, 1e-8)

print(f"half-space, p* = {LOAD}, lambda_l = L_x/2, eps_c^-1 = 2, residual {RESIDUAL:g}, one thread, without start-up")
for nx, surfaces in GRIDS.items():
    if len(sys.argv) > 1 and str(nx) not in sys.argv[1:]:
        continue
    for hurst in (0.8, 0.3):
        heights = self_affine.profiles(hurst, 2, nx // 4, nx, 2018, range(surfaces))
        punches = heights.max(axis=1, keepdims=True) - heights
        pressures = here("active_set_newton", punches)
        for name, solve in peers.items():
            tolerances[name] = tolerance_for(solve, punches[0], tolerances[name])
            ratios, residuals, different = [], [], 0
            for punch, found in zip(punches, pressures, strict=True):
                fast = seconds(here, "active_set_newton", punches)[0] / surfaces
                slow, pressure = seconds(solve, punch, tolerances[name])
                ratios.append(slow / fast)
                residuals.append(residual(punch, pressure))
                different += np.count_nonzero((pressure > 0.0) != (found > 0.0))
            low, middle, high = np.quantile(ratios, [0.1, 0.5, 0.9])
            print(
                f"nx = {nx}, H = {hurst}: {name} takes {middle:.0f} times as long as the active-set Newton method "
                f"({low:.0f} to {high:.0f}; {surfaces} surfaces), residual {np.median(residuals):.0e} (at most "
                f"{max(residuals):.0e}), {different} nodes differ; Newton {1e3 * fast:.1f} ms a surface",
                flush=True,
            )
