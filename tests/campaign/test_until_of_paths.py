"""Runs to an error along a loading path: of every step, of one, and of what the path has as a whole."""

import numpy as np
import pytest
import until_of_paths
import xarray as xr
import yaml

import gfmd_numba
from gfmd_numba.analysis import fit_tfc
from gfmd_numba.campaign.goal import Goal
from gfmd_numba.campaign.limits import FEWEST
from gfmd_numba.campaign.next_round import Known, after
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.rounds import Round, Rounds
from gfmd_numba.scene import InputError
from support.command_line import gfmd
from support.synthetic_campaigns import ALPHA, TFC, campaign, noisy

pytestmark = pytest.mark.usefixtures("laws_that_hold")

KNOWN = {"eps_f": 0.7}
DRAGGED = until_of_paths.DRAGGED | {"seed": 1, "realisations": 2}
WALL = DRAGGED["scene"] | {"interface": {"hard_wall": {}}}
LOADED = DRAGGED | {"scene": WALL, "path": [{"reduced_pressure": 0.2}, {"reduced_pressure": 0.02}]}
APART = DRAGGED | {  # the punch comes from afar, so that it touches at the last step alone
    "scene": WALL | {"loading": {"displacement": 0.0}},
    "path": [{"displacement": 5e-4}],
}


def of(variable="kappa", base=DRAGGED, **fit):
    return base | {"fit": {"variable": variable, "fixed": KNOWN} | fit}


def until(campaign, folder, target):
    return gfmd_numba.run(campaign, folder / "out", until={campaign["fit"]["variable"]: target})


def assert_reached(found, variable, target):
    assert found.attrs["ended"] == "reached"
    fitted = fit_tfc(found, variable, fixed=KNOWN)
    assert fitted.sizes["group"] == (3 if variable == "kappa" else 1)
    errors = (fitted[f"{variable}_tfc_error"] / abs(fitted[f"{variable}_tfc"])).values
    assert found["round_error"].values[-1] in errors.tolist()  # that of the worst, by the factor of each
    factor = float(found["round_error_factor"][-1])
    assert found["round_error"].values[-1] * factor <= target
    assert errors.max() <= target
    assert found.attrs["until"] == f"{variable}={target}"


@pytest.mark.long
def test_a_run_ends_with_the_error_of_every_step(tmp_path):
    assert_reached(until(of(base=LOADED), tmp_path, 0.3), "kappa", 0.3)


@pytest.mark.long
def test_a_step_that_is_named_decides_alone(tmp_path):
    """At first touch there is no area and no pressure, and so no kappa."""
    ended = "not reached: kappa at step 0 of the path: .*`fit: {step: ...}` names a step"
    with pytest.warns(UserWarning, match=ended):
        until(of(base=APART), tmp_path / "all", 0.3)
    found = until(of(base=APART, step=1), tmp_path / "one", 0.3)
    assert found.attrs["ended"] == "reached"
    fitted = fit_tfc(found, fixed=KNOWN, step=1)
    assert (fitted["kappa_tfc_error"] / fitted["kappa_tfc"]).item() == pytest.approx(float(found["round_error"][-1]))
    for command in ("fit", "plot"):
        assert gfmd(command, tmp_path / "one" / "out").exit_code == 0
    (tmp_path / "apart.yaml").write_text(yaml.safe_dump(of(base=APART, step=1)))
    done = gfmd("run", tmp_path / "apart.yaml", "-o", tmp_path / "one" / "out", "--until", "30%", "--workers", "0")
    assert done.exit_code == 0, done.output
    assert "kappa to 30.00%: reached" in done.output


@pytest.mark.long
def test_commands_run_to_the_hysteresis_of_a_path(tmp_path):
    file = tmp_path / "dragged.yaml"
    file.write_text(yaml.safe_dump(of("hysteresis", DRAGGED | {"path": DRAGGED["path"][:1]})))
    done = gfmd("run", file, "-o", tmp_path / "until", "--until", "30%", "--workers", "0")
    assert done.exit_code == 0, done.output
    assert "hysteresis to 30.00%: reached" in done.output
    assert done.output.count("hysteresis (1e-") == 1
    assert_reached(gfmd_numba.open_campaign(tmp_path / "until"), "hysteresis", 0.3)
    assert gfmd("fit", tmp_path / "until", "--variable", "kappa").exit_code == 0


def test_a_measure_of_a_path_needs_one():
    without = {key: value for key, value in of("hysteresis").items() if key != "path"}
    with pytest.raises(
        InputError, match=r"fit\.variable: you gave 'hysteresis'; gfmd allows what a single contact has"
    ):
        plan(without)
    with pytest.raises(InputError, match=r"fit\.step: you gave 0; gfmd allows nothing without a path"):
        plan({key: value for key, value in of(step=0).items() if key != "path"})


MOST, SEEDS = 2000, 10
SHAPE = {"levels": {"eps_f": [1 / 256, 1 / 512, 1 / 1024]}, "coefficients": {"eps_f": 6.0}}


def surfaces(seed):
    """Made-up results of a path of two steps, of which the second scatters more."""
    rng = np.random.default_rng(seed)
    steps = [noisy(campaign(realisations=MOST, **SHAPE), rng, spread=spread) for spread in (0.1, 0.2)]
    found = xr.concat([each["kappa"] for each in steps], "step").transpose("case", "realisation", "step")
    drawn = steps[0].drop_vars("kappa").assign(kappa=found)
    nodes = (2 / (drawn["eps_c"] * drawn["eps_f"] * drawn["eps_t"])).astype(int)
    drawn = drawn.assign_coords(nx=nodes, dimension=("case", np.ones(len(nodes), dtype=int)))
    return drawn.assign(n_transforms=(("case", "realisation"), np.full(drawn["status"].shape, 40)))


def asked(drawn, counts):
    counts = np.array(counts)
    assert counts.max() <= MOST
    kept = xr.DataArray(np.arange(counts.max()) < counts[:, None], dims=("case", "realisation"))
    part = drawn.isel(realisation=slice(counts.max())).assign_coords(realisations=("case", counts))
    return part.assign(kappa=part["kappa"].where(kept), status=part["status"].where(kept, 7))


@pytest.mark.long
def test_the_errors_of_all_steps_are_right_where_a_run_stops(laws_that_hold):
    distances = []
    for seed in range(SEEDS):
        drawn = surfaces(seed)
        first = Round(realisations=(FEWEST,) * drawn.sizes["case"], is_last=False)
        state = Rounds(goal=Goal(targets={"kappa": 0.02}), campaign_sha256="", rounds=(first,))
        while not state.ended:
            results = asked(drawn, state.now.realisations).assign_attrs(cpu_seconds=1.0)
            fitted = fit_tfc(results, fixed=ALPHA)
            state = after(state, [Known(results, fitted, "kappa", ALPHA)])
        if "no law of the limits describes the means" in state.ended:  # by chance, as one in twenty means scatter
            continue
        assert state.ended == "reached"
        errors = (fitted["kappa_tfc_error"] / fitted["kappa_tfc"]).values
        assert (errors <= 0.02).all()
        assert errors[0] < errors[1] == pytest.approx(state.now.errors["kappa"].error)
        distances.append((fitted["kappa_tfc"].values - TFC[0.8]) / fitted["kappa_tfc_error"].values)
    assert len(distances) >= 0.9 * SEEDS
    scatter = np.sqrt(np.mean(np.square(distances), axis=0))
    assert (scatter > 0.4).all()
    assert (scatter < 1.6).all()  # 2.7 standard errors of so many runs
