"""Scenes and campaigns as YAML, mappings and records: what a file says, and that all three ways give the same scene."""

from math import inf, isnan

import numpy as np
import pytest
from pydantic import ValidationError

from gfmd_numba.campaign.file import Campaign, load_campaign
from gfmd_numba.campaign.goal import Fit
from gfmd_numba.scene import Discretisation, InputError, SceneFile, SelfAffine, load_scene, read_document

NESTED = """\
scene:
  body: {youngs_modulus: 70e9, poissons_ratio: 0.33, aspect_ratio: .inf}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 1e-2}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.007}
numerics: {solver: verlet, residual: 1E-6}
discretisation: {eps_c: 1/2, eps_f: 1/64, eps_t: .5}
seed: 7
"""
FLAT = """\
body: {youngs_modulus: 70e9, poissons_ratio: 0.33, aspect_ratio: .inf}
roughness: {method: psd, hurst: 0.8, rms_gradient: 1e-2}
interface: {hard_wall: {}}
loading: {reduced_pressure: 0.007}
numerics: {solver: verlet, residual: 1E-6}
discretisation: {eps_c: 1/2, eps_f: 1/64, eps_t: .5}
seed: 7
"""
MEASURED = """\
body: {poissons_ratio: 0.33, aspect_ratio: 1}
roughness: {method: measured, file: profiles/steel.npy}
interface: {hard_wall: {}}
loading: {displacement: 0.01}
"""
CAMPAIGN = """\
name: chapter4-half-space
seed: 2018
realisations: 30
scene:
  body: {youngs_modulus: 70e9, poissons_ratio: 0.33, aspect_ratio: .inf}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.007}
reference: {eps_c: 1/2, eps_f: 1/1024, eps_t: 1/2}
limits: {eps_c: [1, 1/2, 1/4], eps_f: [1/512, 1/1024], eps_t: [1, 1/2, 1/4, 1/8]}
grid: {hurst: [0.3, 0.5, 0.8], aspect_ratio: [0.5, 1, 4, .inf]}
"""


def write(folder, text, name="scene.yaml"):
    path = folder / name
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-3", 1e-3),
        ("1E5", 1e5),
        (".5", 0.5),
        ("5.", 5.0),
        ("1/64", 1 / 64),
        ("-3/4", -0.75),
        ("012", 12),
        ("0x1F", 31),
        ("0o17", 15),
        (".inf", inf),
        ("-.Inf", -inf),
        ("true", True),
        ("FALSE", False),
        ("~", None),
        ("", None),
        ("no", "no"),
        ("on", "on"),
        ("yes", "yes"),
        ("1_000", "1_000"),
        ("1/0", "1/0"),
        ("1:30", "1:30"),
        ("2018-01-01", "2018-01-01"),
        ("inf", "inf"),
        ("'1e-3'", "1e-3"),
        ('"true"', "true"),
        ("'<<'", "<<"),
    ],
)
def test_unquoted_scalars_follow_the_core_schema_and_fractions(tmp_path, text, value):
    given = read_document(write(tmp_path, f"key: {text}\n")).data["key"]
    assert given == value
    assert type(given) is type(value)


def test_nan_is_a_number(tmp_path):
    assert isnan(read_document(write(tmp_path, "key: .nan\n")).data["key"])


def test_positions_of_values_and_keys_are_remembered(tmp_path):
    document = read_document(write(tmp_path, "\ufeffa:\n  b: [1,\n      2]\n"))
    assert document.positions[("a", "b", 1)] == (3, 7)
    assert document.key_positions[("a", "b")] == (2, 3)
    assert document.positions[("a", "b")] == (2, 6)


def test_nested_and_flat_files_give_the_same_scene(tmp_path):
    nested, flat = (load_scene(write(tmp_path, text))[0] for text in (NESTED, FLAT))
    assert nested == flat
    assert nested.scene.roughness == SelfAffine(method="psd", hurst=0.8, rms_gradient=0.01)
    assert nested.scene.body.youngs_modulus == 70e9
    assert nested.discretisation == Discretisation(eps_c=0.5, eps_f=1 / 64, eps_t=0.5)
    assert (nested.numerics.solver, nested.numerics.residual) == ("verlet", 1e-6)
    assert (nested.seed, nested.realisation) == (7, 0)


def test_mapping_and_record_give_the_same_scene_as_a_file(tmp_path):
    path = write(tmp_path, FLAT)
    mapping = read_document(path).data
    assert load_scene(mapping)[0] == load_scene(str(path))[0] == load_scene(load_scene(path)[0])[0]
    assert set(mapping) == {"body", "roughness", "interface", "loading", "numerics", "discretisation", "seed"}


def test_measured_profile_is_found_from_the_scene_files_folder(tmp_path, monkeypatch):
    (tmp_path / "profiles").mkdir()
    (tmp_path / "profiles" / "steel.npy").touch()
    monkeypatch.chdir("/")
    scene_file = load_scene(write(tmp_path, MEASURED))[0]
    assert scene_file.scene.roughness.file == str((tmp_path / "profiles" / "steel.npy").resolve())
    assert load_scene(scene_file)[0] == scene_file


def test_records_are_frozen():
    with pytest.raises(ValidationError, match="frozen"):
        Discretisation(eps_c=1, eps_f=1, eps_t=0.5).eps_c = 0.5


@pytest.mark.parametrize(
    ("eps_c", "eps_f", "eps_t", "indices"),
    [
        (1 / 2, 1 / 1024, 1 / 2, (2, 2048, 8192)),
        (1, 1, 1 / 2, (2, 2, 4)),
        (1 / 3, 1 / 7, 1 / 11, (11, 77, 462)),
        (2 / 3, 2 / 3, 1 / 2, (2, 3, 9)),
        (1 / 8, 1 / 65536, 1, (1, 65536, 2**20)),
    ],
)
def test_wave_indices_and_nodes_follow_from_the_eps(eps_c, eps_f, eps_t, indices):
    d = Discretisation(eps_c=eps_c, eps_f=eps_f, eps_t=eps_t)
    assert d.misfit is None
    assert (d.longest_wave_index, d.shortest_wave_index, d.nx) == indices


@pytest.mark.parametrize(
    ("eps_c", "eps_f", "eps_t", "misfit"),
    [(1, 1, 0.3, "eps_t"), (1, 0.3, 1 / 2, "eps_f"), (0.3, 1 / 2, 1 / 2, "eps_c"), (1, 1, 1, "eps_c")],
)
def test_nearest_fit_is_the_nearest_of_all(eps_c, eps_f, eps_t, misfit):
    d = Discretisation(eps_c=eps_c, eps_f=eps_f, eps_t=eps_t)
    assert d.misfit == misfit
    unit = {"eps_t": 1, "eps_f": d.longest_wave_index, "eps_c": 2 * d.shortest_wave_index}[misfit]
    trials = [unit / n for n in range(unit, 200)]
    fitting = [eps for eps in trials if d.model_copy(update={misfit: eps}).misfit is None]
    best = min(fitting, key=lambda eps: abs(eps - getattr(d, misfit)))
    assert float(d.nearest_fit(misfit)) == best


def test_a_campaign_file_gives_its_campaign(tmp_path):
    campaign, document = load_campaign(write(tmp_path, CAMPAIGN, "campaign.yaml"))
    assert document.text == CAMPAIGN
    assert campaign.grid.aspect_ratio == (0.5, 1, 4, inf)
    assert campaign.limits.eps_t == (1, 0.5, 0.25, 0.125)
    assert campaign.n_cases == 12 * (1 + 2 + 1 + 3)
    placed = list(campaign.discretisations())
    visited = [(*each.discretisation.model_dump().values(), each.limit) for each in placed]
    assert visited == [
        (0.5, 1 / 1024, 0.5, "reference"),
        (1, 1 / 1024, 0.5, "eps_c"),
        (0.25, 1 / 1024, 0.5, "eps_c"),
        (0.5, 1 / 512, 0.5, "eps_f"),
        (0.5, 1 / 1024, 1, "eps_t"),
        (0.5, 1 / 1024, 0.25, "eps_t"),
        (0.5, 1 / 1024, 0.125, "eps_t"),
    ]


def test_grid_discretisations_are_a_product(tmp_path):
    text = CAMPAIGN.replace("limits: {eps_c: [1, 1/2, 1/4], ", "limits: {").replace(
        "grid: {", "grid: {eps_c: [1, 1/2], "
    )
    campaign, _ = load_campaign(write(tmp_path, text))
    assert campaign.n_cases == 24 * (1 + 1 + 3)
    assert [d.eps_c for d, *_ in campaign.discretisations()] == 5 * [1] + 5 * [0.5]


def test_fit_has_defaults_and_exponents_may_be_ranges(tmp_path):
    default = load_campaign(write(tmp_path, CAMPAIGN))[0].fit
    assert (default.variable, default.exponents) == ("kappa", "shared")
    assert default.fixed.model_dump(exclude_none=True) == {}
    text = CAMPAIGN + "fit: {variable: kappa_r, exponents: free, fixed: {eps_f: [1/2, 1], eps_t: 1}}\n"
    fit = load_campaign(write(tmp_path, text))[0].fit
    assert (fit.variable, fit.exponents) == ("kappa_r", "free")
    assert fit.fixed.model_dump() == {"eps_c": None, "eps_f": (0.5, 1.0), "eps_t": 1.0}
    assert type(fit.fixed.eps_t) is float
    assert Fit.model_validate_json(fit.model_dump_json()) == fit


@pytest.mark.parametrize("record", [SceneFile, Campaign])
def test_every_field_is_described(record):
    schema = record.model_json_schema()
    for known in (*schema["$defs"].values(), schema):
        for name, node in known["properties"].items():
            assert node.get("description"), name


def test_input_error_is_a_value_error():
    assert issubclass(InputError, ValueError)


def test_numbers_of_numpy_are_numbers():
    body = {"poissons_ratio": np.float32(0.25)}
    rough = {"method": "psd", "hurst": 0.8, "rms_gradient": np.float64(0.02)}
    scene = {"body": body, "roughness": rough, "interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.1}}
    grid = {"eps_c": 0.5, "eps_f": np.float32(0.25), "eps_t": 0.5}
    loaded, _ = load_scene({"scene": scene, "discretisation": grid, "seed": np.int64(3), "realisation": np.uint8(2)})
    assert (loaded.seed, loaded.realisation, loaded.scene.body.poissons_ratio) == (3, 2, 0.25)
    assert type(loaded.seed) is int
