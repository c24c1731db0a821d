"""Displacement inside a slab under one wave of normal displacement (thesis Fig. 2.2): python ... PICTURE.png"""

import sys

import numpy as np
from matplotlib.figure import Figure

ASPECT_RATIO, POISSONS_RATIO, AMPLITUDE = 0.25, 0.33, 5e-5  # z_m / L_x, -, u_3 / L_x
S = (1 - 2 * POISSONS_RATIO) / (2 * (1 - POISSONS_RATIO))  # C44 / C11
R = (1 - S) / (1 + S)


def transfer(qz):
    """Matrix of (2.4) at a height z, with (2.5)."""
    f1 = np.sinh(qz) + R * qz * np.cosh(qz)
    f2 = R * qz * np.sinh(qz)
    f3 = np.sinh(qz) - R * qz * np.cosh(qz)
    return np.array([[f1, -f2], [f2, f3]])


q = 2 * np.pi
x, z = np.linspace(0, 1, 401), np.linspace(0, ASPECT_RATIO, 201)
coefficients = np.linalg.solve(transfer(q * ASPECT_RATIO), [0.0, AMPLITUDE])
tangential, normal = np.tensordot(transfer(q * z), coefficients, axes=(1, 0)).reshape(2, -1)
u1, u3 = np.outer(tangential, np.cos(q * x)), np.outer(normal, np.sin(q * x))

# equilibrium (2.2) by finite differences, in C11 = 1, C44 = S, C12 = 1 - 2 S
dz, dx = z[1] - z[0], x[1] - x[0]


def gradient(field, axis):
    return np.gradient(field, (dz, dx)[axis], axis=axis, edge_order=2)


inner = (slice(3, -3), slice(3, -3))
force1 = gradient(gradient(u1, 1), 1) + S * gradient(gradient(u1, 0), 0) + (1 - S) * gradient(gradient(u3, 0), 1)
force3 = gradient(gradient(u3, 0), 0) + S * gradient(gradient(u3, 1), 1) + (1 - S) * gradient(gradient(u1, 1), 0)
scale = abs(gradient(gradient(u3, 0), 0)[inner]).max()
print(f"u_1 / L_x within {abs(u1).max():.2e}, u_3 / L_x within {abs(u3).max():.2e}")
print(f"unbalanced force over the largest term, finite differences: {abs(force1[inner]).max() / scale:.1e}", end=" ")
print(f"and {abs(force3[inner]).max() / scale:.1e}")

figure = Figure(figsize=(9, 4.6), layout="constrained")
for axis, field, name in zip(figure.subplots(2, 1, sharex=True), (u1, u3), ("u_1", "u_3"), strict=True):
    limit = abs(field).max()
    drawn = axis.contourf(x, z, field, np.linspace(-limit, limit, 21), cmap="RdBu_r")
    axis.set(ylabel="$z/L_x$", aspect="equal")
    figure.colorbar(drawn, ax=axis, label=f"${name}/L_x$", format="%.1e", ticks=[-limit, 0, limit])
axis.set_xlabel("$x/L_x$")
figure.suptitle(f"One wave of normal displacement on a slab of aspect ratio {ASPECT_RATIO:g}, ν = {POISSONS_RATIO:g}")
figure.savefig(sys.argv[1], dpi=120)
