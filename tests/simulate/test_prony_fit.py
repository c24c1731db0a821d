"""A Prony series from a table of DMA: what was put in comes out, and wrong tables are refused."""

import numpy as np
import pytest
import yaml

from gfmd_numba.elasticity.prony import PronySeries
from gfmd_numba.scene import InputError
from gfmd_numba.simulate.prony_fit import fit_relaxation, read_table
from support.command_line import gfmd

FREQUENCY = np.geomspace(1e-2, 1e4, 31)
TIMES = np.geomspace(1.0 / (2.0 * np.pi * 1e4), 1.0 / (2.0 * np.pi * 1e-2), 13)  # two to a decade


def table(path, moduli, unit=1.0, header="frequency (Hz), E' (Pa), E'' (Pa)\n", separator=", "):
    """Write the moduli of a series of a relaxed modulus of 3 MPa."""
    values = 3e6 * PronySeries(tuple(moduli), tuple(TIMES)).complex_modulus(2.0 * np.pi * FREQUENCY) / unit
    rows = (separator.join(map(repr, map(float, row))) for row in zip(FREQUENCY, values.real, values.imag, strict=True))
    path.write_text(header + "\n".join(rows) + "\n")


def test_a_series_is_found_again(tmp_path):
    moduli = np.random.default_rng(1).uniform(0.1, 3.0, TIMES.size) * (np.arange(TIMES.size) % 3 > 0)
    table(tmp_path / "dma.csv", moduli)
    found = fit_relaxation(*read_table(tmp_path / "dma.csv"))
    assert found.youngs_modulus == pytest.approx(3e6, rel=1e-6)
    assert found.misfit < 1e-9
    large = [(m, tau) for m, tau in zip(found.series.moduli, found.series.times, strict=True) if m > 1e-6]
    np.testing.assert_allclose(large, [(m, tau) for m, tau in zip(moduli, TIMES, strict=True) if m], rtol=1e-5)


def test_a_power_law_is_fitted_with_a_misfit_that_is_said(tmp_path):
    modulus = 1e6 * (1.0 + (1j * FREQUENCY) ** 0.3)
    found = fit_relaxation(FREQUENCY, modulus.real, modulus.imag)
    series = found.youngs_modulus * found.series.complex_modulus(2.0 * np.pi * FREQUENCY)
    off = np.concatenate([series.real / modulus.real, series.imag / modulus.imag]) - 1.0
    assert found.misfit == pytest.approx(np.sqrt((off**2).mean()), rel=1e-6)
    assert found.misfit < 0.05


@pytest.mark.parametrize(("unit", "separator"), [("Pa", ", "), ("MPa", "\t"), ("kPa", ";"), ("MPa", " ")])
def test_the_command_prints_keys_of_a_body(tmp_path, unit, separator):
    moduli = 1.0 + np.arange(TIMES.size) % 2
    table(tmp_path / "dma.txt", moduli, {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6}[unit], "# rubber\n", separator)
    done = gfmd("relaxation", tmp_path / "dma.txt", "--unit", unit)
    assert done.exit_code == 0, done.output
    assert "rms misfit 0.00%" in done.stdout
    body = yaml.safe_load(done.stdout)
    assert body["youngs_modulus"] == "3e+06 Pa"
    assert len(body["relaxation"]) == TIMES.size


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "you gave no number; gfmd allows a text file of three columns"),
        ("1,2,3\n4,5,6\n", "you gave 2 rows of numbers; gfmd allows at least 3 different frequencies"),
        ("1 2\n3 4\n", "you gave rows of 2 numbers; gfmd allows three numbers above 0"),
        ("1,2,3\n1,2,-3\n", "you gave 1 2 -3 in row 2 of numbers; gfmd allows three numbers above 0"),
        ("1,2,3\n1,2,x\n", "you gave 'x' in line 2, not a number (what is missing is an empty cell, or nan); gfmd"),
    ],
)
def test_tables_that_are_none_are_refused(tmp_path, text, said):
    (tmp_path / "dma.csv").write_text(text)
    with pytest.raises(InputError) as refused:
        fit_relaxation(*read_table(tmp_path / "dma.csv"))
    assert said in str(refused.value)


def test_decimal_commas_are_read(tmp_path):
    (tmp_path / "dma.csv").write_text("f [Hz];E1 [MPa];E2 [MPa]\n10;6,2;1,9\n0,1;3,0;0,5\n1;4,1;1,2\n")
    found = read_table(tmp_path / "dma.csv", "MPa")
    np.testing.assert_allclose(found, [[0.1, 1, 10], [3e6, 4.1e6, 6.2e6], [5e5, 1.2e6, 1.9e6]], rtol=1e-12)


def test_a_liquid_has_no_relaxed_modulus():
    liquid = 1e6 * PronySeries((1.0,), (TIMES[6],)).lags(2.0 * np.pi * FREQUENCY)[0]
    with pytest.raises(InputError, match=r"a storage modulus that still falls at 0.01 Hz"):
        fit_relaxation(FREQUENCY, liquid.real, liquid.imag)


def test_a_unit_of_another_quantity_is_refused(tmp_path):
    table(tmp_path / "dma.csv", np.ones(TIMES.size))
    with pytest.raises(InputError, match="unit: you gave 'mm'; gfmd allows a unit of pressure"):
        read_table(tmp_path / "dma.csv", "mm")
