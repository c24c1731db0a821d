"""Contact length and area corrected for their edges, against grids 32 (maps: 8) times as fine, on thin bodies.

Each row is the mean over surfaces and loads: the error of counted nodes, of the half-space's correction and of that of
the body's own symbol, in nodes an edge (maps: a side), and the rms of the last two over the error that the file says.
"""

import numpy as np

from gfmd_numba.contact import evaluation
from gfmd_numba.contact.state import Contact
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.elasticity.stiffness import half_space
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options

SOFT, STIFF, RUBBER = Material(0.02, 0.3), Material(50.0, 0.3), Material(1.0, 0.5)


def pressed(punch, body, load):
    """The contact of a punch, and its area in nodes as counted, corrected as of a half-space and of the body itself."""
    stiffness = body.condensed_stiffness(grid.magnitudes(punch.shape))
    stiffness.flat[0] = 0.0
    found = equilibrate(
        punch[np.newaxis], SpectralResponse.of_normal(stiffness), load, Options("active_set_newton", 1e-8)
    )
    symbols = half_space, body.condensed_stiffness
    made = [Contact(-punch[np.newaxis], punch[np.newaxis], found, stiffness=symbol) for symbol in symbols]
    areas = [evaluation.contact_area_fraction_counted(made[0]), *map(evaluation.contact_area_fraction, made)]
    return made[1], np.array(areas)[:, 0], found.status[0] == Status.ok


def profile(nx, seed, hurst, shortest):
    rng, x = np.random.default_rng(seed), np.arange(nx) / nx
    k = np.arange(2, shortest + 1)
    phases = rng.uniform(0.0, 1.0, k.size)
    heights = sum(q ** -(hurst + 0.5) * np.cos(2 * np.pi * (q * x + phase)) for q, phase in zip(k, phases, strict=True))
    gradient = np.sqrt(0.5 * ((2 * np.pi * k * k ** -(hurst + 0.5)) ** 2).sum())
    return (heights.max() - heights) / gradient


def surface_map(nx, seed, hurst, shortest):
    rng, waves = np.random.default_rng(seed), np.zeros((nx, nx // 2 + 1), dtype=complex)
    k = np.fft.fftfreq(nx, 1 / nx)[:, np.newaxis], np.arange(nx // 2 + 1)
    for ky in range(-shortest, shortest + 1):
        for kx in range(shortest + 1):
            phase, q = rng.uniform(), np.hypot(kx, ky)
            if 2 <= q <= shortest and kx:
                waves[ky, kx] = q ** -(hurst + 1.0) * np.exp(2j * np.pi * phase)
    heights = np.fft.irfft2(waves, (nx, nx)) * nx**2
    square = (2.0 * (2 * np.pi) ** 2 * (k[0] ** 2 + k[1] ** 2) * abs(waves) ** 2).sum()
    return (heights.max() - heights) / np.sqrt(square)


def row(name, make, nx, finer, body, loads, hurst, shortest, seeds):
    found, off = [], []
    for seed in range(seeds):
        coarse, fine = make(nx, seed, hurst, shortest), make(nx * finer, seed, hurst, shortest)
        for load in loads:
            made, areas, ok = pressed(coarse, body, load)
            _, truth, fine_ok = pressed(fine, body, load)
            if not (ok and fine_ok):
                print("   not converged:", name, seed, load)
                continue
            sides = sum(evaluation.perimeter(made))[0] if coarse.ndim == 2 else 2 * evaluation.n_segments(made)[0]
            found.append([*((areas - truth[2]) * coarse.size), sides])
            said = evaluation.contact_area_fraction_error(made)[0] * coarse.size
            if said != 0.0:  # in full contact
                off.append((areas[1:] - truth[2]) * coarse.size / said)
    found, off = np.array(found), np.sqrt(np.mean(np.square(off), axis=0))
    made_of = evaluation.edge(made)
    excess = made_of.excess if coarse.ndim == 1 else made_of.of_sides[0]
    share = found[:, :3].sum(axis=0) / found[:, 3].sum()
    print(
        f"{name:34} {nx:5} {excess:8.4f} {int(found[:, 3].sum()):6}"
        f"{share[0]:9.4f} {share[1]:9.4f} {share[2]:9.4f} {off[0]:8.2f} {off[1]:8.2f}",
        flush=True,
    )


print("body, grid                            nx   excess  edges  counted half-space   own    off/said: half-space, own")
for nu, height, nx, loads, hurst in (
    (0.3, 1e-1, 512, (0.02, 0.05, 0.2), 0.8),
    (0.3, 1e-2, 512, (0.05, 0.2), 0.3),
    (0.3, 3e-3, 512, (0.1, 0.5), 0.8),
    (0.3, 1e-3, 512, (0.5, 2.0), 0.8),
    (0.3, 1e-3, 2048, (0.5, 2.0), 0.8),
    (0.3, 1e-4, 512, (5.0, 20.0), 0.3),
    (0.3, 1e-4, 1000, (5.0, 20.0), 0.8),
    (0.0, 1e-5, 1000, (50.0, 200.0), 0.8),
    (0.45, 1e-3, 1000, (0.5, 2.0), 0.8),
    (0.49, 1e-4, 1000, (5.0, 20.0), 0.8),
    (0.5, 1e-2, 512, (0.05, 0.2), 0.8),
    (0.5, 3e-3, 512, (0.2, 1.0), 0.3),
    (0.5, 1e-3, 1000, (2.0, 10.0), 0.8),
    (0.5, 3e-4, 1000, (100.0, 1000.0), 0.8),
    (0.5, 1e-4, 1000, (1e4, 1e5), 0.8),
):
    row(f"slab, nu {nu:g}, a {height:g}, H {hurst:g}", profile, nx, 32, ElasticBody(nu, height), loads, hurst, 48, 6)
for name, heights, materials, base, loads in (
    ("soft layer 1e-3 on stiff base", (1e-3,), (Material(1.0, 0.3),), STIFF, (0.1, 0.4)),
    ("soft layer 1e-4 on stiff base", (1e-4,), (Material(1.0, 0.3),), STIFF, (0.5, 2.0)),
    ("stiff layer 1e-3 on soft base", (1e-3,), (Material(1.0, 0.3),), SOFT, (0.001, 0.005)),
    ("stiff layer 1e-4 on soft base", (1e-4,), (Material(1.0, 0.3),), SOFT, (0.001, 0.005)),
    ("rubber 1e-3 on stiff base", (1e-3,), (RUBBER,), STIFF, (0.5, 2.0)),
    ("soft, stiff, soft: 3e-4, 1e-3, 0.1", (3e-4, 1e-3, 0.1), (Material(1.0, 0.3), STIFF, SOFT), None, (0.1, 0.4)),
):
    row(name, profile, 1000, 32, ElasticBody.layered(heights, materials, base), loads, 0.8, 48, 6)
for nu, height, loads in (
    (0.3, 1e-1, (0.02, 0.1)),
    (0.3, 1e-2, (0.05, 0.2)),
    (0.3, 3e-3, (0.1, 0.5)),
    (0.3, 1e-3, (0.5, 2.0)),
    (0.3, 1e-4, (5.0, 20.0)),
    (0.5, 1e-2, (0.05, 0.2)),
    (0.5, 3e-3, (0.5, 2.0)),
    (0.5, 1e-3, (10.0, 50.0)),
):
    row(f"map, slab, nu {nu:g}, a {height:g}", surface_map, 96, 8, ElasticBody(nu, height), loads, 0.8, 12, 3)
soft = ElasticBody.layered((1e-3,), (Material(1.0, 0.3),), STIFF)
row("map, soft layer 1e-3 on stiff base", surface_map, 96, 8, soft, (0.1, 0.4), 0.8, 12, 3)
