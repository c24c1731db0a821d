"""Engineering units and reduced units of one problem share its identity, and the very bits of its results."""

from decimal import Decimal

import numpy as np
import pytest

from gfmd_numba.campaign.plan import plan
from gfmd_numba.contact.contact_input import read_contact
from gfmd_numba.contact.load_path import solve_path
from gfmd_numba.scene import load_scene
from gfmd_numba.scene.surfaces import Correlated
from gfmd_numba.scene.units import in_reduced_units, rounded

PERIOD, GRADIENT = 2e-4, 0.03  # m; of which no inverse is short
YOUNG, NU = 7e10, 0.33
MODULUS = YOUNG / (1 - NU**2)
GRID = {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1 / 2}
UNITS = {
    "length": ("um", 1e-6, PERIOD),
    "energy": ("mJ/m^2", 1e-3, PERIOD * MODULUS),
    "pressure": ("MPa", 1e6, MODULUS * GRADIENT),
    "line_load": ("N/mm", 1e3, MODULUS * GRADIENT * PERIOD),
    "force": ("mN", 1e-3, MODULUS * GRADIENT * PERIOD**2),
}
ULPS = 1e-15  # by which a conversion with other roundings may differ
WRITTEN = ("with units", "plain", "reduced")


class Number:
    """A number of a kind, in the unit that it is written in."""

    def __init__(self, kind, text):
        self.kind, self.text = kind, text

    def written(self, how):
        unit, factor, scale = UNITS[self.kind]
        si = float(Decimal(self.text) * Decimal(f"{factor:g}"))
        return {"with units": f"{self.text} {unit}", "plain": si, "reduced": si / scale * (1.0 + ULPS)}[how]


def um(text):
    return Number("length", text)


PSD = {"method": "psd", "hurst": 0.8, "rms_gradient": GRADIENT}
SLAB = {"body": {"poissons_ratio": NU, "aspect_ratio": 0.3}}
LAW = {"hard_wall": {}, "exponential": {"work_of_adhesion": Number("energy", "1.7"), "range": um("30.1")}}
COHESIVE = {
    "cohesive": {"work_of_adhesion": Number("energy", "930"), "normal_length": um("21"), "tangential_length": um("33")}
}
OWN = {"method": "psd", "hurst": 0.8, "points": 32}
CORRELATED = {"method": "psd", "model": "k_correlation", "hurst": 0.7, "correlation_length": um("17.3")}
TILTED = {"method": "psd", "model": "length_anisotropy", "hurst": 0.7}
LENGTHS = {"correlation_length_x": um("17.3"), "correlation_length_y": um("23.9")}
PRESSED = {"loading": {"pressure": Number("pressure", "50")}}
SCENES = {
    "pressure": {},
    "line load": {"loading": {"line_load": Number("line_load", "7")}},
    "map": {"dimension": 2},
    "force on a map": {"dimension": 2, "loading": {"force": Number("force", "1300")}},
    "law": {"interface": LAW},
    "cohesive law": {"interface": COHESIVE} | SLAB,
    "slab": SLAB,
    "displacement": SLAB | {"loading": {"displacement": um("0.7")}},
    "own wavelengths": {"roughness": OWN | {"rms_gradient": GRADIENT, "cut_on": um("15.1"), "roll_off": um("99.7")}},
    "own height": {"roughness": PSD | {"rms_gradient": None, "rms_height": um("0.77")}, **SLAB}
    | {"loading": {"displacement": um("0.7")}},
    "correlated": {"roughness": CORRELATED | {"points": 32, "rms_gradient": GRADIENT, "mound_separation": um("37.7")}},
    "two lengths": {"dimension": 2, "roughness": TILTED | LENGTHS | {"points": 16, "rms_gradient": GRADIENT}},
    "recursive": {
        "roughness": OWN
        | {"method": "midpoint_displacement", "rms_gradient": GRADIENT, "cut_on": um("15.1"), "roll_off": um("99.7")}
    },
}
PATHS = {
    "pressure": [{"pressure": Number("pressure", "61")}, {"pressure": Number("pressure", "43")}],
    "cohesive law": [{"sliding": um("0.13")}],
    "displacement": [{"displacement": um("0.9")}],
}


def written(part, how):
    """A part of a description in units, in plain SI, or in L_x, E* and g E*."""
    if isinstance(part, Number):
        return part.written(how)
    if isinstance(part, dict):
        found = {name: written(value, how) for name, value in part.items() if value is not None}
        load = next((name for name in ("pressure", "line_load", "force") if name in found), None)
        if how == "reduced" and load is not None:
            found["reduced_pressure"] = found.pop(load)
        return found
    return [written(each, how) for each in part] if isinstance(part, list) else part


def described(name, how):
    base = {"body": {"poissons_ratio": NU}, "roughness": PSD, "interface": {"hard_wall": {}}} | PRESSED
    scene = written(base | SCENES[name], how)
    if how != "reduced":
        scene["length"] = "200 um" if how == "with units" else PERIOD
        scene["body"] = scene["body"] | {"youngs_modulus": "70 GPa" if how == "with units" else YOUNG}
    grid = {} if "points" in scene["roughness"] else {"discretisation": GRID}
    return {"scene": scene, "seed": 3, "path": written(PATHS.get(name, []), how), **grid}


def reduced_results(file):
    """Identities of the problems of a scene, and their dimensionless results."""
    problem, _ = read_contact(*load_scene(file)).reduced
    solved = list(solve_path(problem, 0))
    fields = [np.stack([each.heights[0], each.equilibrium.pressure[0]]) for each in solved]
    return [each.identity for each in problem.at_each_load], problem.path, fields


@pytest.mark.parametrize("name", SCENES)
def test_one_problem_has_one_identity_and_one_result_in_all_units(name):
    found = {how: reduced_results(described(name, how)) for how in WRITTEN}
    identities, path, fields = found["plain"]
    assert max(np.abs(field[1]).max() for field in fields) > 0.0
    for how in ("with units", "reduced"):
        assert found[how][0] == identities, how
        assert found[how][1] == path, how
        assert all(np.array_equal(one, other) for one, other in zip(found[how][2], fields, strict=True)), how


def test_all_lengths_of_a_spectrum_count():
    """What is divided is told by the types of the fields: one that says nothing would keep its metres."""
    lengths = {name for name in Correlated.model_fields if name.endswith(("length", "separation", "cut_on", "height"))}
    record = Correlated(
        method="psd",
        model="k_correlation",
        hurst=0.5,
        points=16,
        correlation_length=2.0,
        mound_separation=6.0,
        cut_on=1.0,
        rms_height=0.1,
    )
    reduced = in_reduced_units(record, 2.0, 1.0)
    assert all(getattr(reduced, name) == getattr(record, name) / 2 for name in lengths)
    assert len(lengths) == 4


@pytest.mark.parametrize("value", [0.007, 1e-4, 1 / 64, 123456.789012, -3e-30, 5e29, 0.0])
def test_short_decimals_keep_their_bits(value):
    assert rounded(value) == value


@pytest.mark.parametrize("value", [1 / 3, 2 / 3 * 1e-7, 0.1 + 0.2])
def test_rounding_keeps_twelve_digits(value):
    assert rounded(value) == pytest.approx(value, rel=1e-11)
    assert rounded(value) == rounded(np.nextafter(value, 1.0)) != value


def test_cases_of_a_campaign_share_problems_across_units():
    def campaign(how):
        scene = described("law", how)["scene"]
        grid = {"work_of_adhesion": [Number("energy", "1.7"), Number("energy", "2.3")]}
        loads = {"pressure": [Number("pressure", "50"), Number("pressure", "20")]}
        loads = (
            written(loads, how) if how != "reduced" else {"reduced_pressure": written(loads, how)["reduced_pressure"]}
        )
        parts = {"name": "n", "seed": 3, "realisations": 1, "scene": scene, "reference": GRID}
        return plan(parts | {"grid": written(grid, how) | loads})

    found = {how: {problem.identity for problem in campaign(how).problems} for how in WRITTEN}
    assert len(found["plain"]) == 4
    assert found["with units"] == found["reduced"] == found["plain"]
