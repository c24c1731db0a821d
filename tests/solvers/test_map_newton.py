"""The solver of maps: its compliance between tiles, its contacts against another solver's, and how little it takes."""

import tracemalloc

import numpy as np
import pytest

from gfmd_numba import kernels
from gfmd_numba.arrays import threads
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import transform
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.certificate import pressure_scale
from gfmd_numba.solvers.equilibrium import begin, equilibrate
from gfmd_numba.solvers.iteration import HARD_WALL, Batch, Start
from gfmd_numba.solvers.pressures import Closing
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options
from gfmd_numba.solvers.tiles import newton
from gfmd_numba.solvers.tiles.compliance import FEW_TILES, MANY_TILES, SplitCompliance
from support.cases import some_of
from support.maps import body, press, rough

NEWTON, GRADIENTS = Options("active_set_newton"), Options("conjugate_gradients")
SLABS = [None, (0.0, 1.0), (0.33, 0.05), (0.5, 0.1), (0.5, 0.005)]


def oblong(shape, hurst, seed=3):
    """Rough map of any shape: every so many nodes of a square one are left out, or a part is."""
    square = rough(2 * max(shape), hurst=hurst, seed=seed)
    steps = [square.shape[1] // n for n in shape]
    made = square[:, :: steps[0], :: steps[1]][:, : shape[0], : shape[1]].copy()
    return made - made.min()


@pytest.mark.parametrize("slab", SLABS)
@pytest.mark.parametrize(("shape", "share"), [((96, 160), 0.5), ((104, 200), 0.02)])
@pytest.mark.parametrize(("split", "most"), [(MANY_TILES, 0.02), (FEW_TILES, 2e-3)])
def test_the_compliance_between_tiles_is_nearly_exact(shape, slab, share, split, most):
    """Compared with the exact convolution, of random pressures and of equal ones, up to a uniform displacement.

    Bodies about as thick as the distance that is summed up are softest there.
    """
    most *= {(0.33, 0.05): 2.0, (0.5, 0.1): 15.0 if split is FEW_TILES else 4.0}.get(slab, 1.0)
    rng = np.random.default_rng(2)
    stiff, tiles_each_way = body(shape, slab), (shape[0] // 8, shape[1] // 8)
    tiles, places = newton.listed(rng.random(tiles_each_way[0] * tiles_each_way[1]) < share)
    m = tiles.size
    compliance = SplitCompliance(stiff, shape, tiles_each_way, split=split)
    compliance.place(tiles, places)
    soft = np.divide(1.0, stiff, out=np.zeros_like(stiff), where=stiff > 0.0)
    for values in (rng.normal(size=(m + 1, 8, 8)), rng.random((m + 1, 8, 8)), np.ones((m + 1, 8, 8))):
        values[-1] = 0.0
        found, image = np.empty_like(values), np.zeros(shape)
        compliance.apply(values, found)
        kernels.put_tiles(values, tiles, image, shape[1])
        exact, expected = np.fft.irfft2(np.fft.rfft2(image) * soft, shape), np.zeros_like(values)
        kernels.take_tiles(exact, tiles, shape[1], expected)
        error, scale = found[:-1] - expected[:-1], expected[:-1] - expected[:-1].mean()
        assert np.std(error) < most * np.sqrt((scale**2).mean())


@pytest.mark.parametrize("slab", [None, (0.33, 0.05), (0.5, 0.02)])
@pytest.mark.parametrize(
    ("hurst", "shape", "load"), [(0.3, (104, 64), 1e-3), (0.5, (100, 100), 0.3), (0.3, (104, 64), 3.0)]
)
def test_contacts_are_those_of_conjugate_gradients(hurst, shape, load, slab):
    punch, stiff = oblong(shape, hurst), body(shape, slab)
    found, expected = (
        equilibrate(punch, SpectralResponse.of_normal(stiff), load, options) for options in (NEWTON, GRADIENTS)
    )
    assert found.status[0] == expected.status[0] == Status.ok
    np.testing.assert_array_equal(found.touching, expected.touching)
    np.testing.assert_allclose(found.pressure, expected.pressure, atol=1e-6 * expected.pressure.max())
    assert found.pressure.mean() == pytest.approx(load, rel=1e-7)


@pytest.mark.parametrize("slab", [(0.0, 1.0), (0.33, 0.05), (0.49, 0.01)])
@pytest.mark.parametrize("depth", [1e-3, 0.1, 0.6])
def test_a_prescribed_displacement_makes_the_contact_of_conjugate_gradients(slab, depth):
    punch = rough(128, hurst=0.5)
    punch -= depth * punch.mean()
    stiff = body((128, 128), slab)
    found, expected = (
        equilibrate(punch, SpectralResponse.of_normal(stiff), None, options) for options in (NEWTON, GRADIENTS)
    )
    assert found.status[0] == expected.status[0] == Status.ok
    np.testing.assert_array_equal(found.touching, expected.touching)
    np.testing.assert_allclose(found.pressure, expected.pressure, atol=1e-6 * expected.pressure.max())


@pytest.mark.parametrize(("share", "status"), [(0.5, Status.ok), (1.01, Status.no_equilibrium)])
def test_an_incompressible_slab_has_no_room_below_the_mean_of_the_punch(share, status):
    punch = rough(64)
    found = equilibrate(
        punch - share * punch.mean(), SpectralResponse.of_normal(body((64, 64), (0.5, 0.3))), None, NEWTON
    )
    assert found.status[0] == status


def test_a_punch_that_does_not_touch_has_no_pressure():
    found = equilibrate(np.full((1, 64, 64), 0.1), SpectralResponse.of_normal(body((64, 64), (0.3, 1.0))), None, NEWTON)
    assert found.status[0] == Status.ok
    assert found.pressure.max() == 0.0


@pytest.mark.parametrize("dense", [0.0, 2.0])
def test_near_and_exact_compliance_lead_to_the_same_contact(monkeypatch, dense):
    punch = rough(128, hurst=0.3)
    usual = press(punch, 0.05)
    monkeypatch.setattr(newton, "_DENSE", dense)
    other = press(punch, 0.05)
    np.testing.assert_array_equal(usual.touching, other.touching)
    np.testing.assert_allclose(usual.pressure, other.pressure, atol=1e-7 * usual.pressure.max())


def test_a_map_in_a_batch_is_what_it_is_alone():
    """Few contacts, so that the compliance between tiles is used, and a pressure and a count of transforms each."""
    punch, stiff = rough(128, range(3)), body((128, 128))
    together = equilibrate(punch, SpectralResponse.of_normal(stiff), 0.003, NEWTON)
    for i in range(3):
        alone = equilibrate(punch[i : i + 1], SpectralResponse.of_normal(stiff), 0.003, NEWTON)
        np.testing.assert_array_equal(alone.pressure[0], together.pressure[i])
        np.testing.assert_array_equal(alone.displacement[0], together.displacement[i])
        assert alone.n_transforms[0] == together.n_transforms[i]


@pytest.mark.parametrize(("large", "pieces"), some_of([(0, 32), (2**20, 2**14)], 0))
@pytest.mark.parametrize(
    ("nx", "load", "depth"),
    [
        (128, 0.003, None),
        (64, 5.0, None),
        (128, None, 0.2),
        (128, None, -1.0),
    ],
)
def test_threads_change_no_bit_and_pieces_no_node(monkeypatch, nx, load, depth, large, pieces):
    """Of few tiles and of all, of full contact and of none, with transforms and sums in pieces or as a whole."""
    punch, stiff = rough(nx), body((nx, nx), None if depth is None else (0.3, 1.0))
    if depth is not None:
        punch -= depth * punch.mean()
    plain = equilibrate(punch, SpectralResponse.of_normal(stiff), load, NEWTON)
    assert plain.status[0] == Status.ok
    monkeypatch.setattr(threads, "cores", lambda: 3)
    monkeypatch.setattr(threads, "_FEWEST", 0)
    monkeypatch.setattr(threads, "_PIECE", pieces)
    monkeypatch.setattr(transform, "_LARGE", large)
    found = []
    for number in (1, 3):
        with threads.shared_by(number):
            found.append(equilibrate(punch, SpectralResponse.of_normal(stiff), load, NEWTON))
    np.testing.assert_array_equal(found[0].touching, plain.touching)
    np.testing.assert_allclose(found[0].pressure, plain.pressure, atol=1e-7 * plain.pressure.max())
    for each in found[1:]:
        np.testing.assert_array_equal(each.pressure, found[0].pressure)
        np.testing.assert_array_equal(each.displacement, found[0].displacement)
        assert each.n_transforms[0] == found[0].n_transforms[0]
        assert each.residual[0] == found[0].residual[0]


class Diagonal:
    """An inverse that knows the diagonal of a compliance alone."""

    def __init__(self, diagonal):
        self.diagonal = diagonal

    def solve(self, r, z):
        z[: self.diagonal.size] = r[: self.diagonal.size] / self.diagonal


@pytest.mark.parametrize("free_mean", [False, True])
def test_sums_in_pieces_close_gaps_in_as_many_steps(monkeypatch, free_mean):
    """The pressure is that of Gaussian elimination; a wrong direction in pieces would take more steps."""
    random = np.random.default_rng(5)
    n, nodes = 60, np.sort(random.permutation(60)[:45])
    factors = random.normal(size=(n, n))
    compliance = factors @ factors.T + np.diag(np.linspace(1.0, 500.0, n))
    gap, pressure = random.normal(size=n), random.uniform(1.0, 2.0, n)
    inverse, found = Diagonal(np.diag(compliance)[nodes]), []
    for piece in (2**14, 8):
        monkeypatch.setattr(threads, "_PIECE", piece)
        iterate = kernels.Iterate(pressure.copy(), gap.copy(), np.zeros(n), np.zeros(n))

        def apply_compliance(iterate=iterate):
            iterate.st[:] = compliance @ iterate.t

        uniform, room = np.zeros(n), np.zeros((2, n))
        inverse.solve(np.ones(n), uniform)
        closing = Closing(iterate, nodes, inverse, apply_compliance, uniform, 0.0, free_mean, room)
        found.append((closing.solve(1e-10, 200), iterate.p[nodes]))
    (steps, whole), (steps_of_pieces, in_pieces) = found
    assert steps_of_pieces == steps < 200
    np.testing.assert_allclose(in_pieces, whole, rtol=1e-7)
    if not free_mean:
        own = compliance[np.ix_(nodes, nodes)]
        np.testing.assert_allclose(whole, pressure[nodes] - np.linalg.solve(own, gap[nodes]), rtol=1e-7)


@pytest.mark.parametrize("lost", [np.nan, -1.0])
def test_full_contact_bears_the_load_that_every_node_in_contact_has_lost(lost):
    contact = np.array([True, True, False, False])
    iterate = kernels.Iterate(np.where(contact, lost, 0.0), np.zeros(4), np.zeros(4), np.zeros(4))
    closing = Closing(iterate, np.array([0, 1]), None, None, np.ones(2), 0.0, True, np.zeros((2, 4)))
    assert closing.revise(contact, 2.0) == 2
    assert contact.all()
    np.testing.assert_array_equal(iterate.p, 0.5)


@pytest.mark.parametrize("load", [0.001, 0.003])
def test_a_run_that_is_cut_short_tells_the_residual_of_what_it_returns(load):
    punch, stiff = rough(128), body((128, 128))
    found = equilibrate(punch, SpectralResponse.of_normal(stiff), load, Options("active_set_newton", max_iterations=1))
    assert found.status[0] == Status.steps_used_up
    restoring = np.fft.irfft2(np.fft.rfft2(found.displacement[0]) * stiff, (128, 128))
    traction, touching = load - restoring, found.displacement[0] >= punch[0]
    allowed = np.where(touching, np.maximum(traction, 0.0), 0.0)
    np.testing.assert_allclose(found.pressure[0], allowed, atol=1e-12)
    balance = abs((traction - allowed).mean()) / load
    assert found.residual[0] == pytest.approx(max(abs(traction - allowed).max() / allowed.max(), balance), rel=1e-6)
    assert found.residual[0] > 1e-8


@pytest.mark.parametrize("slab", [None, (0.33, 0.05), (0.5, 0.01)])
def test_the_bound_of_tractions_is_their_largest_sum(slab):
    """Long waves are hard to press into a thin incompressible layer, whose nodes feel each other far away."""
    shape = (512, 512) if slab is None else (256, 256)
    stiff = body(shape, slab)
    stiff[0, 0] = 0.0
    felt = abs(np.fft.irfft2(stiff, shape)).sum()
    bound = newton.TileLevel(shape, stiff, shape).largest_traction
    assert felt <= bound <= 1.11 * felt


@pytest.mark.parametrize("slab", [None, (0.33, 0.05)])
@pytest.mark.parametrize("exactly", [False, True])
def test_the_certificate_takes_transforms_only_where_its_bound_does_not_do(monkeypatch, slab, exactly):
    """What it bounds is found from the displacement alone; both say that the contact is the same."""
    if exactly:
        monkeypatch.setattr(newton.MapContact, "bound", lambda contact: np.inf)
    punch, stiff = rough(128), body((128, 128), slab)
    stiff[0, 0] = 0.0  # the load is prescribed
    solver = begin(
        Batch(punch, SpectralResponse.of_normal(stiff), np.array([0.01]), HARD_WALL, Start.at_rest(punch)), NEWTON
    )
    assert isinstance(solver, newton.TileNewton)
    one, made = np.arange(1), []
    for _ in range(8):
        solver.advance(one)
        before = int(solver.n_transforms[0])
        residual = solver.residual(one)[0]
        made.append(int(solver.n_transforms[0]) - before)
        if residual <= 1e-8:
            break
    assert not any(made[:-1])
    assert made[-1] == (2 if exactly else 0)
    displacement = solver.displacement.reshape(128, 128)
    traction = 0.01 - np.fft.irfft2(np.fft.rfft2(displacement) * stiff, (128, 128))
    touching = displacement >= punch[0]
    violation = abs(traction - np.where(touching, np.maximum(traction, 0.0), 0.0)).max() / traction.max()
    assert violation <= residual * (1.0 + 1e-3)


@pytest.mark.parametrize("hurst", [0.3, 0.8])
def test_few_contacts_take_few_transforms_on_any_grid(hurst):
    """Where they touch less than a quarter of the tiles: on 128 nodes a side they touch more at H = 0.3."""
    taken = []
    for nx in (256, 512):
        heights = self_affine.SelfAffineWaves(hurst, 2, nx // 4).heights((nx, nx), 5, range(1))
        taken.append(press(heights.max() - heights, 0.005).n_transforms[0])
    assert max(taken) < 40


@pytest.mark.parametrize(("nx", "slab"), [(64, None), (64, (0.5, 0.1)), (72, (0.33, 0.05)), (1024, (0.5, 0.1))])
def test_the_pressure_of_full_contact_is_found_on_the_way(nx, slab):
    """At 1024 nodes a side transforms are made in pieces; a map of 64 is the coarsest one."""
    punch, response = rough(nx), SpectralResponse.of_normal(body((nx, nx), slab))
    batch = Batch(punch, response.with_mean(0.0), np.array([1e-3]), HARD_WALL)
    found = begin(batch, NEWTON).certificate.full_contact
    if nx == 64:
        assert found is None
        found = equilibrate(punch, response, 1e-3, NEWTON).full_contact_rms_pressure
    np.testing.assert_allclose(found, pressure_scale(punch, response), rtol=1e-12)


@pytest.mark.parametrize(("load", "most"), [(0.005, 64), (0.4, 106)])
def test_a_map_takes_few_arrays(load, most):
    """Bytes a node besides the punch and its stiffness: the result has 17 of them, the stiffness without mean 4."""
    punch, stiff = rough(256), body((256, 256))
    press(punch[:, ::4, ::4], load)
    tracemalloc.start()
    equilibrate(punch, SpectralResponse.of_normal(stiff), load, NEWTON)
    peak = tracemalloc.get_traced_memory()[1] / 256**2
    tracemalloc.stop()
    assert peak < most
