"""The page that compares with other codes is written by one command, and judges all codes alike."""

import sys

import numpy as np
import peers
import pytest

from gfmd_numba import kernels
from gfmd_numba.elasticity import stiffness
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.certificate import Certificate

TINY = (peers.Case((64,), 0.8, 0.05, 2), peers.Case((32, 32), 0.3, 0.2, 2))


@pytest.fixture
def no_peers(monkeypatch):
    for name in ("tamaas", "ContactMechanics", "aspher"):
        monkeypatch.setitem(sys.modules, name, None)


def test_the_page_is_written_where_no_peer_is_installed(no_peers, tmp_path, capsys):
    peers.main(["--page", str(tmp_path / "peers.md")], TINY)
    page = (tmp_path / "peers.md").read_text(encoding="utf-8")
    assert "Tamaas: skipped" in capsys.readouterr().out
    assert "| profile 64 | 0.8 | 0.05 |" in page
    assert "| map 32² | 0.3 | 0.2 |" in page
    assert "No other code was installed" in page
    assert "{" not in page


@pytest.mark.long
def test_the_table_of_the_page_is_at_most_80_columns_wide(monkeypatch, tmp_path):
    monkeypatch.setattr(peers, "PEERS", dict.fromkeys(("Tamaas", "ContactMechanics", "ASPHER"), lambda: peers.here))
    monkeypatch.setattr(peers.peers_page, "versions", ", ".join)
    peers.main(["--page", str(tmp_path / "peers.md")], TINY)
    rows = [line for line in (tmp_path / "peers.md").read_text(encoding="utf-8").splitlines() if line.startswith("|")]
    assert len(rows) == len(TINY) + 4  # two tables
    assert max(map(len, rows)) <= 80


@pytest.mark.parametrize("case", TINY)
def test_the_residual_is_that_of_the_certificate(case):
    """Of a pressure that is off, so that the residual is no rounding."""
    punch = next(case.punches())
    pressure = peers.here(punch, case.load, 1e-10)
    assert peers.residual(punch, pressure, case.load) < 1e-8
    pressure[pressure > 0.0] *= np.linspace(0.9, 1.1, np.count_nonzero(pressure))
    body = stiffness.half_space(grid.magnitudes(punch.shape))
    soft = np.divide(1.0, body, out=np.zeros_like(body), where=grid.magnitudes(punch.shape) > 0.0)
    gap = punch + grid.signal(soft * grid.coefficients(pressure, punch.ndim), *punch.shape)
    gap -= gap[pressure > 0.0].mean()
    displacement = punch - np.where(pressure > 0.0, 0.0, np.maximum(gap, 0.0))
    body.flat[0] = 0.0
    restoring = grid.signal(body * grid.coefficients(displacement, punch.ndim), *punch.shape)
    certificate, row, load = Certificate(1, kernels.ContactLimits()), np.arange(1), np.array([case.load])
    flat = [array.reshape(1, -1) for array in (displacement, restoring, punch)]
    certificate.look(kernels.SurfaceState.of_normal(*flat, load), row, punch.size)
    expected = certificate.residual(load, row)[0]
    assert expected > 1e-3
    np.testing.assert_allclose(peers.residual(punch, pressure, case.load), expected, rtol=1e-9)


def test_a_tolerance_is_tightened_until_the_residual_is_reached():
    punch = next(TINY[0].punches())
    asked = []

    def careless(punch, load, tolerance):
        asked.append(tolerance)
        pressure = peers.here(punch, load, 1e-12)
        return pressure * (1.0 + 1e3 * tolerance * np.sin(np.arange(punch.size)))

    _, _, found, tolerance = peers.converged(careless, punch, TINY[0].load, 1e-7)
    assert found <= peers.RESIDUAL
    assert tolerance == min(asked) < 1e-8
