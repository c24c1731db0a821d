"""Displacement inside a slab under one wave of normal displacement (thesis Fig. 2.2): python ... PICTURE.png"""

import sys
from types import SimpleNamespace

import numpy as np
from matplotlib.figure import Figure

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.fields import Inside, displaced_surface
from gfmd_numba.fourier import grid

ASPECT_RATIO, POISSONS_RATIO, AMPLITUDE, NX = 0.25, 0.33, 5e-5, 400  # z_m / L_x, -, u_3 / L_x, -

x, z = np.arange(NX) / NX, np.linspace(-ASPECT_RATIO, 0, 201)
body = ElasticBody(POISSONS_RATIO, ASPECT_RATIO)
given = displaced_surface(np.stack((np.zeros(NX), AMPLITUDE * np.sin(2 * np.pi * x))), body)
names = "u1", "u3", "stress1", "stress3", "stress5"
found = SimpleNamespace(**dict(zip(names, Inside((given,), body).section(z, names), strict=True)))


def along_x(field):
    return grid.signal(grid.derivative(grid.coefficients(field)), NX)


def along_z(field):
    return np.gradient(field, z, axis=0, edge_order=2)


forces = along_x(found.stress1) + along_z(found.stress5), along_x(found.stress5) + along_z(found.stress3)
scale = abs(along_z(found.stress3)).max()
print(f"u_1 / L_x within {abs(found.u1).max():.2e}, u_3 / L_x within {abs(found.u3).max():.2e}")
print("unbalanced force over the largest term, second-order differences along z: ", end="")
print(" and ".join(f"{abs(force[1:-1]).max() / scale:.1e}" for force in forces))

figure = Figure(figsize=(9, 4.6), layout="constrained")
for axis, field, name in zip(figure.subplots(2, 1, sharex=True), (found.u1, found.u3), ("u_1", "u_3"), strict=True):
    limit = abs(field).max()
    drawn = axis.contourf(x, z + ASPECT_RATIO, field, np.linspace(-limit, limit, 21), cmap="RdBu_r")
    axis.set(ylabel="$z/L_x$", aspect="equal")
    figure.colorbar(drawn, ax=axis, label=f"${name}/L_x$", format="%.1e", ticks=[-limit, 0, limit])
axis.set_xlabel("$x/L_x$")
figure.suptitle(f"One wave of normal displacement on a slab of aspect ratio {ASPECT_RATIO:g}, ν = {POISSONS_RATIO:g}")
figure.savefig(sys.argv[1], dpi=120)
