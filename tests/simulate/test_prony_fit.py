"""A Prony series from a table of DMA: what was put in comes out, and wrong tables are refused."""

import numpy as np
import pytest
import yaml

from gfmd_numba.elasticity.prony import PronySeries
from gfmd_numba.scene import InputError, load_scene
from gfmd_numba.simulate.dma_table import Moduli, read_table
from gfmd_numba.simulate.prony_fit import fit_relaxation
from support.command_line import gfmd, unfolded

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
    found = fit_relaxation(read_table(tmp_path / "dma.csv"))
    assert found.youngs_modulus == pytest.approx(3e6, rel=1e-6)
    assert found.misfit < 1e-9
    large = [(m, tau) for m, tau in zip(found.series.moduli, found.series.times, strict=True) if m > 1e-6]
    np.testing.assert_allclose(large, [(m, tau) for m, tau in zip(moduli, TIMES, strict=True) if m], rtol=1e-5)


def test_a_power_law_is_fitted_with_a_misfit_that_is_said(tmp_path):
    modulus = 1e6 * (1.0 + (1j * FREQUENCY) ** 0.3)
    found = fit_relaxation(Moduli(FREQUENCY, modulus.real, modulus.imag))
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
    assert body["body"]["youngs_modulus"] == f"{ {'Pa': '3e+06', 'kPa': '3000', 'MPa': '3'}[unit] } {unit}"
    assert len(body["body"]["relaxation"]) == TIMES.size


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "you gave no number; gfmd allows a text file of three columns"),
        ("1,2,3\n4,5,6\n", "you gave 2 rows of numbers; gfmd allows at least 3 different frequencies"),
        ("1 2\n3 4\n", "you gave 2 columns without names; gfmd allows a text file of three columns"),
        ("1,2,3,4\n1,2,3,4\n", "you gave 4 columns without names; gfmd allows a text file of three columns"),
        ("# a\n1,2,3\n\n1,2,-3\n", "you gave 1 2 -3 in line 4; gfmd allows numbers above 0 in column 1, column 2"),
        ("1,2,3\n1,2,x\n", "you gave 'x' in line 2, not a number (what is missing is an empty cell, or nan); gfmd"),
        ("f [Hz], E' [bar*s], E''\n1,2,3\n", "you gave the unit 'bar*s' in \"E' [bar*s]\"; gfmd allows a pressure in"),
        ("f [1/s], E', E''\n1,2,3\n", "you gave 'f [1/s]' in 1/s; gfmd allows a frequency in Hz, or an angular"),
        ("omega [Hz], E', E''\n1,2,3\n", "you gave 'omega [Hz]' in Hz; gfmd allows a frequency in Hz, or an angular"),
        ("f, G', G''\n1,2,3\n", 'you gave moduli of shear, "G\'"; gfmd allows those with the option --poissons-ratio'),
        ("f, E', G'\n1,2,3\n", 'you gave 2 columns of the storage modulus: "E\'", "G\'"; gfmd allows'),
        ("storage modulus, T, f\n1,2,3\n", "you gave 3 columns named 'storage modulus', 'T', 'f'; gfmd allows"),
        ("T frequency storage loss\n1 2 3\n", "you gave 3 columns of numbers under the header 'T frequency storage"),
    ],
)
def test_tables_that_are_none_are_refused(tmp_path, text, said):
    (tmp_path / "dma.csv").write_text(text)
    with pytest.raises(InputError) as refused:
        fit_relaxation(read_table(tmp_path / "dma.csv", "Pa"))
    assert str(refused.value).startswith(f"{tmp_path / 'dma.csv'}: ")
    assert said in str(refused.value)


def rows(separator, *columns, decimal="."):
    """Lines of columns of numbers."""
    return "\n".join(
        separator.join(f"{each:.12g}".replace(".", decimal) for each in row) for row in zip(*columns, strict=True)
    )


F = np.array([10.0, 0.1, 1.0])
STORAGE, LOSS, T = np.array([6.2, 3.0, 4.1]), np.array([1.9, 0.5, 1.2]), np.array([23.0, 23.1, 23.2])
W, TAN, PSI = 2.0 * np.pi * F, LOSS / STORAGE, 6894.757293168361
TABLES = {
    "German": "Probe;NR\nTemperatur [°C];Frequenz [Hz];E' [MPa];E'' [MPa];tan d [-]\n"
    + rows(";", T, F, STORAGE, LOSS, TAN, decimal=","),
    "units in a line of their own": "[step]\nAngular frequency\tStorage modulus\tLoss modulus\tTan(delta)\n"
    "rad/s\tPa\tPa\t\n" + rows("\t", W, 1e6 * STORAGE, 1e6 * LOSS, TAN),
    "cells without a unit": "Point No.;Angular Frequency;Storage Modulus;Loss Modulus;Complex Viscosity\n"
    ";[1/s];[kPa];[kPa];[Pa·s]\n" + rows(";", T, W, 1e3 * STORAGE, 1e3 * LOSS, T),
    "tan delta and slashes": "tan δ; f/Hz; E′/MPa\n" + rows(";", TAN, F, STORAGE),
    "other columns in units of length": "Freq_Hz,E_storage_MPa,E_loss_Pa,Gap (mm),Displacement (um)\n"
    + rows(",", F, STORAGE, 1e6 * LOSS, T, T),
    "quoted names": '"omega, rad/s","E"" [psi]","E\' [GPa]"\n' + rows(",", W, 1e6 / PSI * LOSS, 1e-3 * STORAGE),
    "blanks": "temperature (C) frequency (Hz) loss modulus (MPa) storage modulus (MPa)\n"
    + rows(" ", T, F, LOSS, STORAGE),
    "units alone": "# kHz, N/mm², MPa\n" + rows(", ", 1e-3 * F, STORAGE, LOSS),
    "both frequencies": "ω in rad/s\tf in Hz\tE1 in MPa\tE2 in MPa\n" + rows("\t", T, F, STORAGE, LOSS),
}


@pytest.mark.parametrize("name", TABLES)
def test_the_header_says_what_columns_hold_and_their_units(tmp_path, name):
    (tmp_path / "dma.csv").write_text(TABLES[name], encoding="utf-8")
    found = read_table(tmp_path / "dma.csv")
    order = np.argsort(F)
    np.testing.assert_allclose(found[:3], [F[order], 1e6 * STORAGE[order], 1e6 * LOSS[order]], rtol=1e-10)


def test_moduli_of_shear_become_those_of_tension(tmp_path):
    (tmp_path / "dma.csv").write_text("f; G' (MPa); G'' (MPa)\n" + rows(";", F, STORAGE, LOSS))
    found = read_table(tmp_path / "dma.csv", poissons_ratio=0.4)
    np.testing.assert_allclose(found.storage, 2.8e6 * np.sort(STORAGE), rtol=1e-12)
    np.testing.assert_allclose(found.loss, 2.8e6 * np.sort(LOSS), rtol=1e-12)
    assert "E = 2 (1 + nu) G with nu = 0.4" in found.read


@pytest.mark.parametrize("text", ["", "f, storage, loss\n"])
def test_a_unit_is_never_guessed_and_contradicts_no_header(tmp_path, text):
    (tmp_path / "dma.csv").write_text(text + rows(",", F, STORAGE, LOSS))
    with pytest.raises(InputError, match=r"dma.csv: you gave no unit of moduli; gfmd allows one in the header"):
        read_table(tmp_path / "dma.csv")
    (tmp_path / "dma.csv").write_text("Hz,MPa,MPa\n" + rows(",", F, STORAGE, LOSS))
    assert read_table(tmp_path / "dma.csv", "N/mm^2").unit == "MPa"
    with pytest.raises(InputError, match=r"unit: you gave 'Pa'; gfmd allows the unit of .*dma.csv, MPa, or none"):
        read_table(tmp_path / "dma.csv", "Pa")


def test_a_body_can_be_pasted_into_a_scene(tmp_path):
    (tmp_path / "g.csv").write_text("f; G' (psi); G'' (psi)\n" + rows(";", F, STORAGE, LOSS))
    done = gfmd("relaxation", tmp_path / "g.csv", "--poissons-ratio", "0.5")
    assert done.exit_code == 0, done.output
    rest = "  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.1}\n  interface: {hard_wall: {}}\n"
    rest += "  loading: {reduced_pressure: 0.1}\ndiscretisation: {eps_c: 0.25, eps_f: 0.25, eps_t: 0.5}\n"
    (tmp_path / "scene.yaml").write_text(f"scene:\n{done.stdout}{rest}")
    body = load_scene(tmp_path / "scene.yaml")[0].scene.body
    found = fit_relaxation(read_table(tmp_path / "g.csv", poissons_ratio=0.5))
    assert body.youngs_modulus == pytest.approx(found.youngs_modulus, rel=1e-5)
    assert body.poissons_ratio == 0.5
    assert [branch.time for branch in body.relaxation] == pytest.approx(found.series.times, rel=1e-5)


def test_swapped_columns_and_bad_fits_are_told_with_their_line(tmp_path):
    modulus = 3e6 * PronySeries(tuple(np.ones(TIMES.size)), tuple(TIMES)).complex_modulus(2.0 * np.pi * FREQUENCY)
    table(tmp_path / "good.csv", np.ones(TIMES.size))
    (tmp_path / "swapped.csv").write_text("f, E' (Pa), E'' (Pa)\n" + rows(",", FREQUENCY, modulus.imag, modulus.real))
    (tmp_path / "bad.csv").write_text("f, E' (Pa), E'' (Pa)\n" + rows(",", F, STORAGE, STORAGE * [0.1, 0.1, 1e-3]))
    for name, told in {
        "good": (),
        "swapped": ("the loss modulus is", "falls with the frequency", "did you swap the columns"),
        "bad": ("bad.csv: the branches are off by", "most by", "6.2 Pa at 10 Hz (line 2)"),
    }.items():
        said = unfolded(gfmd("relaxation", tmp_path / f"{name}.csv").stderr)
        assert all(each in said for each in told), said
        assert told or not said


def test_decimal_commas_are_read(tmp_path):
    (tmp_path / "dma.csv").write_text("f [Hz];E1 [MPa];E2 [MPa]\n10;6,2;1,9\n0,1;3,0;0,5\n1;4,1;1,2\n")
    found = read_table(tmp_path / "dma.csv", "MPa")
    np.testing.assert_allclose(found[:3], [[0.1, 1, 10], [3e6, 4.1e6, 6.2e6], [5e5, 1.2e6, 1.9e6]], rtol=1e-12)


def test_a_liquid_has_no_relaxed_modulus():
    liquid = 1e6 * PronySeries((1.0,), (TIMES[6],)).lags(2.0 * np.pi * FREQUENCY)[0]
    with pytest.raises(InputError, match=r"a storage modulus that still falls at 0.01 Hz"):
        fit_relaxation(Moduli(FREQUENCY, liquid.real, liquid.imag))


def test_a_unit_of_another_quantity_is_refused(tmp_path):
    table(tmp_path / "dma.csv", np.ones(TIMES.size))
    with pytest.raises(InputError, match="unit: you gave 'mm'; gfmd allows a unit of pressure"):
        read_table(tmp_path / "dma.csv", "mm")
