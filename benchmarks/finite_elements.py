"""Finite elements for a body with a rough top: plane strain, periodic sides, fixed base, rigid punch.

An independent reference: small strains, the topography as geometry of the mesh, quadratic elements, and contact of
nodes with the punch by an active set. Lengths in L_x, stresses in E*.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, ElementQuad2, ElementVector, MeshQuad, MeshQuad2
from skfem.helpers import ddot, eye, sym_grad, trace

GAUSS = 0.5 - 0.5 / np.sqrt(3.0)


def graded(height, rows, finest):
    """Edges from -height to 0, the uppermost row `finest` high and each lower one higher by the same factor."""
    low, high = 1.0, 10.0
    for _ in range(200):
        factor = 0.5 * (low + high)
        low, high = (factor, high) if finest * np.polyval(np.ones(rows), factor) < height else (low, factor)
    edges = -np.concatenate(([0.0], np.cumsum(finest * low ** np.arange(rows))))[::-1]
    edges[0] = -height
    return edges


@dataclass
class Solution:
    """Displacement of every degree of freedom, force on every one, and how the active set ended."""

    displacement: np.ndarray
    reaction: np.ndarray
    touching: np.ndarray
    iterations: int


class Body:
    """A slab of quadratic quadrilaterals, whose nodes `move` from their labels (x, z) on the flat slab.

    `kept` says which elements there are, by the label of their centre.
    """

    def __init__(self, columns, z_edges, poissons_ratio, move=None, kept=None):
        self.nu = poissons_ratio
        flat = MeshQuad.init_tensor(np.linspace(0.0, 1.0, columns + 1), z_edges)
        if kept is not None:
            flat = flat.restrict(np.flatnonzero(kept(*flat.p[:, flat.t].mean(axis=1))))
        labels = MeshQuad2.from_mesh(flat)
        x, z = labels.doflocs
        moved = np.zeros((2, len(x))) if move is None else np.array(move(x, z))
        self.mesh = MeshQuad2(labels.doflocs + moved, labels.t)
        self.element = ElementVector(ElementQuad2())
        self._flat = labels
        self.basis = Basis(self.mesh, self.element, intorder=4)
        # degrees of freedom of the right edge are those of the left one
        self.label = Basis(labels, self.element, intorder=4).doflocs
        n = self.basis.N
        self.component = np.zeros(n, dtype=int)
        for dofs in (self.basis.nodal_dofs, self.basis.facet_dofs, self.basis.interior_dofs):
            self.component[dofs[1]] = 1
        keys = np.round(np.array([self.label[0] % 1.0, self.label[1], self.component]), 9)
        _, first, self._owner = np.unique(keys, axis=1, return_index=True, return_inverse=True)
        self._owner = np.ravel(self._owner)
        self.merge = coo_array((np.ones(n), (np.arange(n), self._owner))).tocsr()
        self.owned_label, self.owned_component = self.label[:, first], self.component[first]
        self.owned_position = self.basis.doflocs[:, first]
        self.stiffness = (self.merge.T @ self._assemble() @ self.merge).tocsc()
        self.top = self._top()

    def _assemble(self):
        shear, nu = (1.0 - self.nu) / 2.0, self.nu

        @BilinearForm
        def energy(u, v, _):
            strain = sym_grad(u)
            stress = 2.0 * shear * strain + eye(2.0 * shear * nu / (1.0 - 2.0 * nu) * trace(strain), 2)
            return ddot(stress, sym_grad(v))

        return energy.assemble(self.basis)

    def _top(self):
        """Vertical degrees of freedom of the highest node of every column of nodes, by x."""
        vertical = np.flatnonzero(self.owned_component == 1)
        x, z = np.round(self.owned_label[:, vertical], 9)  # x of one column is not always the same to the last bit
        order = np.lexsort((-z, x))
        return vertical[order][np.concatenate(([True], np.diff(x[order]) > 0.0))]

    @property
    def x(self):
        """Labels of the top nodes."""
        return self.owned_label[0][self.top]

    def press(self, clearance, touching, most=60, friction=0.0):
        """Equilibrium where no top node rises above its clearance `[top node]`; `touching` is a first guess.

        A level punch that slides along x on all touching nodes pulls each by `friction` times what it presses.
        """
        base = self.owned_label[1] <= self.owned_label[1].min() + 1e-12
        partners = self._partners() if friction else []
        u = np.zeros(self.stiffness.shape[0])
        for iteration in range(1, most + 1):
            held = base.copy()
            held[self.top[touching]] = True
            u[:] = 0.0
            u[self.top[touching]] = clearance[touching]
            free = np.flatnonzero(~held)
            stiffness = self.stiffness
            if friction:
                on = (partners[touching], self.top[touching])
                drag = coo_array((np.full(touching.sum(), friction), on), shape=stiffness.shape).tocsr()
                stiffness = (stiffness + drag @ stiffness).tocsc()
            rows = stiffness[free]
            load = -(rows[:, np.flatnonzero(held)] @ u[held])
            symmetric = {"SymmetricMode": not friction}
            u[free] = splu(rows[:, free].tocsc(), permc_spec="MMD_AT_PLUS_A", options=symmetric).solve(load)
            force = self.stiffness @ u
            pulled = touching & (force[self.top] > 0.0)
            inside = ~touching & (u[self.top] > clearance * (1 + 1e-12))
            if not (pulled | inside).any():
                return Solution(u, force, touching, iteration)
            touching = (touching & ~pulled) | inside
        raise RuntimeError("the active set did not settle")

    def traction(self, solution):
        """Normal traction on the top nodes per length of label, from nodal forces."""
        corner = np.arange(len(self.top)) % 2 == 0
        return solution.reaction[self.top] / np.where(corner, 1.0, 2.0) * 3.0 / (1.0 / (len(self.top) // 2))

    def along_top(self, solution):
        """Tangential and normal displacement of the top nodes."""
        return solution.displacement[self._partners()], solution.displacement[self.top]

    def _partners(self):
        """Horizontal degrees of freedom of the top nodes."""
        tangential = {
            tuple(np.round(at, 9)): i for i, at in enumerate(self.owned_label.T) if not self.owned_component[i]
        }
        return np.array([tangential[tuple(np.round(self.owned_label[:, i], 9))] for i in self.top])

    def inside(self, solution, across=0.5):
        """Labels x, z, displacements, and stresses 1, 3, 5 on a line in each element and at its Gauss heights.

        `across` is where between the element's sides. Arrays `[quantity, point]`.
        """
        points = np.array([[GAUSS, 1.0 - GAUSS], [across, across]])
        weights = np.ones(2)
        basis = Basis(self.mesh, self.element, quadrature=(points, weights))
        labels = Basis(self._flat, self.element, quadrature=(points, weights)).global_coordinates()
        field = basis.interpolate(self.merge @ solution.displacement)
        strain = sym_grad(field)
        shear, nu = (1.0 - self.nu) / 2.0, self.nu
        volume = 2.0 * shear * nu / (1.0 - 2.0 * nu) * (strain[0, 0] + strain[1, 1])
        stress = 2.0 * shear * strain[0, 0] + volume, 2.0 * shear * strain[1, 1] + volume, 2.0 * shear * strain[0, 1]
        return np.array([np.ravel(a) for a in (*np.asarray(labels), *np.asarray(field), *stress)])
