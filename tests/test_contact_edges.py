"""Where a contact ends between two nodes, against closed forms."""

import numpy as np
import pytest

from gfmd_numba import grid, reference
from gfmd_numba.contact_edges import contact_length
from gfmd_numba.dynamics import equilibrate
from gfmd_numba.elasticity import stiffness
from gfmd_numba.scene import Numerics

NUMERICS = Numerics(solver="conjugate_gradients", residual=1e-10)


def press(height, load):
    found = equilibrate(
        (height.max() - height)[np.newaxis], stiffness.half_space(grid.wavenumbers(len(height))), load, NUMERICS
    )
    assert (found.status == 0).all()
    return found


def wave(x):
    return 0.01 * np.cos(2 * np.pi * x)


def row_of_cylinders(x):
    return -(x**2) / 2


@pytest.mark.parametrize(
    ("height", "half_width", "bound"),
    [
        (wave, lambda load: reference.westergaard_half_width(load, 0.01), 0.01),
        (row_of_cylinders, lambda load: reference.hertz_line_half_width(load, 1.0), 0.05),
    ],
)
def test_contact_length_is_right_to_a_small_part_of_a_spacing(height, half_width, bound):
    """Node counting is wrong by up to one spacing, and by 0.38 on average."""
    nx = 512
    x = np.arange(nx) / nx - 0.5
    errors, counted = [], []
    for load in np.linspace(0.002, 0.006, 9):
        found = press(height(x), load)
        length, unknown = contact_length(found.pressure, found.touching)
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
        lengths[nx] = contact_length(found.pressure, found.touching)[0][0], found.touching.mean()
    assert lengths[512][0] == pytest.approx(lengths[4096][0], abs=0.05 / 512)
    assert abs(lengths[512][1] - lengths[4096][0]) > 0.1 / 512


def test_short_stretches_and_their_error():
    touching = np.zeros((2, 32), dtype=bool)
    touching[0, 3:5] = touching[0, 9] = True
    touching[1, :] = True
    length, error = contact_length(touching.astype(float), touching)
    assert length[0] * 32 == pytest.approx(3 - 4 * 0.19001, abs=1e-4)
    assert error[0] * 32 == pytest.approx(np.sqrt(4 / 12))
    assert length[1] == 1.0
    assert error[1] == 0.0
