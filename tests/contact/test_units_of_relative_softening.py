"""The same dimensionless law in other units, or at another rms gradient, gets the same verdict of its resolution."""

import numpy as np
import pytest

from gfmd_numba.contact.contact_input import read_contact
from gfmd_numba.contact.relative_softening import COARSEST, softening, warning
from gfmd_numba.scene import InputError, load_scene


def in_units(length, modulus, gradient, range_, random):
    """One dimensionless adhesive scene in units of its own: file, and heights where they are not random."""
    roughness = {"method": "psd", "hurst": 0.8, "rms_gradient": gradient}
    if not random:
        heights = gradient * length * np.cos(2 * np.pi * np.arange(128) / 128) / (np.sqrt(2) * np.pi)
        roughness = {"method": "measured", "heights": heights, "units": {"z": "m"}}
    scale = gradient * length
    law = {"work_of_adhesion": 1e-2 * gradient * scale * modulus / (1 - 0.3**2), "range": range_ * scale}
    file = {
        "scene": {
            "length": length,
            "body": {"youngs_modulus": modulus, "poissons_ratio": 0.3, "aspect_ratio": 0.5},
            "roughness": roughness,
            "interface": {"hard_wall": {}, "exponential": law},
            "loading": {"displacement": 0.1 * scale},
        }
    }
    return file | ({"discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1}} if random else {})


UNITS = [(1.0, 1.0, 0.1), (1.0, 1.0, 0.01), (1e-4, 2.1e11, 0.1), (1e-4, 2.1e11, 0.01), (37.0, 3e-3, 0.1)]


def read(*scene):
    return read_contact(*load_scene(in_units(*scene)))


@pytest.mark.parametrize("random", [True, False], ids=["random", "array"])
@pytest.mark.parametrize(("range_", "x"), [(0.02, 0.1243), (0.01, 0.4974)])
def test_a_verdict_knows_no_units_and_no_gradient(range_, x, random):
    given = [read(*units, range_, random) for units in UNITS]
    problems = [each.reduced[0] for each in given]
    np.testing.assert_allclose([softening(each) for each in problems], x, rtol=1e-3)
    (said,) = {warning(problem, each.file.discretisation) for problem, each in zip(problems, given, strict=True)}
    assert (said == "") == (x < COARSEST)
    if random:  # heights of an array that is multiplied by a number are rounded anew
        assert len({each.identity for each in problems}) == 1


@pytest.mark.parametrize("random", [True, False], ids=["random", "array"])
@pytest.mark.parametrize("units", UNITS)
def test_a_refusal_knows_no_units_and_no_gradient(units, random):
    with pytest.raises(InputError, match="each node would snap into contact on its own"):
        read(*units, 0.005, random)
