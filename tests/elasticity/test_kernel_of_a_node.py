"""What a node is to a half-space without a period: not a square cell of uniform traction, as in other codes.

A node bears waves up to Nyquist. Both kernels are that of a point force far away. Between them, near an edge, is what
two discretisations of one contact differ by. The integrals over a cell are Love's and Cerruti's, in 80 digits.
"""

import mpmath
import numpy as np
import pytest

from gfmd_numba.elasticity import free_body
from gfmd_numba.elasticity.body import ElasticBody
from support.cases import some_of
from support.cells import compliance

N = 64
NU = 0.3
PLACES = ((0, 0), (1, 0), (1, 1), (0, 2), (2, -1), (-3, 3), (-7, -2), (20, 11))
CORNERS = ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))


def of_cell(of_corner, x, y):
    """Integral over a cell of side 1 around (x, y), from the antiderivative of its integrand, in 80 digits."""
    half = mpmath.mpf(1) / 2
    return sum(sign * of_corner(x + a * half, y + b * half) for a, b, sign in CORNERS)


def exact(x, y):
    """Displacements as in `support.cells.compliance`, in 80 digits (Love, 1929; Cerruti's force over a square)."""
    nu, log, root = mpmath.mpf("0.3"), mpmath.log, lambda a, b: mpmath.sqrt(a * a + b * b)
    modulus = (1 - nu) / 2
    inverse = of_cell(lambda a, b: a * log(b + root(a, b)) + b * log(a + root(a, b)), x, y)
    along = of_cell(lambda a, b: b * log(a + root(a, b)), x, y)
    across = of_cell(lambda a, b: a * log(b + root(a, b)), x, y)
    product = of_cell(lambda a, b: -root(a, b), x, y)
    ahead = [
        of_cell(lambda a, b: b * log(root(a, b)) + a * mpmath.atan(b / a), *each) if each[0] else mpmath.mpf(0)
        for each in ((x, y), (y, x))
    ]
    scale, lead = 1 / (2 * mpmath.pi * modulus), (1 - 2 * nu) / (4 * mpmath.pi * modulus)
    return mpmath.matrix(
        [
            [scale * ((1 - nu) * inverse + nu * along), scale * nu * product, -lead * ahead[0]],
            [scale * nu * product, scale * ((1 - nu) * inverse + nu * across), -lead * ahead[1]],
            [lead * ahead[0], lead * ahead[1], scale * (1 - nu) * inverse],
        ]
    )


@pytest.fixture(scope="module")
def of_node():
    """Displacements `[along x, y, into the body; by tractions; y, x]` at nodes from a loaded one, spacing 1."""
    response, found = free_body.response((N, N), ElasticBody(NU, None), couples=True), []
    for i in range(3):
        traction = np.zeros((3, 2 * N, 2 * N))
        traction[i, 0, 0] = 1.0
        found.append(response.apply(traction)[:, :N, :N] * N)
    found = np.array(found).swapaxes(0, 1)
    found[2] *= -1.0  # out of the body, and by tractions that pull
    found[:, 2] *= -1.0
    return found


@pytest.mark.parametrize(("x", "y"), PLACES)
def test_the_cells_of_the_tests_are_those_of_love_and_cerruti_in_80_digits(x, y):
    with mpmath.workdps(80):
        expected = np.array(exact(x, y).tolist(), dtype=float)
    np.testing.assert_allclose(compliance(float(x), float(y), NU), expected, atol=1e-13)


def test_both_give_way_alike_under_themselves_alone():
    """4 arsinh(1) / pi: the transform of 1/r is 1/q, and a square of waves does to 1/q what a cell does to 1/r."""
    with mpmath.workdps(80):
        love = float(exact(0, 0)[2, 2])
        assert love == pytest.approx(float(4 * mpmath.asinh(1) / mpmath.pi), rel=1e-15)
    node = free_body.compliance((N, N))[0]
    assert np.fft.irfft2(node, (2 * N, 2 * N))[0, 0] * N == pytest.approx(love, rel=1e-5)


def of_waves(x, y):
    """Displacement by all waves up to Nyquist along x and y, (1 / 4 pi^2) int 2 / q cos(q r): over |q| it is known."""

    def along(phi):
        way = mpmath.cos(phi) * x + mpmath.sin(phi) * y
        edge = mpmath.pi / max(abs(mpmath.cos(phi)), abs(mpmath.sin(phi)))
        return mpmath.sin(edge * way) / way if abs(way) > mpmath.mpf(10) ** -12 else edge

    return mpmath.quad(along, [mpmath.pi * i / 16 for i in range(17)]) / mpmath.pi**2


@pytest.mark.parametrize(
    ("place", "differs"),
    some_of([((1, 0), 0.06), ((1, 1), 0.02), ((2, 0), 0.08), ((2, 1), 0.03), ((3, 3), 0.01), ((9, 4), 0.01)], 0, 3, 5),
)
def test_their_neighbours_differ_by_a_share_that_falls_with_the_distance(of_node, place, differs):
    with mpmath.workdps(80):
        cell = float(exact(*place)[2, 2])
    with mpmath.workdps(20):
        node = float(of_waves(*place))
    x, y = place
    assert abs(node / cell - 1.0) < differs
    # waves of a window end at Nyquist less sharply
    assert of_node[2, 2, y, x] == pytest.approx(node, abs=1e-4 * cell * np.hypot(x, y))


def test_far_away_both_are_those_of_a_point_force(of_node):
    """Cerruti's and Boussinesq's, along the diagonal, where waves at Nyquist do not go on."""
    with mpmath.workdps(80):
        cell = np.array(exact(24, 24).tolist(), dtype=float)
    node = of_node[:, :, 24, 24]
    r, scale = np.hypot(24.0, 24.0), 1.0 / (np.pi * (1.0 - NU))
    along, product, ahead = (1.0 - 0.5 * NU) / r, 0.5 * NU / r, (0.5 - NU) * 24.0 / r**2
    point = scale * np.array([[along, product, -ahead], [product, along, -ahead], [ahead, ahead, (1.0 - NU) / r]])
    np.testing.assert_allclose(cell, point, atol=1e-4 * scale / r)
    np.testing.assert_allclose(node, point, atol=2e-3 * scale / r)


def test_a_smooth_traction_knows_no_difference():
    """Hertz's pressure: displacements by both converge to one another with order two."""
    errors = []
    for n in (16, 32, 64):
        x = np.arange(n) / n - 0.5
        pressure = np.maximum(1.0 - (x**2 + x[:, np.newaxis] ** 2) / 0.3**2, 0.0) ** 2
        wide = np.zeros((2 * n, 2 * n))
        wide[:n, :n] = pressure
        waves = np.fft.rfft2(wide) * free_body.compliance((n, n))[0]
        by_nodes = np.fft.irfft2(waves, wide.shape)[n // 2, n // 2]
        away = np.arange(n) - n // 2
        kernel = compliance(*np.meshgrid(away.astype(float), away.astype(float)), NU)[2, 2] / n
        errors.append(float((kernel * pressure).sum()) / by_nodes - 1.0)
    orders = np.log2(np.abs(np.array(errors[:-1]) / errors[1:]))
    assert abs(errors[-1]) < 1e-3
    assert orders == pytest.approx([2.0, 2.0], abs=0.3)
