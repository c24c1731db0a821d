"""Displacements of a half-space by square cells of uniform traction (Love, Cerruti), and contacts by them alone.

Of E* = 1 and G = (1 - nu) / 2, in nodes of spacing 1. No transform, no band limit and no solver of the package.
"""

import numpy as np

CORNERS = ((0.5, 0.5, 1.0), (0.5, -0.5, -1.0), (-0.5, 0.5, -1.0), (-0.5, -0.5, 1.0))
# antiderivatives over x and y of 1/r, x^2/r^3, x y/r^3 and x/r^2 (Johnson, Contact Mechanics, 3.19 to 3.26)


def over_cell(of_corner, x, y):
    """Integral over a cell around a place of what the function of corners is the antiderivative of."""
    return sum(sign * of_corner(x + across, y + along) for across, along, sign in CORNERS)


def of_distance(x, y):
    r = np.hypot(x, y)
    return x * np.log(y + r) + y * np.log(x + r)


def of_square(x, y):
    return y * np.log(x + np.hypot(x, y))


def of_product(x, y):
    return -np.hypot(x, y)


def of_gradient(x, y):
    return y * np.log(np.hypot(x, y)) + x * np.arctan2(y, x) - np.pi * x * (x < 0.0) * np.sign(y)


def compliance(x, y, nu):
    """Displacements `[x, y, into the body; by tractions along x, y, into the body]` at places off a cell."""
    modulus = 0.5 * (1.0 - nu)
    inverse = over_cell(of_distance, x, y)
    lead = (1.0 - 2.0 * nu) / (4.0 * np.pi * modulus)
    into = [lead * over_cell(of_gradient, *each) for each in ((x, y), (y, x))]
    square = [over_cell(of_square, *each) for each in ((x, y), (y, x))]
    product = nu * over_cell(of_product, x, y)
    scale = 1.0 / (2.0 * np.pi * modulus)
    return np.array(
        [
            [scale * ((1.0 - nu) * inverse + nu * square[0]), scale * product, -into[0]],
            [scale * product, scale * ((1.0 - nu) * inverse + nu * square[1]), -into[1]],
            [into[0], into[1], scale * (1.0 - nu) * inverse],
        ]
    )


def rubbed(gap, nu, friction, ways):
    """Tractions `[step, component, node]` on a body that a punch of a gap `[y, x]` has pressed, then dragged along x.

    `ways` are how far it has come, step by step; the first is 0. By projected gradients.
    """
    places = np.stack(np.unravel_index(np.arange(gap.size), gap.shape))
    dy, dx = places[:, :, np.newaxis] - places[:, np.newaxis]
    matrix = np.moveaxis(compliance(dx, dy, nu), 1, 2).reshape(3 * gap.size, 3 * gap.size)
    rate, found, before, done = 1.0 / np.linalg.eigvalsh(matrix)[-1], np.zeros((3, gap.size)), 0.0, []
    for step, way in enumerate(ways):
        moved = np.zeros((2, gap.size))
        moved[0] = way - (ways[step - 1] if step else 0.0)
        for _ in range(20_000):
            displaced = (matrix @ found.ravel()).reshape(found.shape)
            pressure = np.maximum(found[2] - rate * (gap.ravel() + displaced[2]), 0.0)
            wanted = found[:2] + rate * (moved - (displaced[:2] - before))
            size = np.hypot(*wanted)
            wanted *= np.minimum(1.0, friction * pressure / np.where(size > 0.0, size, 1.0))
            last, found = found, np.concatenate((wanted, pressure[np.newaxis]))
            if abs(found - last).max() < 1e-9 * found.max():
                break
        before = (matrix @ found.ravel()).reshape(found.shape)[:2]
        done.append(found)
    return np.array(done)
