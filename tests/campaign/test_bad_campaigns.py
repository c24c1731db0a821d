"""Campaign files with one fault: names, realisations, axes and discretisations."""

import pytest

from gfmd_numba.campaign.file import load_campaign
from support.faulty_files import CAMPAIGN, WHOLE, assert_complaint, changed, complaint

CAMPAIGNS = {
    "name": (
        ("name: chapter4", "name: ../etc"),
        "bad.yaml:1:7: name: you gave '../etc'; gfmd allows up to 100 letters, digits, '.', '_' and '-', not starting",
    ),
    "long name": (
        ("name: chapter4", "name: " + 101 * "a"),
        "bad.yaml:1:7: name: you gave 'aaaa",
    ),
    "empty name": (
        ("name: chapter4", "name: ''"),
        "bad.yaml:1:7: name: you gave ''; gfmd allows up to 100 letters",
    ),
    "no realisations": (
        ("realisations: 30", "realisations: 0"),
        "bad.yaml:3:15: realisations: you gave 0; gfmd allows a whole number from 1 to 1000000, or a mapping of such",
    ),
    "realisations for fewer levels than there are": (
        ("realisations: 30", "realisations: {reference: 30, eps_t: [3, 2]}"),
        "bad.yaml:3:38: realisations.eps_t: you gave [3, 2]; gfmd allows 3 numbers, as limits.eps_t has so many levels",
    ),
    "realisations of an unknown limit": (
        ("realisations: 30", "realisations: {reference: 30, eps_x: 3}"),
        "bad.yaml:3:31: realisations.eps_x: you gave an unknown key; gfmd allows one of 'reference', 'eps_c', "
        "'eps_f', ",
    ),
    "realisations of no reference": (
        ("realisations: 30", "realisations: {eps_c: 3}"),
        "bad.yaml:3:1: realisations.reference: you gave nothing; gfmd needs a whole number from 1 to 1000000",
    ),
    "a body without a punch": (
        (CAMPAIGN[CAMPAIGN.index("  roughness:") : CAMPAIGN.index("reference:")], "  boundary: {normal_traction: 0}\n"),
        "bad.yaml:4:1: scene.loading: you gave nothing; gfmd needs a loading, and an interface, as campaigns are of",
    ),
    "key of another level": (
        ("seed: 2018", "seed: 2018\nlength: 1e-6"),
        "bad.yaml:3:1: length: you gave an unknown key; gfmd allows one of 'name', 'seed', "
        "'realisations', 'scene', "
        "'reference', 'limits', 'grid', 'levels', 'numerics', 'path', 'fit', 'target', 'case_timeout'; "
        "'length' belongs to scene",
    ),
    "key of several levels": (
        ("seed: 2018", "seed: 2018\neps_c: 1"),
        "bad.yaml:3:1: eps_c: you gave an unknown key; gfmd allows one of 'name', 'seed', 'realisations', 'scene', "
        "'reference', 'limits', 'grid', 'levels', 'numerics', 'path', 'fit', 'target', 'case_timeout'; "
        "'eps_c' belongs to realisations or reference or limits or grid or fit.fixed",
    ),
    "unknown axis": (
        ("grid: {hurst", "grid: {hurts"),
        "bad.yaml:11:8: grid.hurts: you gave an unknown key; gfmd allows one of 'file', 'hurst', ",
    ),
    "axis that is no list": (
        ("[0.3, 0.5]", "0.3"),
        "bad.yaml:11:15: grid.hurst: you gave 0.3; gfmd allows a list of one or more numbers from 0 to 1",
    ),
    "empty axis": (
        ("[0.3, 0.5]", "[]"),
        "bad.yaml:11:15: grid.hurst: you gave []; gfmd allows a list of one or more numbers from 0 to 1",
    ),
    "bad value on an axis": (
        ("[0.3, 0.5]", "[0.3, 1.5]"),
        "bad.yaml:11:21: grid.hurst[1]: you gave 1.5; gfmd allows a number from 0 to 1",
    ),
    "repeated value": (
        ("[1, 1/2, 1/4]", "[1, 1/2, 0.5]"),
        "bad.yaml:10:43: limits.eps_t[2]: you gave 0.5; gfmd allows each value once",
    ),
    "eps above 1": (
        ("eps_c: [1, 1/2]", "eps_c: [2, 1/2]"),
        "bad.yaml:10:18: limits.eps_c[0]: you gave 2; gfmd allows a number above 0 and at most 1",
    ),
    "axis in limits and grid": (
        ("{hurst: [0.3, 0.5]}", "{eps_c: [1, 1/4]}"),
        "bad.yaml:11:15: grid.eps_c: you gave [1, 0.25]; gfmd allows eps_c in either limits or grid, not in both",
    ),
    "measured profile": (
        ("{method: psd, hurst: 0.8, rms_gradient: 0.01}", "{method: measured, file: steel.npy}"),
        "bad.yaml:2:7: seed: you gave 2018; gfmd allows nothing, as no surface is random",
    ),
    "pressure axis under displacement": (
        (
            "{reduced_pressure: 0.007}\nreference: {eps_c: 1/2, eps_f: 1/1024, eps_t: 1/2}\n"
            "limits: {eps_c: [1, 1/2], eps_t: [1, 1/2, 1/4]}\ngrid: {hurst: [0.3, 0.5]}",
            "{displacement: 0.1}\nreference: {eps_c: 1/2, eps_f: 1/1024, eps_t: 1/2}\ngrid: {reduced_pressure: [0.3]}",
        ),
        "bad.yaml:10:26: grid.reduced_pressure: you gave [0.3]; gfmd allows nothing, as the loading is a displacement",
    ),
    "half-space axis under displacement": (
        (
            "{reduced_pressure: 0.007}\nreference: {eps_c: 1/2, eps_f: 1/1024, eps_t: 1/2}\n"
            "limits: {eps_c: [1, 1/2], eps_t: [1, 1/2, 1/4]}\ngrid: {hurst: [0.3, 0.5]}",
            "{displacement: 0.1}\nreference: {eps_c: 1/2, eps_f: 1/1024, eps_t: 1/2}\ngrid: {aspect_ratio: [1, .inf]}",
        ),
        "bad.yaml:10:26: grid.aspect_ratio[1]: you gave inf; gfmd allows a finite aspect_ratio, periodic "
        "false, or a pressure",
    ),
    "incompressible axis under displacement with verlet": (
        (
            "{reduced_pressure: 0.007}\nreference: {eps_c: 1/2, eps_f: 1/1024, eps_t: 1/2}\n"
            "limits: {eps_c: [1, 1/2], eps_t: [1, 1/2, 1/4]}\ngrid: {hurst: [0.3, "
            "0.5]}\nnumerics: {solver: auto}",
            "{displacement: 0.1}\nreference: {eps_c: 1/2, eps_f: 1/1024, eps_t: 1/2}\n"
            "grid: {poissons_ratio: [0.4, 1/2]}\nnumerics: {solver: verlet}",
        ),
        "bad.yaml:10:30: grid.poissons_ratio[1]: you gave 0.5; gfmd allows a number below 0.5 with solver verlet",
    ),
    "limit that gives no whole waves": (
        ("[1, 1/2, 1/4]", "[1, 1/2, 0.3]"),
        f"bad.yaml:10:43: limits.eps_t[2]: you gave 0.3; gfmd allows {WHOLE}eps_c = 0.5 and eps_f = 0.000976562; "
        "did you mean 1/3?",
    ),
    "reference that gives no whole waves": (
        ("eps_f: 1/1024", "eps_f: 0.3"),
        f"bad.yaml:9:32: reference.eps_f: you gave 0.3; gfmd allows {WHOLE}eps_c = 0.5 and eps_t = 0.5; did you mean "
        "2/7?",
    ),
    "limit at odds with the reference": (
        ("eps_f: 1/1024", "eps_f: 2/3"),
        f"bad.yaml:10:35: limits.eps_t[0]: you gave 1; gfmd allows {WHOLE}eps_c = 0.5 and eps_f = 0.666667; "
        "did you mean 1/2?",
    ),
    "grid that gives no whole waves": (
        ("grid: {hurst: [0.3, 0.5]}", "grid: {eps_f: [1/64, 0.3]}"),
        f"bad.yaml:11:22: grid.eps_f[1]: you gave 0.3; gfmd allows {WHOLE}eps_c = 0.5 and eps_t = 0.5; did you mean "
        "2/7?",
    ),
}


@pytest.mark.parametrize("name", CAMPAIGNS)
def test_a_bad_campaign_is_refused_where_it_is_wrong(tmp_path, name):
    assert_complaint(tmp_path, load_campaign, CAMPAIGN, *CAMPAIGNS[name])


def test_too_many_cases_are_refused(tmp_path):
    hundred = [f"{i}/1000" for i in range(1, 101)]
    axes = ", ".join(f"{axis}: [{', '.join(hundred)}]" for axis in ("hurst", "aspect_ratio", "reduced_pressure"))
    message = complaint(tmp_path, load_campaign, changed(CAMPAIGN, "hurst: [0.3, 0.5]", axes))
    assert message.startswith("bad.yaml:11:7: grid: you gave {")
    assert message.endswith("; gfmd allows at most 1000000 cases, not 4000000")


def test_an_axis_by_the_key_of_its_record_is_told_its_name(tmp_path):
    changed = "grid: {hurst", "grid: {coefficient: [0.1], hurst"
    said = assert_complaint(tmp_path, load_campaign, CAMPAIGN, changed, "bad.yaml:11:8: grid.coefficient: you gave an")
    assert said.endswith("'coefficient' belongs to scene.interface.friction; did you mean 'friction_coefficient'?")
