"""Scenes that do not fit in memory are refused: what solving takes, and the fields of every step of a path."""

from types import SimpleNamespace

import pytest

from gfmd_numba.scene import InputError, load_scene

FILE = {
    "scene": {
        "dimension": 2,
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 1.0},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05},
        "interface": {"hard_wall": {}},
        "loading": {"displacement": 0.0},
    },
    "discretisation": {"eps_c": 1 / 8, "eps_f": 1 / 64, "eps_t": 1.0},  # 1024^2 nodes: 8.4 MB an array
}


@pytest.fixture
def memory(monkeypatch):
    """Sets how many arrays of a map of 1024^2 nodes the machine holds."""

    def of(arrays):
        total = arrays * 8 * 1024**2
        monkeypatch.setattr("psutil.virtual_memory", lambda: SimpleNamespace(total=total, available=total))

    return of


def loaded(law=None, steps=0):
    name = "displacement" if law != "friction" else "sliding"
    laws = {
        None: {},
        "friction": {"friction": {"coefficient": 0.3}},
        "exponential": {"exponential": {"work_of_adhesion": 1e-4, "range": 5e-3}},
    }
    scene = FILE["scene"] | {"interface": {"hard_wall": {}} | laws[law]}
    return load_scene(FILE | {"scene": scene, "path": [{name: 1e-4 * i} for i in range(1, steps + 1)]})


@pytest.mark.parametrize(
    ("law", "steps", "arrays"),  # the most that `benchmarks/memory.py` finds, rounded up
    [(None, 0, 24), ("exponential", 0, 32), ("friction", 0, 256), (None, 9, 104), ("exponential", 9, 176)],
)
def test_a_scene_is_refused_exactly_where_its_arrays_do_not_fit(law, steps, arrays, memory):
    memory(arrays)
    loaded(law, steps)
    memory(arrays - 1)
    with pytest.raises(InputError, match=r"discretisation.eps_f: you gave .* a grid that fits in .* GB of memory"):
        loaded(law, steps)


@pytest.mark.parametrize(
    ("changes", "arrays"),
    [
        ({"body": {"poissons_ratio": 0.3, "relaxation": [{"modulus": 1.0, "time": 1.0}] * 2}}, 72),
        ({"interface": {"hard_wall": {}, "wear": {"rate": 1.0}}}, 32),
        ({"body": FILE["scene"]["body"] | {"roughness": FILE["scene"]["roughness"]}}, 56),
    ],
)
def test_what_remembers_its_past_takes_more(changes, arrays, memory):
    whole = FILE | {"scene": FILE["scene"] | changes}
    memory(arrays)
    load_scene(whole)
    memory(arrays - 1)
    with pytest.raises(InputError, match="GB of memory"):
        load_scene(whole)


def test_a_long_path_takes_more_than_its_steps_do_alone(memory):
    memory(256)
    loaded("friction")
    with pytest.raises(InputError, match="GB of memory"):
        loaded("friction", steps=1)
