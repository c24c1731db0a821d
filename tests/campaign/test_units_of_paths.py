"""Adhesion and friction of one dimensionless problem: one verdict, one identity and one digest in all units."""

import hashlib
import re

import numpy as np
import pytest
import yaml

import gfmd_numba
from gfmd_numba.campaign.shards import Finished
from gfmd_numba.contact.contact_input import read_contact
from gfmd_numba.contact.observables import OBSERVABLES, PATH_OBSERVABLES
from gfmd_numba.scene import load_scene
from support.cases import some_of
from support.command_line import gfmd, unfolded

NU = 0.3
SYSTEMS = {  # length of the period (m), Young's modulus (Pa), rms gradient
    "reduced": (None, None, 0.03),
    "with units": (2e-4, 7e10, 0.03),
    "large, soft and flat": (30.0, 1.3e4, 0.003),
}
WRITTEN_IN = {"length": ("um", 1e-6), "pressure": ("MPa", 1e6), "energy": ("mJ/m^2", 1e-3)}
EPS = {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1}
RESOLVED, UNRESOLVED, HOPELESS = 0.02, 0.012, 0.002  # ranges in g L_x

pytestmark = pytest.mark.filterwarnings("ignore:.*A number without a unit")  # those of metres and pascals are large
UNCOMMON = re.compile(r"gfmd: \S+ is (?:(?!gfmd:).)*A number without a unit(?:(?!gfmd:).)*")


def number(system, kind, value):
    """A value in g L_x, g E* or g^2 E* L_x, as a system of units writes it."""
    period, young, gradient = SYSTEMS[system]
    height, pressure = gradient * (period or 1.0), gradient * (1.0 if young is None else young / (1 - NU**2))
    found = value * {"length": height, "pressure": pressure, "energy": height * pressure}[kind]
    unit, factor = WRITTEN_IN[kind]
    return f"{found / factor:.16g} {unit}" if system == "with units" else found


def described(system, effect, range_=RESOLVED):
    """Scene, path and grid of an adhesive contact or of one with friction."""
    period, young, gradient = SYSTEMS[system]
    body = {"poissons_ratio": NU, "aspect_ratio": 0.5}
    scene = {"roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": gradient}, "body": body}
    if period is not None:
        scene["length"] = "200 um" if system == "with units" else period
        body["youngs_modulus"] = "70 GPa" if system == "with units" else young
    if effect == "adhesion":
        law = {"work_of_adhesion": number(system, "energy", 5e-3), "range": number(system, "length", range_)}
        depths = [-0.02, 0.04, -0.02, -0.08]
        scene |= {"interface": {"hard_wall": {}, "exponential": law}}
        scene |= {"loading": {"displacement": number(system, "length", -0.06)}}
        path = [{"displacement": number(system, "length", depth)} for depth in depths]
        return scene, path, {"work_of_adhesion": [number(system, "energy", 3e-3)]}
    scene |= {"interface": {"hard_wall": {}, "friction": {"coefficient": 0.2}}}
    load = "reduced_pressure" if system == "reduced" else "pressure"
    loads = [0.05 if system == "reduced" else number(system, "pressure", each) for each in (0.05, 0.08)]
    scene["loading"] = {load: loads[0]}
    slid = [number(system, "length", each) for each in (0.01, 0.03, 0.0)]
    path = [{load: 0.08 if system == "reduced" else loads[1]}, *({"sliding": each} for each in slid)]
    return scene, path, {"friction_coefficient": [0.1]}


def contact(system, effect, range_=RESOLVED):
    scene, path, _ = described(system, effect, range_)
    return {"scene": scene, "path": path, "discretisation": EPS, "seed": 4}


def campaign(system, effect, range_=RESOLVED):
    scene, path, grid = described(system, effect, range_)
    file = {"name": "units", "seed": 4, "realisations": 1, "scene": scene, "reference": EPS}
    return file | {"grid": grid, "path": path}


def digest(folder):
    """Of all that a campaign has measured, without times, by the identities of its problems."""
    finished, found = Finished(folder), hashlib.sha256()
    for name in sorted(finished):
        found.update(name.encode())
        for key, values in sorted(finished.read(name).items()):
            if key not in ("seconds", "wall_time"):
                found.update(key.encode() + values.tobytes())
    return found.hexdigest()


def without_numbers(said):
    """What is said of all systems, without numbers, their units and quotes."""
    said = UNCOMMON.sub("", said)
    return re.sub(r"'?-?\d[\d.e+-]*( [µumn]?m\b| [MGk]?Pa\b| m?J/m\^2)?'?", "0", said)


@pytest.mark.long
@pytest.mark.parametrize("effect", ["adhesion", "friction"])
def test_a_path_has_one_identity_and_one_result(effect):
    found = {}
    for system in SYSTEMS:
        file = contact(system, effect)
        problem, _ = read_contact(*load_scene(file)).reduced
        solved = gfmd_numba.solve(file)
        assert (solved["status"] == 0).all()
        period, young, gradient = SYSTEMS[system]
        height, pressure = gradient * (period or 1.0), gradient * (1.0 if young is None else young / (1 - NU**2))
        scale = {"pressure": pressure, "energy": height * pressure, "height": height, "gradient": gradient, "1": 1.0}
        rows = {name: row.unit for name, row in PATH_OBSERVABLES.items() if name in solved}
        rows |= {name: OBSERVABLES[name].unit for name in ("mean_pressure", "mean_gap", "contact_area_fraction")}
        found[system] = (
            [each.identity for each in (problem, *problem.at_each_load)],
            {name: solved[name].values / scale[unit] for name, unit in rows.items()},
        )
    identities, values = found.pop("reduced")
    for system, (others, numbers) in found.items():
        assert others == identities, system
        assert numbers.keys() == values.keys()
        for name in values:
            np.testing.assert_allclose(numbers[name], values[name], rtol=1e-13, err_msg=f"{system}: {name}")


@pytest.mark.long
@pytest.mark.parametrize("effect", ["adhesion", "friction"])
def test_a_campaign_has_one_digest(effect, tmp_path):
    digests, cases = set(), set()
    for system in SYSTEMS:
        file = campaign(system, effect)
        results = gfmd_numba.run(file | {"path": file["path"][:2]}, tmp_path / system)
        assert (results["status"] == 0).all()
        digests.add(digest(tmp_path / system))
        cases.add(tuple(results["case_id"].values))
    assert len(digests) == 1
    assert len(cases) == 1


@pytest.mark.parametrize(("range_", "code"), some_of([(RESOLVED, 0), (UNRESOLVED, 0), (HOPELESS, 2)], 1, 2))
def test_check_and_plan_come_to_one_verdict_on_a_law(range_, code, tmp_path):
    for kind in (contact, campaign):
        said = set()
        for system in SYSTEMS:
            path = tmp_path / f"{kind.__name__} {system}.yaml"
            path.write_text(yaml.safe_dump(kind(system, "adhesion", range_), sort_keys=False))
            for command in ("check", "plan")[: 1 + (kind is campaign)]:
                done = gfmd(command, path, *(["--pilot=0"] if command == "plan" else []))
                assert done.exit_code == code, done.output
                said.add(without_numbers(unfolded(done.stderr).replace(str(path), "")))
        assert len(said) == 1, said
        assert ("does not resolve" in said.pop()) == (range_ == UNRESOLVED)


@pytest.mark.long
def test_a_campaign_says_the_same_of_a_law_that_it_does_not_resolve(tmp_path):
    said = set()
    for system in SYSTEMS:
        file = {key: value for key, value in campaign(system, "adhesion", UNRESOLVED).items() if key != "path"}
        with pytest.warns(UserWarning, match="does not resolve"):
            results = gfmd_numba.run(file, tmp_path / system)
        said.update(
            line for line in results.attrs["validity"].splitlines() if "does not resolve the interaction" in line
        )
    assert len(said) == 1


def bodies(kind, period, modulus):
    """Two rough bodies, or one of three layers, whose lengths and moduli are multiples of a period and of a modulus."""
    rough = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02}
    if kind == "two bodies":
        lower = {"youngs_modulus": 0.91 * modulus, "poissons_ratio": 0.3, "aspect_ratio": 0.5, "roughness": rough}
        upper = {"youngs_modulus": 2.7 * modulus, "poissons_ratio": 0.1, "aspect_ratio": 0.9, "roughness": rough}
        return {"body": lower, "counter_body": upper}
    parts = ((0.06, 1.3, 0.3), (0.031, 2.5, 0.2), (0.13, 0.9, 0.45))
    layers = [{"height": h * period, "youngs_modulus": e * modulus, "poissons_ratio": nu} for h, e, nu in parts]
    return {"body": {"layers": layers, "base": "rigid"}, "roughness": rough}


@pytest.mark.parametrize("kind", ["two bodies", "layers"])
def test_bodies_have_one_identity_in_all_units(kind):
    identities = set()
    for period, modulus in ((1.0, 1.0), (1e-4, 1e9), (3.7, 2.3e-3), (30.0, 1.3e4)):
        acts = {"interface": {"hard_wall": {}, "friction": {"coefficient": 0.2}}, "loading": {"reduced_pressure": 0.05}}
        scene = {"length": period, **bodies(kind, period, modulus), **acts}
        problem, _ = read_contact(*load_scene({"scene": scene, "discretisation": EPS, "seed": 4})).reduced
        identities.add(problem.identity)
    assert len(identities) == 1
