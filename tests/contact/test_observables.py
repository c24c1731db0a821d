"""Measures on contacts made by hand, and the edge constant."""

import mpmath
import numpy as np
import pytest

from gfmd_numba.contact import evaluation
from gfmd_numba.contact.area_correction import HALF_SPACE
from gfmd_numba.contact.observables import recorded
from gfmd_numba.contact.state import Contact
from gfmd_numba.solvers.equilibrium import Equilibrium
from gfmd_numba.solvers.status import Status


def contact(touching, heights=None, status=Status.ok):
    pressure = np.atleast_2d(touching).astype(float)
    rows, n = pressure.shape
    heights = np.zeros((rows, n)) + np.cos(2 * np.pi * np.arange(n) / n) if heights is None else heights
    counts = np.ones(rows, dtype=np.int64)
    equilibrium = Equilibrium(
        np.zeros((rows, n)),
        pressure,
        pressure > 0,
        None,
        np.full(rows, status),
        counts * 1e-9,
        counts,
        counts,
        counts * 1.0,
        counts * 0.5,
    )
    return Contact(heights, np.ones((rows, n)), equilibrium)


def test_edge_bias_is_the_wiener_hopf_constant():
    excess = mpmath.nsum(lambda k: mpmath.si(k * mpmath.pi) / mpmath.pi - 0.5, [1, mpmath.inf])
    assert pytest.approx(float(0.25 - excess), abs=1e-13) == HALF_SPACE.excess


@pytest.mark.parametrize(
    ("nodes", "segments"),
    [
        ("00000000", 0),
        ("00010000", 1),
        ("10000001", 1),  # one stretch across the period
        ("11011011", 2),
        ("10101010", 4),
        ("11111111", 0),
    ],
)
def test_segments_are_counted_around_the_period(nodes, segments):
    touching = np.array([int(c) for c in nodes])
    c = contact(touching)
    assert evaluation.n_segments(c)[0] == segments
    assert evaluation.contact_area_fraction_counted(c)[0] == touching.mean()
    corrected = (touching.sum() - 2 * HALF_SPACE.excess * segments) / 8
    assert evaluation.contact_area_fraction(c)[0] == pytest.approx(corrected)


def test_kappa_and_gradient_are_those_over_the_contact():
    touching = np.zeros(64)
    touching[14:19] = 3.0
    values = evaluation.measure(contact(touching))
    slope = 2 * np.pi * np.sin(2 * np.pi * np.arange(14, 19) / 64)
    g, p = np.sqrt(2) * np.pi, 15 / 64
    assert values["rms_gradient"][0] == pytest.approx(g)
    share = np.array([1 - HALF_SPACE.excess, 1, 1, 1, 1 - HALF_SPACE.excess])
    assert values["rms_gradient_contact"][0] == pytest.approx(np.sqrt((share * slope**2).sum() / share.sum()))
    assert values["kappa_counted"][0] == pytest.approx(5 / 64 * g / p)
    area = values["contact_area_fraction"][0]
    assert values["kappa"][0] == pytest.approx(area * g / p)
    assert values["kappa_r"][0] == pytest.approx(area * values["rms_gradient_contact"][0] / p)
    assert values["mean_gap"][0] == 1.0


@pytest.mark.parametrize("status", [s for s in Status if s != Status.ok])
def test_a_failed_run_has_no_results_but_keeps_its_diagnostics(status):
    values = evaluation.measure(contact(np.ones(8), status=status))
    for name, row in recorded(hardness=False).items():
        assert np.isnan(values[name]).all() == (row.of == "contact"), name


def test_observables_share_what_they_have_in_common(monkeypatch):
    calls = []
    for module, name in ((evaluation.statistics, "power"), (evaluation.area_correction, "contact_length")):
        original = getattr(module, name)
        monkeypatch.setattr(
            module, name, lambda *given, name=name, original=original: calls.append(name) or original(*given)
        )
    one, other = contact([0, 1, 1, 0, 0, 1, 0, 0]), contact([1, 1, 1, 1, 0, 1, 0, 0])
    first = evaluation.measure(one)
    assert sorted(calls) == ["contact_length", "power"]
    second = evaluation.measure(other)
    assert len(calls) == 4
    assert first["kappa"][0] != second["kappa"][0]
