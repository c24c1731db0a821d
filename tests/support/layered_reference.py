"""An independent reference for a stack of layers: Airy's stress function in each, one linear system, many digits."""

from dataclasses import dataclass

from mpmath import mp, mpf


@dataclass(frozen=True)
class Wave:
    """Amplitudes on a plane: u_1 = u1 cos, u_3 = u3 sin, sigma_13 = t1 cos, sigma_33 = t3 sin, sigma_11 = s1 sin."""

    u1: mpf
    u3: mpf
    t1: mpf
    t3: mpf
    s1: mpf


def surface_and_inside(layers, base, q, load, depths=(), digits=60):
    """The waves at the surface and at some depths under tractions `load` = (t1, t3) on the surface.

    `layers` are (height, Young's modulus, Poisson's ratio) from the surface downwards, `base` None or the latter two.
    At an interface the wave is that above it.
    In each layer phi = f(z) sin(qx) with f = (a + b y) exp(-y) + (c + d v) exp(-v), where y and v are q times the
    distances from its top and its bottom: sigma_33 = -q^2 f sin, sigma_13 = -q f' cos, sigma_11 = f'' sin.
    """
    with mp.workdps(digits):
        q = mpf(q)
        parts = [(mpf(h), mpf(e), mpf(nu)) for h, e, nu in layers]
        parts += [] if base is None else [(None, mpf(base[0]), mpf(base[1]))]
        size = 4 * len(layers) + (0 if base is None else 2)
        matrix, right = mp.matrix(size, size), mp.matrix(size, 1)
        row = 0
        for i, value in enumerate(load):
            for column, each in enumerate(_basis(parts[0], q, mpf(0))):
                matrix[row, column] = each[2 + i]
            right[row] = mpf(value)
            row += 1
        for i, part in enumerate(parts):
            if part[0] is None:
                continue
            above = _basis(part, q, part[0])
            below = _basis(parts[i + 1], q, mpf(0)) if i + 1 < len(parts) else []
            for quantity in range(4 if below else 2):
                for column, each in enumerate(above):
                    matrix[row, 4 * i + column] = each[quantity]
                for column, each in enumerate(below):
                    matrix[row, 4 * i + 4 + column] = -each[quantity]
                row += 1
        # columns and rows of comparable size
        scale = [max(abs(matrix[r, c]) for r in range(size)) for c in range(size)]
        for c in range(size):
            for r in range(size):
                matrix[r, c] /= scale[c]
        for r in range(size):
            largest = max(abs(matrix[r, c]) for c in range(size))
            right[r] /= largest
            for c in range(size):
                matrix[r, c] /= largest
        found = mp.lu_solve(matrix, right)
        amplitudes = [found[c] / scale[c] for c in range(size)]
        waves = []
        for depth in (0, *depths):
            left, i = mpf(depth), 0
            while parts[i][0] is not None and left > parts[i][0] * (1 + mpf(10) ** -9) and i + 1 < len(parts):
                left, i = left - parts[i][0], i + 1
            basis = _basis(parts[i], q, left)
            waves.append(
                Wave(*(sum(amplitudes[4 * i + c] * each[k] for c, each in enumerate(basis)) for k in range(5)))
            )
        return waves


def compliance(layers, base, q, digits=60):
    """Elements S11, S13 and S33 of the compliance of both amplitudes, times q."""
    along = surface_and_inside(layers, base, q, (1, 0), digits=digits)[0]
    normal = surface_and_inside(layers, base, q, (0, 1), digits=digits)[0]
    with mp.workdps(digits):
        return q * along.u1, q * along.u3, q * normal.u3


def _basis(part, q, depth):
    """u1, u3, t1, t3 and s1 of each of the four (or two) stress functions, at a depth below the top of a layer."""
    height, modulus, nu = part
    y = q * depth
    # value and derivatives along y of (1, y) exp(-y); those along z, which points upwards, are -q times those
    decay = mp.exp(-y)
    functions = [
        [decay, q * decay, q**2 * decay, q**3 * decay],
        [y * decay, -q * (1 - y) * decay, q**2 * (y - 2) * decay, -(q**3) * (3 - y) * decay],
    ]
    if height is not None:
        v = q * (height - depth)
        decay = mp.exp(-v)  # d/dz = q d/dv
        functions += [
            [decay, -q * decay, q**2 * decay, -(q**3) * decay],
            [v * decay, q * (1 - v) * decay, q**2 * (v - 2) * decay, q**3 * (3 - v) * decay],
        ]
    amplitudes = []
    for f, f1, f2, f3 in functions:
        t1, t3 = -q * f1, -(q**2) * f
        u1 = -((1 - nu**2) * f2 + nu * (1 + nu) * q**2 * f) / (modulus * q)
        slope = -((1 - nu**2) * f3 + nu * (1 + nu) * q**2 * f1) / (modulus * q)
        amplitudes.append((u1, (2 * (1 + nu) / modulus * t1 - slope) / q, t1, t3, f2))
    return amplitudes
