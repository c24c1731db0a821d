"""Cases of thesis chapter 5 and beyond, by two-step GFMD and by finite elements, on the same labels."""

from dataclasses import dataclass

import numpy as np
import slab_stiffness
from finite_elements import Body, graded
from inner_fields import inside

from gfmd_numba.contact import two_step as rough_bodies
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.rough_surfaces import RoughBody
from gfmd_numba.contact.slopes import Slopes
from gfmd_numba.contact.state import State
from gfmd_numba.elasticity import fields, topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine, statistics
from gfmd_numba.roughness.surfaces import given_surface
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.table import Options

NX = 2560  # 512 times 5: 9/20 and 11/20 are nodes of every grid and mesh
COARSE, FINE = 320, 640
X = np.arange(NX) / NX
NUMERICS = Options("conjugate_gradients", residual=1e-9)


@dataclass(frozen=True)
class Case:
    """Heights `[NX]` above the top of a slab of height `thickness`, and how far the punch comes down (L_x)."""

    name: str
    heights: np.ndarray
    displacement: float
    thickness: float = 1.0
    nu: float = 0.33

    @property
    def elastic(self):
        return ElasticBody(self.nu, self.thickness + self.heights.mean())

    @property
    def topography(self):
        return self.heights - self.heights.mean()

    @property
    def gradient(self):
        return float(statistics.rms_gradient(self.heights))


def sinusoid(amplitude=0.01, displacement=3.3e-3, thickness=1.0):
    """Amplitude and displacement in z_m; the crest is at x = 1/2 (5.3.2)."""
    name = f"sinusoid, A = {amplitude:g} z_m, punch {displacement:g} z_m, a = {thickness:g}"
    heights = -amplitude * thickness * np.cos(2 * np.pi * X)
    return Case(name, heights, displacement * thickness, thickness)


def rectangle():
    """(5.17) with both step functions subtracted from each other: the plateau is from 9/20 to 11/20."""
    return Case("rectangle", np.where(abs(X - 0.5) <= 0.05 + 1e-9, 0.01, 0.0), 3.0e-3)


def triangle(slope):
    """(5.18) read as its sketch: flat top from 9/20 to 11/20, flanks of that slope down to the base."""
    heights = np.clip(0.01 - slope * (abs(X - 0.5) - 0.05), 0.0, 0.01)
    return Case(f"triangle, g = {slope:g}", heights, 3.0e-3)


def rough(gradient, hurst=0.8, thickness=1.0, longest=2, shortest=32):
    heights = gradient * self_affine.SelfAffineWaves(hurst, longest, shortest).heights((NX,), 2018, range(1))[0]
    return Case(f"self-affine, H = {hurst:g}, g = {gradient:g}, a = {thickness:g}", heights, 0.1 * gradient, thickness)


@dataclass(frozen=True)
class Surface:
    """Both displacements and the pressure on nodes of a surface."""

    u1: np.ndarray
    u3: np.ndarray
    pressure: np.ndarray


def two_step(case, order):
    """Surface `[NX]`, what was solved, and the surface from which fields inside follow."""
    profile, gradient = given_surface(case.topography)
    asked = Problem(profile, case.elastic, Interactions(hard_wall=True), None, case.displacement / gradient, NUMERICS)
    slopes = Slopes(asked, (RoughBody(case.elastic, 1.0, heights=case.topography),), gradient, order, None)
    pressed = rough_bodies.solve(asked, State.untouched(profile.heights[np.newaxis], (slopes,)))
    equilibrium, (response,) = pressed.equilibrium, pressed.responses
    assert equilibrium.status[0] == 0, case.name
    pressure = equilibrium.pressure[0] * gradient
    tractions = np.stack((np.zeros(NX), -pressure))
    u1, u3 = case.elastic.response((NX,)).apply(tractions)
    surface = topography.rough_surface(tractions, case.topography, case.elastic, order)
    return Surface(u1 + response.along[0], u3 + response.u3, pressure), pressed, surface


def finite_elements(case, columns, touching):
    """Mesh, solution and surface; nodes are moved by u'' so that their labels are those of two-step GFMD."""
    body = case.elastic
    up = topography.formed_surface(case.topography, body)

    def formed(x, z):
        levels, row = np.unique(np.round(z, 12), return_inverse=True)
        moved = inside(up, np.minimum(levels, 0.0), body)
        column = np.rint(x * NX).astype(int) % NX
        return moved.u1[row, column], moved.u3[row, column]

    over = NX // (2 * columns)
    mesh = Body(columns, graded(body.aspect_ratio, 40, 0.5 / columns), case.nu, formed)
    clearance = (case.heights.max() - case.heights - case.displacement)[::over]
    solution = mesh.press(clearance, touching[::over].copy())
    return mesh, solution, Surface(*mesh.along_top(solution), -mesh.traction(solution))


def block(columns, touching):
    """The rectangle with its vertical walls as they are: a block on a flat slab; labels are places."""
    case = rectangle()
    rows = round(0.01 * 2 * columns)
    edges = np.concatenate((graded(1.0, 40, 0.5 / columns), np.linspace(0.0, 0.01, rows + 1)[1:]))
    mesh = Body(columns, edges, case.nu, kept=lambda x, z: (z < 0.0) | (abs(x - 0.5) < 0.05))
    over = NX // (2 * columns)
    clearance = (case.heights.max() - case.heights - case.displacement)[::over]
    solution = mesh.press(clearance, touching[::over].copy())
    return mesh, solution, Surface(*mesh.along_top(solution), -mesh.traction(solution))


def at_points(found, levels, x, z):
    """Fields on the points (x, z) of a mesh out of those on [levels, NX]."""
    row = np.searchsorted(levels, np.round(z, 12))
    column = np.rint(x * NX).astype(int) % NX
    return {name: values[row, column] for name, values in vars(found).items()}


def hooke(strain1, strain3, strain5, nu):
    """Stresses 1, 3 and 5 of plane strain in E*."""
    shear = (1 - nu) / 2
    volume = 2 * shear * nu / (1 - 2 * nu) * (strain1 + strain3)
    return 2 * shear * strain1 + volume, 2 * shear * strain3 + volume, shear * strain5


def superposed(case, flat, levels):
    """Stresses 1, 3 and 5 by the thesis's ways to superpose strains, name -> arrays `[levels, NX]`."""
    body = case.elastic
    load = inside(flat, levels, body)
    form = inside(topography.formed_surface(case.topography, body), levels, body)
    total = (load.strain1 + form.strain1, load.strain3 + form.strain3, load.strain5 + form.strain5)
    a, w, mean = body.aspect_ratio, case.topography.std(), flat.uniform[2]
    uniform = mean * w / (a * (a + w))  # (5.16) as its derivation has it: strain of superposition too large by this
    # the same over all waves: gradients of the load with respect to places in the rough body, grad u (1 + grad u'')^-1
    v11, v33, f11, f33 = load.strain1, load.strain3, 1 + form.strain1, 1 + form.strain3
    v31, f31 = (along(u3) for u3 in (load.u3, form.u3))
    v13, f13 = load.strain5 - v31, form.strain5 - f31
    volume = f11 * f33 - f13 * f31
    g11, g13 = (v11 * f33 - v13 * f31) / volume, (v13 * f11 - v11 * f13) / volume
    g31, g33 = (v31 * f33 - v33 * f31) / volume, (v33 * f11 - v31 * f13) / volume
    return {
        "total strain, u'' not subtracted": hooke(*total, case.nu),
        "strains superposed (5.6)": hooke(load.strain1, load.strain3, load.strain5, case.nu),
        "and (5.16) for q = 0": hooke(load.strain1, load.strain3 - uniform, load.strain5, case.nu),
        "and the same over all q": hooke(g11, g33, g13 + g31, case.nu),
    }


def along(field):
    return grid.signal(grid.derivative(grid.coefficients(field)), NX)


def flat_punch(displacement):
    """A flat body under a flat punch of width 0.1: surfaces `[NX]` and of a mesh, stresses below the middle."""
    nu, body = 0.33, ElasticBody(0.33, 1.0)
    under = abs(X - 0.5) < 0.05 + 1e-9
    wall = np.where(under, -displacement, 1e3)
    k = slab_stiffness.slab(grid.wavenumbers(NX), nu, 1.0)
    found = equilibrate(wall[np.newaxis], SpectralResponse.of_normal(k), None, NUMERICS)
    flat = fields.surface_under_tractions(np.stack((np.zeros(NX), -found.pressure[0])), body)
    meshes = []
    for columns in (COARSE, FINE):
        over = NX // (2 * columns)
        mesh = Body(columns, graded(1.0, 40, 0.5 / columns), nu)
        meshes.append((mesh, mesh.press(wall[::over], under[::over].copy())))
    return flat, meshes


def on_axis(mesh, solution):
    """Labels z and sigma_33 on the line x = 1/2 of a mesh, the mean of both sides of it."""
    x, z, *_, stress3, _ = mesh.inside(solution, across=0.0)
    near = abs(x - 0.5) < 1e-9
    order = np.argsort(z[near])
    return z[near][order], stress3[near][order]
