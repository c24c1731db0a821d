"""Finite elements with J2 plasticity: plane strain, periodic sides, fixed base, a rigid punch without friction.

An independent reference for plastic flow: quadratic elements with four points each, Newton's method with the consistent
tangent, and contact of nodes by an active set. Lengths in L_x, stresses in E*.
"""

import numpy as np
from finite_elements import Body
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, LinearForm
from skfem.helpers import ddot, eye, sym_grad, trace


class PlasticBody(Body):
    """A slab that yields at a stress and hardens by a modulus, pressed step by step."""

    def __init__(self, columns, z_edges, poissons_ratio, yield_stress, hardening):
        super().__init__(columns, z_edges, poissons_ratio)
        self.points = Basis(self.mesh, self.element, intorder=3)
        self.at = np.asarray(self.points.global_coordinates())
        self.mu, self.bulk = float(self.shear[0, 0]), float(self._volume()[0, 0]) + 2.0 / 3.0 * float(self.shear[0, 0])
        self.yield_stress, self.hardening = yield_stress, hardening
        self.plastic = np.zeros((4, *self.at.shape[1:]))  # xx, zz, xz, yy
        self.equivalent = np.zeros(self.at.shape[1:])
        self.u = np.zeros(self.stiffness.shape[0])
        self.touching = np.zeros(len(self.top), dtype=bool)

    def _flow(self, u):
        """Deviatoric and mean stress at the points, plastic strains, and what the tangent needs."""
        strain = sym_grad(self.points.interpolate(self.merge @ u))
        volume = np.asarray(trace(strain))
        total = np.array([strain[0, 0], strain[1, 1], strain[0, 1], 0.0 * volume])
        total[[0, 1, 3]] -= volume / 3.0
        trial = 2.0 * self.mu * (total - self.plastic)
        size = np.sqrt(1.5 * (trial[0] ** 2 + trial[1] ** 2 + trial[3] ** 2 + 2.0 * trial[2] ** 2))
        excess = size - self.yield_stress - self.hardening * self.equivalent
        added = np.maximum(excess, 0.0) / (3.0 * self.mu + self.hardening)
        way = 1.5 * trial / np.maximum(size, 1e-300)
        return trial - 2.0 * self.mu * added * way, self.bulk * volume, self.plastic + added * way, added, way, size

    def _resists(self, deviator, mean):
        """Forces that restore the nodes."""

        @LinearForm
        def force(v, _):
            of_v = sym_grad(v)
            along_x, along_z = (deviator[0] + mean) * of_v[0, 0], (deviator[1] + mean) * of_v[1, 1]
            return along_x + along_z + 2.0 * deviator[2] * of_v[0, 1]

        return self.merge.T @ force.assemble(self.points)

    def _share(self, u, moved, free):
        """Share of a step after which the forces do least work along it, of those that are free."""

        def work(share):
            return abs(moved[free] @ self._resists(*self._flow(u + share * moved)[:2])[free])

        whole = work(1.0)
        return 1.0 if whole < 1e-3 * work(1e-3) else min((1.0, 0.5, 0.25, 0.1), key=work)

    def step(self, clearance, most=200):
        """Equilibrium where no top node rises above its clearance; return pressures of the top nodes."""
        base = np.flatnonzero(self.owned_label[1] <= self.owned_label[1].min() + 1e-12)
        u, touching = self.u.copy(), self.touching | (clearance < 0.0)
        for i in range(most):
            deviator, mean, _, added, way, size = self._flow(u)
            flows = added > 0.0
            soft = np.where(flows, 3.0 * self.mu * added / np.maximum(size, 1e-300), 0.0)
            share = np.where(flows, 3.0 * self.mu / (3.0 * self.mu + self.hardening), 0.0) - soft
            mu, bulk = self.mu, self.bulk

            @BilinearForm
            def tangent(u, v, _, soft=soft, share=share, n=way, mu=mu, bulk=bulk):
                of_u, of_v = sym_grad(u), sym_grad(v)
                deviatoric = of_u - eye(trace(of_u) / 3.0, 2)
                along = n[0] * of_u[0, 0] + n[1] * of_u[1, 1] + 2.0 * n[2] * of_u[0, 1]
                across = n[0] * of_v[0, 0] + n[1] * of_v[1, 1] + 2.0 * n[2] * of_v[0, 1]
                whole = 2.0 * mu * (1.0 - soft) * ddot(deviatoric, of_v) + bulk * trace(of_u) * trace(of_v)
                return whole - 4.0 / 3.0 * mu * share * along * across

            stiffness = (self.merge.T @ tangent.assemble(self.points) @ self.merge).tocsc()
            resists = self._resists(deviator, mean)
            held = np.zeros(len(u), dtype=bool)
            held[base] = held[self.top[touching]] = True
            free, moved = np.flatnonzero(~held), np.zeros(len(u))
            moved[self.top[touching]] = clearance[touching] - u[self.top[touching]]
            rows = stiffness[free]
            load = -resists[free] - rows[:, np.flatnonzero(held)] @ moved[held]
            moved[free] = splu(rows[:, free].tocsc(), permc_spec="MMD_AT_PLUS_A").solve(load)
            u = u + self._share(u, moved, free) * moved
            reaction = self._resists(*self._flow(u)[:2])
            pulled = touching & (reaction[self.top] > 0.0)
            inside = ~touching & (u[self.top] > clearance + 1e-14)
            settled = abs(moved).max() < 1e-10 * abs(clearance).max()
            if not settled and i % 4:
                continue  # the contact changes less often than the flow
            if settled and not (pulled | inside).any():
                *_, self.plastic, added, _, _ = self._flow(u)
                self.equivalent = self.equivalent + added
                self.u, self.touching = u, touching
                return -reaction[self.top] / self._lengths()
            touching = (touching & ~pulled) | inside
        raise RuntimeError("the step did not settle")
