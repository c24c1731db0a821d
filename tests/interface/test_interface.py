"""The law of the gap: consistent derivatives, balance of forces, and both branches of an adhesive contact."""

from itertools import pairwise

import numpy as np
import pytest
from scipy import integrate

import gfmd_numba
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.interface.maugis_dugdale import MaugisDugdaleLaw
from gfmd_numba.interface.power_laws import LennardJonesLaw, ShiftedPowerLaw
from gfmd_numba.interface.squared_exponential import SquaredExponentialLaw
from gfmd_numba.scene import InputError
from gfmd_numba.scene.interface_records import (
    Exponential,
    LennardJones,
    MaugisDugdale,
    PowerLawOfTheGap,
    SquaredExponential,
)
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.table import Options
from support.laws import nearly_flat, surface

ASKED = {"work_of_adhesion": 0.3, "range": 0.2}
LAWS = {
    "attraction": ExponentialLaw(0.3, 0.2),
    "repulsion": ExponentialLaw(-0.3, 0.2),
    "squared": SquaredExponentialLaw(0.3, 0.2),
    "maugis": MaugisDugdaleLaw(0.3, 0.2, 0.2),
    "lennard-jones": LennardJonesLaw.of(LennardJones(**ASKED)),
    "van der waals": ShiftedPowerLaw.of(PowerLawOfTheGap(**ASKED)),
    "power repulsion": ShiftedPowerLaw.of(PowerLawOfTheGap(work_of_adhesion=-0.3, range=0.2, exponent=3.5)),
}
of_each_law = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)


@of_each_law
def test_traction_and_stiffness_are_derivatives_of_the_energy(law):
    gap, h = np.linspace(-0.1, 0.97, 12), 1e-6
    # the gap shrinks as the body moves towards the punch
    np.testing.assert_allclose(law.traction(gap), (law.energy(gap + h) - law.energy(gap - h)) / (2 * h), rtol=1e-8)
    np.testing.assert_allclose(
        law.stiffness(gap), (law.traction(gap + h) - law.traction(gap - h)) / (2 * h), 1e-8, 1e-9
    )
    fine = np.linspace(0.0, 1.0, 5001)
    worst = law.stiffness(fine).max()
    assert law.stiffest(np.inf, hard_wall=True) == pytest.approx(max(worst, 0.0))
    assert law.softening == pytest.approx(max(-law.stiffness(fine).min(), 0.0), rel=1e-6)
    most, least = law.traction(fine).max(), law.traction(fine).min()
    assert law.strength == pytest.approx(most if most > 0.0 else least, rel=1e-6)
    assert (law.reach > 0.0) == (most > 0.0)


@of_each_law
def test_the_energy_is_the_work_of_the_traction_from_far_away(law):
    for gap in (-0.05, 0.0, 0.11, 0.2, 0.31, 2.0):
        kinks = (0.1, 0.18, 0.22)  # of a range of 0.2
        work = sum(
            integrate.quad(lambda apart: law.traction(np.array(apart)), first, last, epsabs=0, epsrel=1e-12)[0]
            for first, last in pairwise(sorted({gap, *(each for each in kinks if each > gap), np.inf}))
        )
        assert law.energy(np.array(gap)) == pytest.approx(-work, rel=1e-9)


def test_depths_and_strengths_of_laws_are_those_of_the_literature():
    """Of Johnson and Greenwood (1997), Maugis (1992), and van der Waals forces A / (12 pi z^2) cut off at 0.2."""
    assert LAWS["lennard-jones"].energy(np.array(0.2)) == pytest.approx(-0.3)
    assert LAWS["lennard-jones"].strength == pytest.approx(16.0 / (9.0 * 3.0**0.5) * 0.3 / 0.2)
    assert LAWS["maugis"].traction(np.array([0.0, 0.17])) == pytest.approx(0.3 / 0.2)
    hamaker = 12.0 * np.pi * 0.2**2 * 0.3
    assert LAWS["van der waals"].traction(np.array(0.5)) == pytest.approx(hamaker / (6.0 * np.pi * 0.7**3))


@pytest.mark.parametrize("name", ["attraction", "repulsion", "squared", "maugis", "van der waals", "power repulsion"])
def test_the_record_of_a_law_knows_what_it_pulls_at_no_gap(name):
    law = LAWS[name]
    work = abs(law.work if hasattr(law, "work") else law.works[0])
    record = {
        "squared": SquaredExponential(**ASKED),
        "maugis": MaugisDugdale(**ASKED),
        "van der waals": PowerLawOfTheGap(**ASKED),
        "power repulsion": PowerLawOfTheGap(**ASKED, exponent=3.5),
    }.get(name, Exponential(**ASKED))
    assert record.pull * work / law.length == pytest.approx(abs(float(law.traction(np.zeros(1))[0])))


@pytest.mark.filterwarnings("error")
def test_the_pole_of_a_law_is_cut_off_where_its_record_says():
    for law, record in ((LennardJonesLaw, LennardJones), (ShiftedPowerLaw, PowerLawOfTheGap)):
        found, kink = law.of(record(work_of_adhesion=0.3, range=0.2)), 0.2 * record.known_from
        inside, outside = found.stiffness(np.array([kink - 1e-3, kink + 1e-3]))
        assert inside == found.stiffness(np.array(kink - 0.05)) != outside
        assert found.stiffness(np.array(kink + 1e-12)) == pytest.approx(inside)


def test_a_pressure_bounds_how_stiff_a_law_gets():
    law, gap = (
        LennardJonesLaw.of(LennardJones(work_of_adhesion=0.3, range=0.2)),
        np.linspace(0.1, 0.4, 300001),
    )
    bears = -law.traction(gap) <= 5.0
    assert law.stiffest(5.0, hard_wall=False) == pytest.approx(law.stiffness(gap)[bears].max(), rel=1e-3)


def test_a_law_reaches_over_its_range_if_it_attracts():
    asked = {"work_of_adhesion": 0.3, "range": 0.2}
    assert ShiftedPowerLaw.of(PowerLawOfTheGap(**asked | {"work_of_adhesion": -0.3})).reach == 0.0
    assert MaugisDugdaleLaw(0.3, 0.2, 0.2).reach == LennardJonesLaw.of(LennardJones(**asked)).reach == 0.2


@of_each_law
def test_the_change_of_energy_is_that_of_the_energy_near_and_far(law):
    gap = np.array([0.0, 0.5, 0.5, 0.5, 0.21, 400.0, 400.0, 1e3, 0.3, -0.1, -0.15, 0.05])
    closing = np.array([-0.2, 0.0, 0.3, -0.3, 1e-14, 400.0, 399.5, -1e3, 0.4, -0.4, 0.05, -0.01])
    expected = law.energy(gap - closing) - law.energy(gap)
    found, whole = law.energy_change(gap, closing), closing != 1e-14
    np.testing.assert_allclose(found[whole], expected[whole], rtol=1e-11)
    assert found[4] == pytest.approx(-law.traction(gap[4]) * 1e-14, rel=1e-9)


@pytest.mark.parametrize("solver", ["verlet", "gronbech_jensen", "fire"])
@pytest.mark.parametrize(
    "interface",
    [
        Interactions(True, ExponentialLaw(0.002, 0.01)),
        Interactions(True, ExponentialLaw(-0.002, 0.01)),
        Interactions(False, ExponentialLaw(-0.002, 0.01)),
    ],
    ids=["adhesive", "repulsive wall", "repulsive"],
)
def test_forces_balance_under_a_law(interface, solver):
    punch, body = surface()
    load = 0.05
    result = equilibrate(punch, SpectralResponse.of_normal(body), load, Options(solver), interface)
    assert (result.status == 0).all()
    restoring = grid.signal(body * grid.coefficients(result.displacement), punch.shape[1])
    law = interface.normal_law.traction(punch - result.displacement)
    wall = result.pressure + law
    np.testing.assert_allclose(load - restoring + law - wall, 0.0, atol=2e-8)
    assert (wall >= -1e-12).all()
    np.testing.assert_allclose(result.pressure.mean(axis=1), load, atol=1e-8)
    assert (result.touching == (wall > 1e-9)).all()
    assert result.touching.any() == interface.hard_wall


def test_attraction_enlarges_and_repulsion_shrinks_the_contact():
    punch, body = surface()
    areas = [
        equilibrate(
            punch, SpectralResponse.of_normal(body), 0.05, Options("verlet"), Interactions(True, law)
        ).touching.sum(axis=1)
        for law in (ExponentialLaw(-0.002, 0.01), None, ExponentialLaw(0.002, 0.01))
    ]
    assert (areas[0] < areas[1]).all()
    assert (areas[1] < areas[2]).all()


def test_a_short_repulsion_is_a_hard_wall():
    punch, body = surface(256)
    hard = equilibrate(punch, SpectralResponse.of_normal(body), 0.05, Options("verlet")).pressure
    errors = []
    for length in (1e-2, 1e-3):
        soft = equilibrate(
            punch,
            SpectralResponse.of_normal(body),
            0.05,
            Options("verlet"),
            Interactions(False, ExponentialLaw(-length, length)),
        )
        assert (soft.status == 0).all()
        errors.append(np.sqrt(((soft.pressure - hard) ** 2).mean()))
    assert errors[1] < errors[0] / 2


def test_weak_adhesion_has_one_branch(tmp_path):
    law = {"work_of_adhesion": 0.02, "range": 0.05}
    down = np.arange(-0.2, 0.02, 0.06)
    path = np.concatenate([down, down[::-1]])
    result = nearly_flat(tmp_path, path[1:].tolist(), path[0], hard_wall={}, exponential=law)
    forces = result["mean_pressure"].values
    np.testing.assert_allclose(forces[: len(down)], forces[len(down) :][::-1], atol=1e-7 * abs(forces).max())


SCENE = """\
scene:
  length: 1e-4
  body: {youngs_modulus: 1e9, poissons_ratio: 0.3, aspect_ratio: 1}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.05}
discretisation: {eps_c: 1/4, eps_f: 1/16, eps_t: 1/2}
numerics: {solver: auto}
path: []
"""


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "{hard_wall: {}}",
            "{hard_wall: {}, exponential: {work_of_adhesion: 0.1, range: 1e-9}}",
            "5:74: scene.interface.exponential.range: you gave 1e-09; gfmd allows at least 4.76e-09 on this grid",
        ),
        (
            "{hard_wall: {}}",
            "{exponential: {work_of_adhesion: 0.1, range: 1e-6}}",
            "5:14: scene.interface: you gave {'exponential': {'range': 1e-06, 'work_of_adhesion': 0.1}}; "
            "gfmd allows hard_wall: {}, cohesive, lennard_jones, or an exponential or power law that repels",
        ),
        (
            "{hard_wall: {}}",
            "{hard_wall: {}, exponential: {work_of_adhesion: 0, range: 1e-6}}",
            "5:62: scene.interface.exponential.work_of_adhesion: you gave 0; gfmd allows a number other than 0",
        ),
        (
            "{hard_wall: {}}",
            "{hard_wall: {}, "
            "cohesive: {work_of_adhesion: 1, normal_length: 1, tangential_length: 1}, friction: {coefficient: 1}}",
            "5:113: scene.interface.friction: you gave {'coefficient': 1}; gfmd allows one law of normal and "
            "tangential",
        ),
        (
            "{hard_wall: {}}",
            "{hard_wall: {}, friction: {coefficient: -1}}",
            "5:54: scene.interface.friction.coefficient: you gave -1; gfmd allows a number above 0, or .inf for "
            "sticking",
        ),
        (
            "solver: auto",
            "solver: verlet, time_step: 1.01",
            "8:39: numerics.time_step: you gave 1.01; gfmd allows a number from 1e-6 to 1, as more is above the "
            "stability limit",
        ),
        (
            "path: []",
            "path: [{displacement: 1e-7}]",
            "9:23: path[0].displacement: you gave 1e-07; gfmd allows what the loading prescribes, which is "
            "reduced_pressure",
        ),
        (
            "path: []",
            "path: [{sliding: 1e-7}]",
            "9:18: path[0].sliding: you gave 1e-07; gfmd allows nothing without friction, a cohesive law or wear",
        ),
        (
            "path: []",
            "path: [{reduced_pressure: -0.1}]",
            "9:27: path[0].reduced_pressure: you gave -0.1; gfmd allows a load above 0",
        ),
        (
            "{reduced_pressure: 0.05}",
            "{displacement: -1e-7}",
            "6:27: scene.loading.displacement: you gave -1e-07; gfmd allows a finite number of at least 0, as "
            "nothing acts",
        ),
    ],
)
def test_laws_that_make_no_sense_are_refused_where_they_stand(tmp_path, old, new, message):
    path = tmp_path / "scene.yaml"
    assert SCENE.count(old) == 1
    path.write_text(SCENE)
    gfmd_numba.solve(path)
    path.write_text(SCENE.replace(old, new))
    with pytest.raises(InputError) as error:
        gfmd_numba.solve(path)
    assert str(error.value).startswith(f"{path}:{message}")


@pytest.mark.parametrize("solver", ["conjugate_gradients", "active_set_newton"])
@pytest.mark.parametrize("interface", ["exponential: {work_of_adhesion: 1, range: 1e-6}", "friction: {coefficient: 1}"])
def test_solvers_for_the_pressure_know_the_hard_wall_only(tmp_path, interface, solver):
    path = tmp_path / "scene.yaml"
    text = SCENE.replace("hard_wall: {}", f"hard_wall: {{}}, {interface}")
    path.write_text(text.replace("solver: auto", f"solver: {solver}"))
    with pytest.raises(InputError, match=f"numerics.solver: you gave '{solver}'; gfmd allows "):
        gfmd_numba.solve(path)


def test_surfaces_closer_than_a_law_is_known_are_told(tmp_path):
    law = {"work_of_adhesion": 1e-6, "range": 0.02}
    found = nearly_flat(tmp_path, [], -0.02, lennard_jones=law)
    assert "range" not in found.attrs["validity"]
    with pytest.warns(UserWarning, match="as close as .* times the range of the Lennard-Jones law"):
        nearly_flat(tmp_path, [], 0.0, lennard_jones=law)


@pytest.mark.filterwarnings("ignore:100% of the energy")
def test_a_flat_punch_is_pulled_by_the_squared_exponential_law_at_its_gap(tmp_path):
    law, first, nu = SquaredExponentialLaw(1e-5, 0.02), -0.03, 0.3
    asked = {"work_of_adhesion": law.work, "range": law.length}
    found = nearly_flat(tmp_path, [-0.01, -0.05], first, hard_wall={}, squared_exponential=asked)
    assert (found["status"] == 0).all()
    gap, pressure = found["gap"].mean("x").values, found["mean_pressure"].values
    np.testing.assert_allclose(pressure, -law.traction(gap), rtol=1e-6)
    stiffness = (1.0 - nu) ** 2 / (1.0 - 2.0 * nu) / 0.1
    np.testing.assert_allclose(gap, [0.03, 0.01, 0.05] + pressure / stiffness, rtol=1e-6)
