"""Contacts on which a loop of plain NumPy stops too early, diverges, or counts nodes of a wrong grid."""

import time

import numpy as np

from gfmd_numba.contact.area_correction import HALF_SPACE
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options
from gfmd_numba.theory import closed_forms
from hard.rows import row


def verlet(heights, load, steps, dt, damping, tolerance=0.0, dtype=np.float64):
    """Displacement and restoring traction after some steps, or once no free node feels more than a traction."""
    n = len(heights)
    k = (0.5 * grid.wavenumbers(n)).astype(dtype)
    softest, dt = k[1], dt / np.sqrt(k[-1])
    eta = damping * (2 * np.sqrt(softest) / dt - softest)
    wall = (heights.max() - heights).astype(dtype)
    u = last = np.zeros(n, dtype)
    memory, push, load = dtype(1 - eta * dt * dt), dtype(dt * dt), dtype(load)
    for _ in range(steps):
        restoring = np.fft.irfft(k * np.fft.rfft(u), n)
        if np.abs(np.where(u < wall, load - restoring, 0)).max() <= tolerance:
            break
        u, last = np.minimum(u + memory * (u - last) + push * (load - restoring), wall), u
        if not np.isfinite(u).all() or np.abs(u).max() > 1e6:
            return None, None
    return u, np.fft.irfft(k * np.fft.rfft(u), n)


def certified(heights, load, solver="verlet", **numerics):
    heights = np.atleast_2d(heights)
    body = stiffness.half_space(grid.wavenumbers(heights.shape[1]))
    begun = time.perf_counter()
    punch = heights.max(axis=1, keepdims=True) - heights
    return equilibrate(
        punch, SpectralResponse.of_normal(body), load, Options(solver, **numerics)
    ), time.perf_counter() - begun


def stepping():
    heights, load, nx = self_affine.SelfAffineWaves(0.8, 2, 2048).heights((8192,), 1, range(1))[0], 0.007, 8192
    best, _ = certified(heights, load, "conjugate_gradients", residual=1e-12)
    count = best.touching.sum()
    ours, seconds = certified(heights, load)
    off = abs(ours.touching.sum() - count) / count
    cost = f"{ours.n_iterations[0]} steps, {seconds:.2g} s"
    for steps in (100, 300):
        u, restoring = verlet(heights, load, steps, 1.9, 0.5)
        found = ((u >= heights.max() - heights) & (load > restoring)).sum()
        row(
            f"{steps} steps decided beforehand, nx = {nx}",
            f"area off by {found / count - 1:+.0%}",
            "stops at a residual",
            f"area {off:.0%}",
            cost,
        )
    for damping in (3.0, 100.0):
        u, _ = verlet(heights, load, 300, 1.98, damping)
        ours, seconds = certified(heights, load, time_step=0.99, damping=damping, max_iterations=20_000)
        state = Status(ours.status[0]).name
        row(
            f"damping of {damping:g} η_cr, Δt at 0.99 of K Δt² = 4",
            "diverges" if u is None else "stable",
            f"{state}: the limit counts η too",
            "left out of fits" if ours.status[0] else "area 0%",
            f"{ours.n_iterations[0]} steps, {seconds:.2g} s",
        )


def single_precision():
    for nx in (4096, 65536):
        heights, load = self_affine.SelfAffineWaves(0.8, 2, nx // 4).heights((nx,), 1, range(1))[0], 0.007
        best, seconds = certified(heights, load)
        u, restoring = verlet(heights, load, int(best.n_iterations[0]), 1.9, 0.5, dtype=np.float32)
        touching = (u >= (heights.max() - heights).astype(np.float32)) & (restoring < load)
        worst = abs(np.where(touching, 0, load - restoring)).max() / (load - restoring).max()
        wrong = (touching != best.touching[0]).sum() / best.touching.sum()
        row(
            f"single precision, nx = {nx}",
            f"residual stays at {worst:.0e}; {wrong:.1%} of the nodes wrong",
            f"double: {best.residual[0]:.0e}",
            "0 nodes",
            f"{seconds:.2g} s",
        )


def units():
    x = np.arange(256) / 256
    amplitude, load, modulus = 1e-4, 5e-5, 1e-3
    heights = amplitude * np.cos(2 * np.pi * x)
    truth = 2 * closed_forms.westergaard_half_width(load, amplitude)
    u, restoring = verlet(heights, load, 100_000, 1.9, 0.5, tolerance=1e-8 / modulus)
    naive = ((u >= heights.max() - heights) & (restoring < load)).mean()
    ours, seconds = certified(heights, load)
    edges = ours.touching.mean() - 2 * HALF_SPACE.excess / 256
    row(
        "E = 1 mPa, stop at a force of 1e-8 Pa",
        f"contact length {naive / truth - 1:+.0%}",
        "stops at a share of the pressure",
        f"{edges / truth - 1:+.1%}",
        f"{seconds:.2g} s",
    )


def edges():
    """Contact lengths over those of Westergaard, at loads that move the edges across the grid."""
    loads, amplitude, nx = np.linspace(0.03, 0.09, 31) * np.pi * 0.01, 0.01, 64
    heights = amplitude * np.cos(2 * np.pi * np.arange(nx) / nx)
    truth = np.array([2 * closed_forms.westergaard_half_width(load, amplitude) for load in loads])
    begun = time.perf_counter()
    counted = np.array([certified(heights, load)[0].touching.mean() for load in loads])
    cost = (time.perf_counter() - begun) / len(loads)
    naive, ours = counted / truth - 1, (counted - 2 * HALF_SPACE.excess / nx) / truth - 1
    nodes = f"{counted.min() * nx:.0f} to {counted.max() * nx:.0f}"
    said = f"mean {ours.mean():+.1%}, scatter {ours.std():.0%}"
    row(
        f"contacts of {nodes} nodes",
        f"counted length: mean {naive.mean():+.1%}, scatter {naive.std():.0%}",
        "length less 0.19 spacings an edge",
        said,
        f"{cost:.1g} s",
    )


def large():
    for nx in (2**20, 3**12):
        heights = self_affine.SelfAffineWaves(0.8, 2, nx // 64).heights((nx,), 1, range(1))
        ours, seconds = certified(heights, 0.05, "active_set_newton")
        said = f"{Status(ours.status[0]).name} after {ours.n_transforms[0]} transforms"
        row(f"nx = {nx}", "-", said, f"residual {ours.residual[0]:.0e}", f"{seconds:.2g} s")
