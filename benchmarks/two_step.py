"""Two-step GFMD against finite elements: the tables of TWO-STEP.md, and pictures of fields: python ... FOLDER"""

import sys
from pathlib import Path

import numpy as np
from chapter5 import (
    COARSE,
    FINE,
    NX,
    X,
    at_points,
    block,
    finite_elements,
    flat_punch,
    on_axis,
    rectangle,
    rough,
    sinusoid,
    superposed,
    triangle,
    two_step,
)
from inner_fields import inside
from matplotlib.figure import Figure

from gfmd_numba.elasticity import fields, topography
from gfmd_numba.elasticity.body import ElasticBody

ORDERS = (0, 1, 2)
PARTS = ("u1", "u3", "stress1", "stress3", "stress5")
THICKNESSES = (0.5, 0.2, 0.1)


def levels_of(mesh, solution):
    return np.unique(np.round(mesh.inside(solution)[1], 12))


def stress_errors(case, mesh, solution, stresses, levels):
    """Largest and rms difference of any in-plane stress, of the finite elements' from `stresses` `[3][levels, NX]`."""
    x, z, _, _, *found = mesh.inside(solution)
    row, column = np.searchsorted(levels, np.round(z, 12)), np.rint(x * NX).astype(int) % NX
    differences = np.array([a - b[row, column] for a, b in zip(found, stresses, strict=True)])
    return abs(differences).max(), np.sqrt((differences**2).mean())


def row(case, meshes):
    """Print one case: the meshes against each other, then every order against the finer one."""
    coarse, (mesh, solution, fine) = meshes
    over, step = NX // len(fine.u1), len(fine.u1) // len(coarse[2].u1)
    own1, own3 = abs(coarse[2].u1 - fine.u1[::step]).max(), abs(coarse[2].u3 - fine.u3[::step]).max()
    print(f"\n{case.name}: rms gradient {case.gradient:.4f}, |u_1| <= {abs(fine.u1).max():.2e}, ", end="")
    print(f"p <= {fine.pressure.max():.3e}; coarse mesh against fine: u_1 {own1:.1e}, u_3 {own3:.1e}")
    levels, touching = levels_of(mesh, solution), fine.pressure > 0.0
    for order in ORDERS:
        found, pressed, surface = two_step(case, order)
        here = inside(surface, levels, case.elastic)
        worst, rms = stress_errors(case, mesh, solution, (here.stress1, here.stress3, here.stress5), levels)
        d1, d3 = abs(found.u1[::over] - fine.u1), abs(found.u3[::over] - fine.u3)
        maxima = abs(abs(found.u1).max() - abs(fine.u1).max())
        peak = abs(found.pressure.max() - fine.pressure.max())
        z, axis = on_axis(mesh, solution)
        middle = abs(inside(surface, z, case.elastic).stress3[:, NX // 2] - axis)
        print(
            f"  order {order}: u_1 {d1.max():.1e} (maxima {maxima:.1e}, mean {d1.mean():.1e}, "
            f"in contact {d1[touching].mean():.1e}), u_3 {d3.max():.1e}, "
            f"largest p {peak:.1e}, stress {worst:.1e} (rms {rms:.1e}), sigma_33(1/2) mean {middle.mean():.1e} "
            f"max {middle.max():.1e}; expected {pressed.next_order:.1e}"
        )


def compare(case):
    touching = two_step(case, 2)[0].pressure > 0.0
    meshes = [finite_elements(case, columns, touching) for columns in (COARSE, FINE)]
    row(case, meshes)
    return meshes


def superpositions(case, meshes):
    """Print what each way to superpose strains leaves of the stress error, and what the orders leave."""
    mesh, solution, _ = meshes[1]
    levels = levels_of(mesh, solution)
    ways = superposed(case, two_step(case, 0)[2], levels)
    for order in ORDERS:
        here = inside(two_step(case, order)[2], levels, case.elastic)
        ways[f"order {order}"] = here.stress1, here.stress3, here.stress5
    print(f"\n{case.name}: error of the stresses 1, 3, 5 at the finite elements' points, in 1e-3 E*")
    for name, stresses in ways.items():
        for deepest, where in ((0.0, "all"), (0.02, "below 0.02")):
            kept = levels <= -deepest + 1e-12
            x, z, _, _, *found = mesh.inside(solution)
            inner = np.round(z, 12) <= levels[kept].max()
            r, c = np.searchsorted(levels, np.round(z[inner], 12)), np.rint(x[inner] * NX).astype(int) % NX
            d = np.array([abs(a[inner] - b[r, c]) for a, b in zip(found, stresses, strict=True)]) * 1e3
            print(f"  {name:34} {where:10} max {d.max():8.4f}  mean {d.mean():8.5f}")


def punches():
    """Tab. 5.1, its two rows of the flat punch: they are of one linear problem."""
    for displacement in (0.001, 0.01):
        flat, meshes = flat_punch(displacement)
        for name, (mesh, solution) in zip(("coarse", "fine"), meshes, strict=True):
            z, axis = on_axis(mesh, solution)
            d = abs(inside(flat, z, ElasticBody(0.33, 1.0)).stress3[:, NX // 2] - axis) * 1e3
            print(
                f"  flat punch {displacement:g}, {name} mesh: mean {d.mean():.4f} min {d.min():.4f} max {d.max():.4f}"
            )


def walls(path):
    """The rectangle: slopes without bound, so every order is compared on the surface only."""
    case = rectangle()
    touching = two_step(case, 0)[0].pressure > 0.0
    coarse, fine = (block(columns, touching)[2] for columns in (COARSE, FINE))
    on_top = abs(X - 0.5) < 0.05 - 1e-9
    print(f"\n{case.name}: |u_1| <= {abs(fine.u1).max():.2e}, p(1/2) {fine.pressure[len(fine.u1) // 2]:.4e}")
    over, step = NX // len(fine.u1), 2
    own = abs(coarse.u1 - fine.u1[::step]).max(), abs(coarse.pressure[COARSE] - fine.pressure[FINE])
    print(f"  coarse mesh against fine: u_1 {own[0]:.1e}, p(1/2) {own[1]:.1e}")
    for order in (0, 1):
        found = two_step(case, order)[0]
        d = abs(found.u1[::over] - fine.u1)
        top = d[on_top[::over]].max()
        middle = abs(found.pressure[NX // 2] - fine.pressure[len(fine.u1) // 2])
        print(f"  order {order}: u_1 {d.max():.1e} (plateau {top:.1e}, mean {d.mean():.1e}), p(1/2) {middle:.1e}")
    draw_surface(case, fine, (0,), path)


def unloaded(case):
    """Fig. 5.5: step 1 alone, the displacement that the forces of (5.15) call up on the flat body."""
    up = topography.formed_surface(case.topography, case.elastic)
    tractions = fields.Inside((up,), case.elastic).plane(0.0, ("stress5", "stress3"))[:, 0]
    surface = fields.surface_under_tractions(tractions, case.elastic)
    formed = inside(surface, np.zeros(1), case.elastic)
    print(
        f"\n{case.name}, unloaded: u_1 {abs(formed.u1).max():.1e}, u_3 - h {abs(formed.u3 - case.topography).max():.1e}"
    )


def draw_surface(case, fine, orders, path):
    """Draw both displacements and the pressure along the surface, by orders and by finite elements."""
    figure = Figure((12, 3.6), layout="constrained")
    places = np.arange(len(fine.u1)) / len(fine.u1)
    for axis, name in zip(figure.subplots(1, 3), ("u1", "u3", "pressure"), strict=True):
        axis.plot(places, getattr(fine, name), color="0.6", lw=3, label="finite elements")
        for order in orders:
            axis.plot(X, getattr(two_step(case, order)[0], name), lw=1, label=f"two-step GFMD, order {order}")
        axis.set(xlabel="$x/L_x$", title=name)
    handles, labels = axis.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False)
    figure.suptitle(f"{case.name}: lengths in $L_x$, stresses in $E^*$")
    figure.savefig(path, dpi=80)


def draw(case, meshes, path):
    """Draw displacements and stresses of two-step GFMD, of the finite elements, and their difference."""
    mesh, solution, _ = meshes[1]
    x, z, *found = mesh.inside(solution)
    levels, column = np.unique(np.round(z, 12)), np.unique(np.round(x, 12))
    order = np.lexsort((np.round(x, 12), np.round(z, 12)))
    here = at_points(inside(two_step(case, 2)[2], levels, case.elastic), levels, x, z)
    figure = Figure((13, 15), layout="constrained")
    axes = figure.subplots(len(PARTS), 3, sharex=True, sharey=True)
    for line, name, elements in zip(axes, PARTS, found, strict=True):
        shape = len(levels), len(column)
        theirs, ours = elements[order].reshape(shape), here[name][order].reshape(shape)
        limit = np.quantile(abs(theirs), 0.99)
        scale = 10.0 ** np.floor(np.log10(limit))
        for axis, values, title in zip(
            line[:2], (ours, theirs), ("two-step GFMD, order 2", "finite elements"), strict=True
        ):
            drawn = axis.contourf(
                column, levels, values / scale, np.linspace(-limit, limit, 22) / scale, cmap="RdBu_r", extend="both"
            )
            axis.set_title(f"{name} / {scale:.0e}: {title}", fontsize=9)
        figure.colorbar(drawn, ax=line[:2], format="%.2g")
        difference = ours - theirs
        limit = max(np.quantile(abs(difference), 0.999), 1e-300)
        drawn = line[2].contourf(
            column, levels, difference, np.linspace(-limit, limit, 22), cmap="PuOr_r", extend="both"
        )
        line[2].set_title("difference", fontsize=9)
        figure.colorbar(drawn, ax=line[2], format="%.1e")
    for axis in axes[-1]:
        axis.set_xlabel("$x/L_x$")
    for axis in axes[:, 0]:
        axis.set(ylabel="$z/L_x$", ylim=(max(-0.5, levels[0]), 0.0))
    figure.suptitle(f"{case.name}: lengths in $L_x$, stresses in $E^*$, at the labels of the flat body")
    figure.savefig(path, dpi=80)


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    print("Errors against the finer mesh: displacements in L_x, pressures and stresses in E*")
    thesis = sinusoid()
    unloaded(thesis)
    meshes = compare(thesis)
    superpositions(thesis, meshes)
    draw(thesis, meshes, folder / "sinusoid.png")
    draw_surface(thesis, meshes[1][2], (0, 2), folder / "sinusoid_surface.png")
    print("\nTab. 5.1: |sigma_33(x = 1/2)| differences in 1e-3 E*")
    punches()
    walls(folder / "rectangle_surface.png")
    for slope in (0.025, 0.028, 0.030, 0.032):
        meshes = compare(triangle(slope))
    draw(triangle(slope), meshes, folder / "triangle.png")
    draw_surface(triangle(slope), meshes[1][2], (0, 2), folder / "triangle_surface.png")
    for amplitude in (0.0025, 0.005, 0.02, 0.04):
        compare(sinusoid(amplitude, 0.33 * amplitude))
    for displacement in (1e-3, 1e-2):
        compare(sinusoid(0.01, displacement))
    for thickness in THICKNESSES:
        meshes = compare(sinusoid(thickness=thickness))
    draw(sinusoid(thickness=thickness), meshes, folder / "thin.png")
    for gradient in (0.01, 0.03, 0.1, 0.2):
        meshes = compare(rough(gradient))
    draw(rough(gradient), meshes, folder / "rough.png")
    compare(rough(0.03, thickness=0.1))
