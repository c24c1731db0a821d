"""Error against Westergaard, Hertz and full contact, and the order at which it falls."""

import numpy as np
import textbook

from gfmd_numba.contact.area_correction import HALF_SPACE
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.table import Options
from gfmd_numba.theory import closed_forms

NUMERICS = Options("verlet", residual=1e-10)
AMPLITUDE, RADIUS = 0.01, 1.0


def press(heights, load):
    heights = np.atleast_2d(heights)
    punch = heights.max(axis=1, keepdims=True) - heights
    result = equilibrate(
        punch, SpectralResponse.of_normal(stiffness.half_space(grid.wavenumbers(heights.shape[1]))), load, NUMERICS
    )
    assert (result.status == 0).all()
    return result.pressure


def errors(nx, height, pressure, half_width, loads):
    """Medians over loads of the pressure error over its peak, and the extremes of the error in contact length."""
    x = np.arange(nx) / nx - 0.5
    rows = []
    for load in loads:
        computed, exact, edge = press(height(x), load)[0], pressure(x, load), half_width(load)
        error = abs(computed - exact) / exact.max()
        away = abs(abs(x) - edge) > 4 / nx
        length = np.count_nonzero(computed) - 2 * edge * nx
        rows.append((np.sqrt((error**2).mean()), error[away].max(), error.max(), error[nx // 2], length))
    *pressures, length = np.transpose(rows)
    return [np.median(e) for e in pressures], length


def table(title, sizes, *case):
    print(f"\n{title}: error of the pressure over its peak (medians), of the contact length in dx")
    print("     nx       rms  >4dx from edge    largest     centre   counted: mean, largest   corrected: mean, largest")
    first = last = None
    for nx in sizes:
        pressures, length = errors(nx, *case)
        corrected = length - 2 * HALF_SPACE.excess
        print(
            f"{nx:7}  {pressures[0]:8.1e}  {pressures[1]:14.1e}  {pressures[2]:9.1e}  {pressures[3]:9.1e}"
            f"   {length.mean():12.2f}  {abs(length).max():8.2f}  {corrected.mean():14.2f}  {abs(corrected).max():8.2f}"
        )
        first, last = first or (nx, pressures), (nx, pressures)
    orders = np.log(np.divide(first[1], last[1])) / np.log(last[0] / first[0])
    print("  order  {:8.2f}  {:14.2f}  {:9.2f}  {:9.2f}".format(*orders))


table(
    "Westergaard's wave, 5 to 60 % of full contact",
    2 ** np.arange(6, 14),
    lambda x: AMPLITUDE * np.cos(2 * np.pi * x),
    lambda x, p: closed_forms.westergaard_pressure(x, p, AMPLITUDE),
    lambda p: closed_forms.westergaard_half_width(p, AMPLITUDE),
    np.linspace(0.05, 0.6, 23) * np.pi * AMPLITUDE,
)
table(
    "Hertz line contact, half width 0.015 to 0.025 L_x",
    2 ** np.arange(9, 15),
    lambda x: -(x**2) / (2 * RADIUS),
    lambda x, p: textbook.hertz_line_pressure(x, p, RADIUS),
    lambda p: textbook.hertz_line_half_width(p, RADIUS),
    np.pi * np.linspace(0.015, 0.025, 23) ** 2 / (4 * RADIUS),
)
print("\nFull contact, self-affine: largest error of the pressure over its rms fluctuation")
for nx in (256, 1024, 4096):
    heights = self_affine.SelfAffineWaves(0.8, 2, nx // 8).heights((nx,), 1, range(5))
    linear = grid.signal(stiffness.half_space(grid.wavenumbers(nx)) * grid.coefficients(heights), nx)
    computed = press(heights, 5.0)
    print(f"{nx:7}  {abs(computed - 5.0 - linear).max() / linear.std():8.1e}")
