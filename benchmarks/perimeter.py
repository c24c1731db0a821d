"""Nodes counted too many per side of a node on the edge of Hertzian contacts on a map, against the closed form.

Circles and ellipses (Johnson, Contact Mechanics, 4.26) of random size and position, the periodic images taken as a
paraboloid. The contacts are along y or turned by random angles, where edges of all directions are as frequent.
"""

import numpy as np
from scipy.special import ellipe, ellipk

from gfmd_numba.contact.area_correction import HALF_SPACE
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options

IMAGES = 9.0336217  # sum of 1/r^3 over the square lattice without the origin
NUMERICS = Options("active_set_newton", residual=1e-8)


def contact(n, body, half_width, longer, angle, rng):
    """Counted nodes, area in nodes, and sides facing x and y of one contact."""
    b, a, m = half_width / n, longer * half_width / n, 1.0 - longer**-2
    along_a = b / (m * a**2) * (ellipk(m) - ellipe(m))
    along_b = b / (m * a**2) * (longer**2 * ellipe(m) - ellipk(m))
    load = 2.0 / 3.0 * np.pi * a * b  # of a largest pressure of 1
    lifted = load * IMAGES / (4.0 * np.pi)
    y0, x0 = rng.uniform(0.0, 1.0, 2) / n
    x = np.arange(n) / n - 0.5
    x, y = (x + x0)[np.newaxis], (x + y0)[:, np.newaxis]
    along, across = y * np.cos(angle) + x * np.sin(angle), x * np.cos(angle) - y * np.sin(angle)
    punch = (along_a + lifted) * along**2 + (along_b + lifted) * across**2
    found = equilibrate(punch[np.newaxis], SpectralResponse.of_normal(body), load, NUMERICS)
    assert found.status[0] == Status.ok
    now = found.touching[0]
    sides = [np.count_nonzero(now != np.roll(now, 1, axis=axis)) for axis in (1, 0)]
    return now.sum(), np.pi * a * b * n**2, *sides


print("  grid  half width   longer  turned     excess a side (error)   closed form")
for n, smallest, longer, turned, count in (
    (128, 3.0, 1.0001, False, 300),
    (384, 10.0, 1.0001, False, 1500),
    (384, 6.0, 2.0, True, 400),
    (384, 4.0, 4.0, True, 400),
    (384, 6.0, 2.0, False, 300),
    (384, 4.0, 4.0, False, 300),
):
    rng = np.random.default_rng(1)
    body = stiffness.half_space(grid.magnitudes((n, n)))
    widths, angles = rng.uniform(smallest, 2.0 * smallest, count), rng.uniform(0.0, np.pi, count) * turned
    rows = [contact(n, body, width, longer, angle, rng) for width, angle in zip(widths, angles, strict=True)]
    counted, area, facing_x, facing_y = np.array(rows).T
    excess = (counted - area) / (facing_x + facing_y)
    expected = HALF_SPACE.perimeter_bias(facing_x.sum(keepdims=True), facing_y.sum(keepdims=True))[0]
    print(
        f"{n:6} {smallest:4g} to {2 * smallest:2g} {longer:8.2g} {turned!s:>7} {excess.mean():15.4f} "
        f"({excess.std(ddof=1) / np.sqrt(count):.4f}) {expected:12.4f}",
        flush=True,
    )
