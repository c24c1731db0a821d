"""Layers whose moduli are ratios, 1 for the topmost, give stresses in its E* for heights without units."""

import numpy as np
import pytest

import gfmd_numba

HEIGHTS = 1e-3 * np.cos(2.0 * np.pi * np.arange(64) / 64)
TOP, BASE = {"height": 0.1, "youngs_modulus": 1, "poissons_ratio": 0.3}, {"youngs_modulus": 5, "poissons_ratio": 0.2}


def scene(modulus, **changes):
    top, base = (part | {"youngs_modulus": part["youngs_modulus"] * modulus} for part in (TOP, BASE))
    body = {"layers": [top], "base": base}
    return {"body": body, "interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.1}} | changes


def test_ratios_give_stresses_in_the_modulus_of_the_topmost_layer():
    found = gfmd_numba.solve(scene(1), HEIGHTS)
    assert {found[name].units for name in ("pressure", "gap", "x")} == {"1"}
    gradient = float(found["rms_gradient"])
    assert float(found["mean_pressure"]) == pytest.approx(0.1 * gradient, rel=1e-9)
    in_pascals = gfmd_numba.solve(scene(2e9, roughness={"units": {"z": "m"}}, length=1.0), HEIGHTS)
    assert in_pascals["pressure"].units == "Pa"
    modulus = 2e9 / (1.0 - 0.3**2)
    np.testing.assert_allclose(in_pascals["pressure"] / modulus, found["pressure"], rtol=1e-9, atol=1e-12)


def test_ratios_take_no_loads_in_pascal():
    with pytest.raises(gfmd_numba.InputError, match="youngs_modulus of every elastic body"):
        gfmd_numba.solve(scene(1, loading={"pressure": "1 MPa"}), HEIGHTS)
