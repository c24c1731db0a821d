"""Finite elements for a body with a rough top: plane strain, periodic sides, fixed base, rigid punch.

An independent reference: small strains, the topography as geometry of the mesh, quadratic elements, and contact of
nodes with the punch by an active set. Lengths in L_x, stresses in E*.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import root
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

    `kept` says which elements there are, by the label of their centre. `materials` gives modulus and Poisson's ratio at
    a depth below the flat top; by default there is one of modulus 1.
    """

    def __init__(self, columns, z_edges, poissons_ratio, move=None, kept=None, materials=None):
        flat = MeshQuad.init_tensor(np.linspace(0.0, 1.0, columns + 1), z_edges)
        if kept is not None:
            flat = flat.restrict(np.flatnonzero(kept(*flat.p[:, flat.t].mean(axis=1))))
        labels = MeshQuad2.from_mesh(flat)
        x, z = labels.doflocs
        centre = -flat.p[1, flat.t].mean(axis=0)
        modulus, self.nu = (
            np.broadcast_to(each, (1, len(centre))).T  # of each element
            for each in ((1.0, poissons_ratio) if materials is None else np.transpose([materials(d) for d in centre]))
        )
        self.shear = modulus * (1.0 - self.nu) / 2.0
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
        self.along_x = self._partners()

    def _assemble(self):
        shear, volume = self.shear, self._volume()

        @BilinearForm
        def energy(u, v, _):
            strain = sym_grad(u)
            stress = 2.0 * shear * strain + eye(volume * trace(strain), 2)
            return ddot(stress, sym_grad(v))

        return energy.assemble(self.basis)

    def _volume(self):
        """Lame's first constant of each element."""
        return 2.0 * self.shear * self.nu / (1.0 - 2.0 * self.nu)

    def _top(self):
        """Vertical degrees of freedom of the highest node of every column of nodes, by x."""
        vertical = np.flatnonzero(self.owned_component == 1)
        x, z = np.round(self.owned_label[:, vertical], 9)  # x of one column is not always the same to the last bit
        order = np.lexsort((-z, x))
        return vertical[order][np.concatenate(([True], np.diff(x[order]) > 0.0))]

    def _partners(self):
        """Horizontal degrees of freedom of the top nodes."""
        tangential = {
            tuple(np.round(at, 9)): i for i, at in enumerate(self.owned_label.T) if not self.owned_component[i]
        }
        return np.array([tangential[tuple(np.round(self.owned_label[:, i], 9))] for i in self.top])

    @property
    def x(self):
        """Labels of the top nodes."""
        return self.owned_label[0][self.top]

    def press(self, clearance, touching, most=60, friction=0.0, tractions=None, hardness=np.inf):
        """Equilibrium where no top node rises above its clearance `[top node]`; `touching` is a first guess.

        A level punch that slides along x on all touching nodes pulls each by `friction` times what it presses; an
        inclined one without friction by its slope, given in place of that for each node. An infinite friction holds
        them where they are on the unloaded body. `tractions` `[2, top node]`
        along x and z act too, per length of x. Nodes that would bear more than the `hardness` per length of x
        bear that, and give way.
        """
        base = self.owned_label[1] <= self.owned_label[1].min() + 1e-12
        pull = np.broadcast_to(friction, touching.shape)
        given = np.zeros(self.stiffness.shape[0])
        if tractions is not None:
            weight = self._lengths()
            given[self.along_x], given[self.top] = weight * tractions[0], weight * tractions[1]
        u, bears, yielded = np.zeros(self.stiffness.shape[0]), given[self.top].copy(), np.zeros(len(self.top), bool)
        for iteration in range(1, most + 1):
            held = base.copy()
            given[self.top] = bears
            given[self.top[yielded]] -= hardness * self._lengths()[yielded]
            held[self.top[touching]] = True
            u[:] = 0.0
            u[self.top[touching]] = clearance[touching]
            held[self.along_x[touching & np.isinf(pull)]] = True
            free = np.flatnonzero(~held)
            stiffness, loads = self.stiffness, given
            if pull.any() and np.isfinite(pull).all():
                on = (self.along_x[touching], self.top[touching])
                drag = coo_array((pull[touching], on), shape=stiffness.shape).tocsr()
                stiffness, loads = (stiffness + drag @ stiffness).tocsc(), given + drag @ given
            rows = stiffness[free]
            load = loads[free] - rows[:, np.flatnonzero(held)] @ u[held]
            symmetric = {"SymmetricMode": not pull.any()}
            u[free] = splu(rows[:, free].tocsc(), permc_spec="MMD_AT_PLUS_A", options=symmetric).solve(load)
            force = self.stiffness @ u - given
            pulled = touching & (force[self.top] > 0.0)
            inside = ~touching & ~yielded & (u[self.top] > clearance * (1 + 1e-12))
            yields = touching & (-force[self.top] > hardness * (1 + 1e-9) * self._lengths())
            lost = yielded & (u[self.top] < clearance)
            if not (pulled | inside | yields | lost).any():
                force[self.top] += given[self.top] - bears  # the punch's, prescribed tractions apart
                return Solution(u, force, touching | yielded, iteration)
            touching, yielded = (touching & ~pulled & ~yields) | inside | lost, (yielded & ~lost) | yields
        raise RuntimeError("the active set did not settle")

    def under_law(self, clearance, sliding, law, start, most=50):
        """Tangential and normal displacement, and the tractions along x and z, under a `law` of gap and slip.

        It acts between the top nodes and a level punch, per length of x; `start` is a first guess of displacements.
        """
        base = self.owned_label[1] <= self.owned_label[1].min() + 1e-12
        top, n = np.concatenate((self.along_x, self.top)), len(self.top)
        others = np.setdiff1d(np.flatnonzero(~base), top)
        between, within = self.stiffness[others][:, top].toarray(), self.stiffness[others][:, others]
        stiffness = self.stiffness[top][:, top] - between.T @ splu(within.tocsc()).solve(between)
        u, weight = np.concatenate(start), np.tile(self._lengths(), 2)
        for _ in range(most):
            gap, slip = clearance - u[n:], sliding - u[:n]
            tractions = np.concatenate((law.tangential_traction(gap, slip), law.normal_traction(gap, slip)))
            along, both, out = (np.diag(each) for each in law.stiffness(gap, slip[np.newaxis]))
            bend = np.diag(weight) @ np.block([[along, both], [both, out]])
            step = np.linalg.solve(stiffness + bend, weight * tractions - stiffness @ u)
            u = u + step
            if abs(step).max() < 1e-12:
                return u[:n], u[n:], tractions[:n], tractions[n:]
        raise RuntimeError("Newton's method did not settle")

    def press_inclined(self, punch, slope, touching, sliding=0.0, friction=0.0, most=40):
        """Equilibrium under a rigid punch z = `punch(x)` of `slope(x)`, met where each node has moved to.

        The punch has moved by `sliding` along x. Its pressure acts along its normal at that place, and all nodes slip:
        `friction` times the pressure acts along its surface.
        """
        z, moved = self.owned_position[1][self.top], np.zeros(len(self.top))
        for _ in range(most):
            at = self.x + moved - sliding
            pull = (slope(at) + friction) / (1.0 - slope(at) * friction)  # of what presses along z
            solution = self.press(punch(at) - z, touching, friction=pull)
            last, moved, touching = moved, solution.displacement[self.along_x], solution.touching
            if abs(moved - last).max() <= 1e-12:
                return solution
        raise RuntimeError("the places where nodes meet the punch did not settle")

    def under_inclined_law(self, punch, slope, sliding, law, start):
        """Tangential and normal displacement of the top nodes under a `law` of gap and slip along an inclined punch.

        Its energy per length of x is that of the gap along z to the punch z = `punch(x)`, and of the slip, to which a
        gap adds its slope; forces are differences of the energy. `start` is a first guess.
        """
        moves, z, step = self.compliance() * np.tile(self._lengths(), 2), self.owned_position[1][self.top], 1e-7

        def energy(u1, u3):
            at = self.x + u1 - sliding
            gap = punch(at) - z - u3
            return law.energy(gap, sliding - u1 + slope(at) * gap)

        def unsettled(u):
            u1, u3 = np.split(u, 2)
            sides = energy(u1 + step, u3) - energy(u1 - step, u3), energy(u1, u3 + step) - energy(u1, u3 - step)
            return u + moves @ np.concatenate(sides) / (2.0 * step)

        found = root(unsettled, np.concatenate(start), options={"xtol": 1e-10})
        if not found.success:
            raise RuntimeError(found.message)
        return np.split(found.x, 2)

    def compliance(self):
        """Displacements `[2 top nodes]`, along x and then along z, under unit forces on the same."""
        top = np.concatenate((self.along_x, self.top))
        free = np.flatnonzero(self.owned_label[1] > self.owned_label[1].min() + 1e-12)
        forces = np.zeros((self.stiffness.shape[0], len(top)))
        forces[top, np.arange(len(top))] = 1.0
        factors = splu(self.stiffness[free][:, free].tocsc(), permc_spec="MMD_AT_PLUS_A")
        forces[free] = factors.solve(forces[free])
        return forces[top]

    def traction(self, solution):
        """Normal traction on the top nodes per length of label, from nodal forces."""
        return solution.reaction[self.top] / self._lengths()

    def _lengths(self):
        """Length of x that each top node bears for: Simpson's weights, as elements are quadratic."""
        corner = np.arange(len(self.top)) % 2 == 0
        return np.where(corner, 1.0, 2.0) / 3.0 / (len(self.top) // 2)

    def along_top(self, solution):
        """Tangential and normal displacement of the top nodes."""
        return solution.displacement[self.along_x], solution.displacement[self.top]

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
        shear, volume = self.shear, self._volume() * (strain[0, 0] + strain[1, 1])
        stress = 2.0 * shear * strain[0, 0] + volume, 2.0 * shear * strain[1, 1] + volume, 2.0 * shear * strain[0, 1]
        return np.array([np.ravel(a) for a in (*np.asarray(labels), *np.asarray(field), *stress)])
