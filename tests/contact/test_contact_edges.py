"""Where a contact ends between two nodes, against closed forms."""

import warnings
from types import SimpleNamespace

import numpy as np
import pytest
import textbook
from scipy.special import ellipe, ellipk

import gfmd_numba
from gfmd_numba.contact import evaluation
from gfmd_numba.contact.area_correction import HALF_SPACE, contact_length, edge
from gfmd_numba.contact.state import Contact
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.table import Options
from gfmd_numba.theory import closed_forms
from support.cases import some_of

NUMERICS = Options("conjugate_gradients", residual=1e-10)


def press(height, load):
    found = equilibrate(
        (height.max() - height)[np.newaxis],
        SpectralResponse.of_normal(stiffness.half_space(grid.wavenumbers(len(height)))),
        load,
        NUMERICS,
    )
    assert (found.status == 0).all()
    return found


def elastic_length(pressure, touching):
    return contact_length(pressure, touching, HALF_SPACE, elastic=touching, filled=touching, ends=False)


def wave(x):
    return 0.01 * np.cos(2 * np.pi * x)


def row_of_cylinders(x):
    return -(x**2) / 2


@pytest.mark.parametrize(
    ("height", "half_width", "bound"),
    [
        (wave, lambda load: closed_forms.westergaard_half_width(load, 0.01), 0.01),
        (row_of_cylinders, lambda load: textbook.hertz_line_half_width(load, 1.0), 0.05),
    ],
)
def test_contact_length_is_right_to_a_small_part_of_a_spacing(height, half_width, bound):
    """Node counting is wrong by up to one spacing, and by 0.38 on average."""
    nx = 512
    x = np.arange(nx) / nx - 0.5
    errors, counted = [], []
    for load in np.linspace(0.002, 0.006, 9):
        found = press(height(x), load)
        length, unknown = elastic_length(found.pressure, found.touching)
        errors.append((length[0] - 2 * half_width(load)) * nx)
        counted.append(found.touching.sum() - 2 * half_width(load) * nx)
        assert unknown == 0.0
    assert np.abs(errors).max() < bound
    assert np.abs(counted).max() > 0.5


def test_two_contacts_of_a_two_scale_wave_add_up():
    """Refinement is the reference: both contacts end where eight times the nodes say they do."""
    lengths = {}
    for nx in (512, 4096):
        x = np.arange(nx) / nx - 0.5
        found = press(0.01 * np.cos(2 * np.pi * x) + 0.002 * np.cos(6 * np.pi * x + 1.0), 0.004)
        lengths[nx] = elastic_length(found.pressure, found.touching)[0][0], found.touching.mean()
    assert lengths[512][0] == pytest.approx(lengths[4096][0], abs=0.05 / 512)
    assert abs(lengths[512][1] - lengths[4096][0]) > 0.1 / 512


def test_short_stretches_have_a_length_and_an_error():
    touching = np.zeros((2, 32), dtype=bool)
    touching[0, 3:5] = touching[0, 9] = True
    touching[1, :] = True
    length, error = elastic_length(touching.astype(float), touching)
    assert length[0] * 32 == pytest.approx(3 - 4 * 0.19001, abs=1e-4)
    assert error[0] * 32 == pytest.approx(np.sqrt(4 / 12))
    assert length[1] == 1.0
    assert error[1] == 0.0


def aliased(q):
    return q - 2 * np.pi * np.round(q / (2 * np.pi))


@pytest.mark.parametrize("power", [0, 2, -2])
def test_the_excess_of_an_edge_is_linear_in_the_power_of_the_stiffness(power):
    """Winkler's foundation, K ~ q^0, has none; an incompressible film, K ~ q^-2, has twice that of q the other way."""
    found = edge(lambda q: 0.5 * q**power, 1.0 / 512)
    assert found.excess == pytest.approx(power * HALF_SPACE.excess, abs=1e-5)
    np.testing.assert_allclose(found.of_sides, power * np.array(HALF_SPACE.of_sides), atol=2e-3)
    assert found.second == pytest.approx(2.0 + power * (HALF_SPACE.second - 2.0), abs=2e-3)


THIN = {
    "slab as thin as a node spacing": ElasticBody(0.3, 1 / 512),
    "Winkler": ElasticBody(0.3, 0.01 / 512),
    "incompressible, as thin as a node spacing": ElasticBody(0.5, 1 / 512),
    "incompressible film": ElasticBody(0.5, 0.1 / 512),
    "soft layer on a stiff half-space": ElasticBody.layered((0.3 / 512,), (Material(1.0, 0.3),), Material(50.0, 0.3)),
}


@pytest.mark.parametrize("name", THIN)
def test_edges_on_thin_bodies_lie_where_a_finer_grid_has_them(name):
    """Of one asperity on 16 positions between the nodes; the half-space's correction is off by 0.1 to 0.5 nodes."""
    body, nx, finer, half_width = THIN[name], 512, 16, 0.05

    def areas(nx, positions, load):
        stiff = body.condensed_stiffness(grid.wavenumbers(nx))
        stiff[0] = 0.0
        punch = (np.arange(nx) / nx - 0.5 + positions[:, np.newaxis]) ** 2 / 2
        found = equilibrate(punch, SpectralResponse.of_normal(stiff), load, Options("active_set_newton"))
        assert (found.status == 0).all()
        made = Contact(-punch, punch, found, stiffness=body.condensed_stiffness)
        return evaluation.contact_area_fraction(made) * nx, evaluation.located_length(made)[0] * nx

    stiff = body.condensed_stiffness(np.array([np.pi / half_width]))[0]  # a load for about the width
    load, positions = stiff * half_width**3 / 3.0, np.arange(16) / 16 / nx
    mean, located = areas(nx, positions, load)
    true = areas(nx * finer, np.zeros(1), load)[1][0] / finer
    assert true > 12.0
    assert abs(mean.mean() - true) < 0.1
    assert np.abs(located - true).max() < 0.3


def test_what_all_edges_are_off_by_adds_up_and_what_each_is_off_by_does_in_squares():
    """Of the same stretches three times side by side, on a slab that is as much thinner."""

    def error(copies):
        touching, none = np.tile(np.arange(64) % 16 < 5, copies)[np.newaxis], np.zeros((1, 64 * copies))
        found, slab = SimpleNamespace(touching=touching, plastic=None), ElasticBody(0.3, 0.01 / copies)
        made = Contact(none, none, found, stiffness=slab.condensed_stiffness)
        return evaluation.contact_area_fraction_error(made)[0] * touching.size

    once, thrice, each = error(1), error(3), 8 / 12.0
    assert once**2 > 1.01 * each
    assert thrice**2 - 3.0 * each == pytest.approx(9.0 * (once**2 - each))


def test_the_area_of_a_mirrored_profile_is_as_uncertain_as_that_of_its_field():
    """The mirror images of an edge lie at the same place between two nodes, and do not average out."""
    x = np.arange(256) / 256
    heights = sum(np.cos(np.pi * k * x + k * k) / k**1.5 for k in range(1, 40))  # in um

    def relative_error(heights, **keys):
        roughness = {"method": "measured", "heights": heights, "units": {"z": "um"}, "spacing": "1 um", **keys}
        body = {"youngs_modulus": "100 GPa", "poissons_ratio": 0.3}
        scene = {
            "body": body,
            "roughness": roughness,
            "interface": {"hard_wall": {}},
            "loading": {"pressure": "30 MPa"},
        }
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = gfmd_numba.solve({"scene": scene})
        at_nodes, located = (float(found[name]) for name in ("contact_area_fraction_error", "kappa_edges_error"))
        return at_nodes * found["x"].size, int(found["n_segments"]), located

    of_period, contacts, located = relative_error(heights, periodic="mirror")
    assert contacts >= 2
    assert of_period == pytest.approx(2.0 * np.sqrt(2 * contacts / 2 / 12.0))
    twice = np.concatenate((heights, heights[::-1]))  # the same contact, of which nothing says that it is mirrored
    assert located == pytest.approx(np.sqrt(2.0) * relative_error(twice)[2])
    of_field, contacts, _ = relative_error(heights)
    assert of_field == pytest.approx(np.sqrt(2 * contacts / 12.0))


def test_areas_of_maps_are_off_by_their_error_and_small_contacts_are_warned_of():
    """Maps of few contacts of few nodes each, against grids that are four times as fine."""

    def found(heights, **keys):
        roughness = {"method": "measured", "heights": heights, "units": {"z": "um"}, **keys}
        body = {"youngs_modulus": "100 GPa", "poissons_ratio": 0.3}
        scene = {"length": "32 um", "body": body, "roughness": roughness, "interface": {"hard_wall": {}}}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return gfmd_numba.solve({"scene": scene | {"loading": {"pressure": "100 MPa"}}})

    waves = np.fft.fftfreq(32, 1 / 32)
    q = np.hypot(waves[:, np.newaxis], waves)
    amplitudes = np.where((q > 0.0) & (q <= 8.0), 1.0 / np.maximum(q, 1.0) ** 1.8, 0.0)
    parts = []
    for seed in range(10):
        phases = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, q.shape)
        heights = np.fft.ifft2(amplitudes * np.exp(1j * phases)).real
        heights *= 0.5 / heights.std()
        coarse, fine = found(heights), found(heights, points=128)
        true, error = float(fine["contact_area_fraction"]), float(coarse["contact_area_fraction_error"])
        parts.append((float(coarse["contact_area_fraction"]) - true) / error)
        assert ("narrow on this grid" in coarse.attrs["validity"]) == (error > 0.05 * coarse["contact_area_fraction"])
    assert 0.4 < np.sqrt(np.mean(np.square(parts))) < 1.2


def solved(nx, aspect_ratio, reduced_pressure):
    x = np.arange(nx) / nx
    heights = 1e-4 * np.cos(80 * np.pi * x) + 3e-5 * np.cos(14 * np.pi * x)
    body = {"poissons_ratio": 0.3, "aspect_ratio": aspect_ratio}
    scene = {"body": body, "interface": {"hard_wall": {}}, "loading": {"reduced_pressure": reduced_pressure}}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return gfmd_numba.solve(scene, heights)


def test_a_scene_of_a_thin_slab_has_the_contact_length_of_a_finer_grid():
    coarse, fine = solved(1000, 1e-5, 25.0), solved(16_000, 1e-5, 25.0)
    off = coarse["contact_area_fraction"] - fine["contact_area_fraction_counted"]
    assert abs(off) < 2.0 * coarse["contact_area_fraction_error"]
    assert coarse.attrs["validity"] == ""


def test_edges_of_contacts_of_few_nodes_on_thin_slabs_are_doubted():
    doubt = solved(200, 1e-5, 5.0).attrs["validity"]
    assert "node spacings wide on average, on a body thin against these" in doubt
    assert "thin against these" not in solved(200, 0.5, 0.05).attrs["validity"]


@pytest.mark.parametrize("longer", some_of([1.0, 3.0, 19.0], 0, 2))
def test_perimeter_bias_is_the_mean_over_the_edges_of_stretched_contacts(longer):
    """Each edge by the integral of its own direction, its length by that of an ellipse."""
    q = (np.arange(100_000) + 0.5) * 0.01
    angles = (np.arange(100) + 0.5) * np.pi / 200
    reach, sides = 0.0, 0.0
    for facing_x, facing_y in zip(longer * np.cos(angles), np.sin(angles), strict=True):
        length = np.hypot(facing_x, facing_y)
        alias = np.hypot(aliased(q * facing_x / length), aliased(q * facing_y / length))
        rest = (np.log(q[-1]) + 1.0 - np.log(2.4)) / q[
            -1
        ]  # the mean of the logarithm over the zone is about that of 2.4
        reach += length * ((np.log(q / alias) / q**2).sum() * 0.01 + rest) / np.pi
        sides += facing_x + facing_y
    found = HALF_SPACE.perimeter_bias(np.array([round(1000 * longer)]), np.array([1000]))
    assert found[0] == pytest.approx(reach / sides, rel=0.002)


def test_hertzian_contacts_on_a_map_have_the_area_of_the_closed_form():
    """Johnson, Contact Mechanics (4.26), of an ellipse along y, and the periodic images as a paraboloid."""
    n, rng, longer, left, excess = 96, np.random.default_rng(0), 4.0, 0.0, 0.0
    images = 9.0336217  # sum of 1/r^3 over the square lattice
    x, stiff = np.arange(n) / n - 0.5, stiffness.half_space(grid.magnitudes((n, n)))
    for _ in range(16):
        b, (y0, x0) = rng.uniform(4.0, 7.0) / np.sqrt(longer) / n, rng.uniform(0.0, 1.0, 2) / n
        a, m = longer * b, 1.0 - longer**-2
        along_a = b / (m * a**2) * (ellipk(m) - ellipe(m))
        along_b = b / (m * a**2) * (longer**2 * ellipe(m) - ellipk(m))
        load = 2.0 / 3.0 * np.pi * a * b
        lifted = load * images / (4.0 * np.pi)
        punch = (along_b + lifted) * (x + x0) ** 2 + (along_a + lifted) * (x + y0)[:, np.newaxis] ** 2
        found = equilibrate(punch[np.newaxis], SpectralResponse.of_normal(stiff), load, Options("active_set_newton"))
        made = Contact(-punch[np.newaxis], punch[np.newaxis], found)
        left += evaluation.contact_area_fraction(made)[0] - np.pi * a * b
        excess += evaluation.contact_area_fraction_counted(made)[0] - np.pi * a * b
    assert excess > 0.0
    assert abs(left) < 0.1 * excess
