"""What does not go with a loading path, and what cannot take its results, is refused where it stands."""

import pytest

import gfmd_numba
import gfmd_numba.analysis
from gfmd_numba.campaign.plan import plan
from gfmd_numba.scene import InputError
from support.paths import DRAGGED


@pytest.fixture(scope="module")
def dragged(tmp_path_factory):
    return gfmd_numba.run(
        DRAGGED | {"realisations": 1, "grid": {}, "path": DRAGGED["path"][:1]},
        tmp_path_factory.mktemp("dragged") / "out",
    )


def test_what_takes_one_load_refuses_a_path(dragged):
    with pytest.raises(
        gfmd_numba.analysis.UnusableDataError, match=r"gfmd allows one step, like `dataset.isel\(step=-1\)`"
    ):
        gfmd_numba.analysis.ensemble_mean(dragged, "kappa")


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"path": []}, "path: you gave []; gfmd allows at least one loading, or no path"),
        ({"fit": {"step": 7}}, "fit.step: you gave 7; gfmd allows a step from 0, the first loading, to 6"),
        ({"fit": {"variable": "hysteresis", "step": 1}}, "fit.step: you gave 1; gfmd allows nothing with hysteresis"),
        (
            {"fit": {"variable": "pull_off_pressure"}},
            "gfmd allows what this path has; a punch is pulled off",
        ),
        (
            {"path": [{"displacement": 1e-3}]},
            "path[0].displacement: you gave 0.001; gfmd allows what the loading prescribes",
        ),
        ({"path": [{"reduced_pressure": 1e40}]}, "path[0].reduced_pressure: "),
        ({"path": [{"sliding": "1 um"}]}, "path[0].sliding: "),
        ({"scene": DRAGGED["scene"] | {"interface": {"hard_wall": {}}}, "grid": {}}, "path[0].sliding: "),
    ],
)
def test_what_does_not_go_with_a_path_is_refused_where_it_stands(changed, said):
    with pytest.raises(InputError) as refused:
        plan(DRAGGED | changed)
    assert said in str(refused.value)


def test_a_load_of_the_path_is_judged_by_the_moduli():
    scene = DRAGGED["scene"] | {"loading": {"pressure": 1e6}}
    scene["body"] = scene["body"] | {"youngs_modulus": 1e9}
    with pytest.raises(InputError, match=r"path\[0\]\.pressure: you gave 1e-29; gfmd allows a reduced pressure from"):
        plan(DRAGGED | {"scene": scene, "path": [{"pressure": 1e-29}]})
