"""The linear problem of a guess, its solution and the revision of the guess, against dense matrices and loops."""

import numpy as np
import pytest

from gfmd_numba import kernels
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.solvers.friction.friction_guess import Found, FrictionGuess, median_slip_node
from gfmd_numba.solvers.friction.linear_problem import CoupledBody, NearTractions, StickSlip, minimal_residual
from gfmd_numba.solvers.products import Products

N, FRICTION = 64, 0.3
COULOMB = kernels.ContactLimits(friction=FRICTION)
BODIES = [ElasticBody(0.2, None), ElasticBody(0.4, 0.1), ElasticBody(0.5, 0.3)]


def compliance_matrix(stiffness):
    """Dense displacements (tangential, normal) of nodal tractions (tangential, pressure), by inverses wave by wave."""
    matrix = np.zeros((2 * N, 2 * N))
    for node in range(2 * N):
        load = np.zeros(2 * N)
        load[node] = 1.0 if node < N else -1.0
        t1, t3 = np.fft.rfft(load[:N]), np.fft.rfft(load[N:])
        u1, u3 = np.zeros_like(t1), np.zeros_like(t3)
        for k in range(1, N // 2 + 1):
            a, b, c = stiffness.elements[0][k], 1j * stiffness.elements[1][k], stiffness.normal[k]
            u1[k], u3[k] = np.linalg.solve([[a, b], [-b, c]], [t1[k], t3[k]])
        u1[0] = t1[0] / stiffness.elements[0][0] if stiffness.elements[0][0] > 0.0 else 0.0
        u3[0] = t3[0] / stiffness.normal[0] if stiffness.normal[0] > 0.0 else 0.0
        matrix[:, node] = np.concatenate((np.fft.irfft(u1, N), np.fft.irfft(u3, N)))
    return matrix


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("free", [True, False])
def test_products_are_those_of_the_dense_compliance_and_of_its_inverse(body, free):
    stiffness = body.response((N,))
    stiffness = stiffness.with_mean(0.0) if free else stiffness
    held = stiffness.with_mean(0.0) if stiffness.is_rigid else stiffness
    products, rng = Products(held, 2, (N,), sources=2), np.random.default_rng(0)
    shear, pressure = rng.normal(size=(2, N))
    shear -= shear.mean() if stiffness.elements[0][0] == 0.0 else 0.0
    pressure -= pressure.mean()
    u = products.deflect(1, np.array([shear, pressure]))
    exact = compliance_matrix(stiffness) @ np.concatenate((shear, pressure))
    np.testing.assert_allclose(u.ravel(), exact, atol=1e-13 * abs(exact).max())
    products.displacement[1, :, :N] = u
    products.restore(np.array([1]))
    np.testing.assert_allclose(products.restoring[1, :, :N], [shear, -pressure], atol=1e-12)
    np.testing.assert_array_equal(products.n_transforms, [0, 8])


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("loaded", [True, False])
def test_a_guess_is_solved_like_its_dense_problem(body, loaded):
    """Gap and slip are zero up to uniform displacements where these are free, and both loads are as prescribed."""
    stiffness = body.response((N,))
    stiffness = stiffness.with_mean(0.0) if loaded else stiffness
    drifts, load = stiffness.elements[0][0] == 0.0, 0.2 * N
    rng = np.random.default_rng(1)
    contact, slip = np.zeros(N, dtype=bool), np.zeros(N, dtype=np.int64)
    contact[[3, 4, 5, 6, 20, 21, 22, 40, 60, 61]] = True
    slip[[3, 6, 20, 60]] = [-1, 1, 1, -1]
    wall, anchor = rng.normal(size=(2, N)) * 1e-2
    products = Products(stiffness, 1, (N,), sources=2)
    body = CoupledBody(
        lambda f: products.deflect(0, f), NearTractions(stiffness, (N,)), COULOMB, load if loaded else None, drifts
    )
    guess = FrictionGuess.sticking(contact, np.array([np.zeros(N), np.ones(N)]), wall)
    guess.direction[0] = slip
    problem = StickSlip(guess, None, body)

    def product(x):
        return problem.correction(problem.restricted(problem.deflected(x), x))[0]

    x = problem.unknowns(guess.tractions)
    misfit = problem.correction(
        problem.prescribed(anchor[np.newaxis]) - problem.restricted(problem.deflected(x, known=True), x)
    )[0]
    basis, shares = minimal_residual(product, misfit, 1e-13, 40)
    shear, pressure = problem.tractions(x + shares @ basis)

    touching, stuck, slipping = np.flatnonzero(contact), np.flatnonzero(contact & (slip == 0)), np.flatnonzero(slip)
    unknowns, matrix = len(touching) + len(stuck), compliance_matrix(stiffness)
    to_tractions = np.zeros((2 * N, unknowns))
    to_tractions[N + touching, np.arange(len(touching))] = 1.0
    to_tractions[stuck, len(touching) + np.arange(len(stuck))] = 1.0
    for node in slipping:
        to_tractions[node, np.searchsorted(touching, node)] = -FRICTION * slip[node]
    rows = np.concatenate((N + touching, stuck))
    system, right = matrix[rows] @ to_tractions, np.concatenate((wall[touching], anchor[stuck]))
    constraints = []
    if loaded:
        constraints.append((np.arange(unknowns) < len(touching), to_tractions[N:].sum(axis=0), load))
    if drifts:
        constraints.append((np.arange(unknowns) >= len(touching), to_tractions[:N].sum(axis=0), 0.0))
    columns, sums, prescribed = zip(*constraints, strict=True) if constraints else ([], [], [])
    k = len(constraints)
    bordered = np.zeros((unknowns + k, unknowns + k))
    bordered[:unknowns, :unknowns] = system
    bordered[:unknowns, unknowns:] = np.reshape(columns, (k, unknowns)).T
    bordered[unknowns:, :unknowns] = np.reshape(sums, (k, unknowns))
    exact = to_tractions @ np.linalg.solve(bordered, np.concatenate((right, prescribed)))[:unknowns]
    np.testing.assert_allclose(np.concatenate((shear, pressure)), exact, atol=1e-9 * abs(exact).max())


@pytest.mark.parametrize("aim", [1e-2, 1e-10])
def test_minimal_residuals_stop_at_their_aim_and_solve(aim):
    rng = np.random.default_rng(2)
    matrix, right = np.eye(30) + 0.05 * rng.normal(size=(30, 30)), rng.normal(size=30)
    calls = []

    def product(x):
        calls.append(x)
        return matrix @ x

    basis, shares = minimal_residual(product, right, aim, 30)
    assert len(calls) == len(shares) == len(basis)
    assert np.linalg.norm(right - matrix @ (shares @ basis)) <= 1.01 * aim
    assert np.linalg.norm(right - matrix @ (shares[:-1] @ basis[:-1])) > aim
    if aim < 1e-9:
        np.testing.assert_allclose(shares @ basis, np.linalg.solve(matrix, right), atol=1e-9)


def test_minimal_residuals_do_nothing_below_their_aim_and_pass_on_what_is_no_number():
    basis, shares = minimal_residual(lambda x: x, np.full(3, 1e-9), 1e-8, 5)
    assert len(basis) == len(shares) == 0
    assert np.isnan(minimal_residual(lambda x: x * np.nan, np.ones(3), 1e-8, 5)[1]).all()


@pytest.mark.parametrize("components", [1, 2])
def test_a_guess_is_revised_as_node_by_node(components):
    rng = np.random.default_rng(3)
    contact, slips = rng.random(N) < 0.6, rng.random(N) < 0.6
    direction = rng.normal(size=(components, N)) * (contact & slips)
    direction /= np.where(direction.any(axis=0), np.linalg.norm(direction, axis=0), 1.0)
    slid, shear = rng.normal(size=(2, components, N))
    pressure, gap = np.where(contact, rng.normal(size=N) + 0.5, 0.0), rng.normal(size=N)
    guess = FrictionGuess.sticking(contact.copy(), np.array([*shear, pressure]), np.zeros(N))
    guess.direction = direction.copy()
    found = Found(np.array([*slid, -gap]), np.array([*shear, pressure]), np.zeros(N), np.zeros((components, N)))
    revision = guess.revision(found, COULOMB, 0.05, 0.0)
    guess.revise(revision, found, COULOMB, None)
    wrong = []
    for j in range(N):
        way, force, most = np.linalg.norm(slid[:, j]), np.linalg.norm(shear[:, j]), FRICTION * max(pressure[j], 0.0)
        touches, compliance, turned = contact[j], 0.0, np.zeros(components)
        if contact[j] and pressure[j] <= 0.0:
            touches = False
        elif contact[j] and direction[:, j].any():
            if direction[:, j] @ slid[:, j] > 0.0:
                turned, compliance = slid[:, j] / way, way / most
        elif contact[j]:
            turned = -shear[:, j] / force if force > most else turned
        elif gap[j] < -0.05:
            touches, turned = True, slid[:, j] / way if way > FRICTION * -gap[j] else turned
        if touches != contact[j] or turned.any() != direction[:, j].any():
            wrong.append(j)
        assert guess.contact[j] == touches
        assert guess.slip_compliance[j] == pytest.approx(compliance)
        np.testing.assert_allclose(guess.direction[:, j], turned)
        assert np.linalg.norm(guess.tractions[:-1, j]) <= most * (1.0 + 1e-12)
    np.testing.assert_array_equal(revision.wrong, wrong)
    assert len(wrong) > 10


def test_friction_on_both_sides_of_the_median_slip_balances():
    rng = np.random.default_rng(4)
    slid, pressure, contact = rng.normal(size=N), rng.random(N), rng.random(N) < 0.5
    middle = median_slip_node(slid, pressure, contact)
    assert contact[middle]
    pull = (pressure * np.sign(slid - slid[middle]))[contact].sum()
    assert abs(pull) <= pressure[middle]
