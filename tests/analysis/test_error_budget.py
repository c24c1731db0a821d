"""What the error of a limit comes from, and what a solver's residual may do to kappa."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.analysis import fit_tfc
from gfmd_numba.contact.evaluation import measure
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.solution import solve
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.solvers.table import Options
from support.synthetic_campaigns import ALPHA, CROSS, LEVELS, REFERENCE, campaign, noisy

pytestmark = pytest.mark.usefixtures("laws_that_hold")

RANGES = {"eps_c": (0.9, 1.3), "eps_f": (0.5, 0.7), "eps_t": 1.0}
MIDDLE = {"eps_c": 1.1, "eps_f": 0.6, "eps_t": 1.0}


def part(fit, source):
    return fit["error_budget"].sel(source=source).item()


def whole(fit):
    """All parts in quadrature but that of the residual, which is a bound."""
    return np.hypot.reduce(fit["error_budget"].isel(group=0).drop_sel(source="residual").values)


def limit_for(dataset, name, exponent):
    """TFC limit of data without noise at a given exponent."""
    columns = [dataset[limit].values ** (MIDDLE | {name: exponent})[limit] for limit in MIDDLE]
    design = np.column_stack([np.ones(dataset.sizes["case"]), *columns])
    return np.linalg.lstsq(design, dataset["kappa_r"].mean("realisation").values, rcond=None)[0][0]


@pytest.mark.parametrize("name", [pytest.param("eps_c", marks=pytest.mark.long), "eps_f"])
def test_the_part_of_an_exponent_is_the_spread_over_its_range(name):
    """Of two levels, which tell nothing of the exponent; kappa_r has no other law than powers."""
    dataset = campaign(levels=LEVELS | {name: [REFERENCE[name], REFERENCE[name] / 4]}).rename(kappa="kappa_r")
    fit = fit_tfc(dataset, "kappa_r", fixed=MIDDLE | {name: RANGES[name]})
    low, high = RANGES[name]
    exponents = low + (high - low) * (np.arange(100) + 0.5) / 100
    limits = [limit_for(dataset, name, exponent) for exponent in exponents]
    assert part(fit, name) == pytest.approx(np.std(limits), rel=1e-4)
    assert part(fit, "eps_t") == 0.0
    assert part(fit, "sampling") < 1e-7


@pytest.mark.parametrize("cross", [(), CROSS], ids=["one at a time", "cross"])
@pytest.mark.parametrize("variable", ["kappa", "kappa_r"])
def test_the_parts_in_quadrature_are_the_whole_error(cross, variable):
    dataset = noisy(campaign(realisations=30, cross=cross), np.random.default_rng(14), spread=0.05)
    fit = fit_tfc(dataset.rename(kappa=variable), variable, fixed=RANGES)
    sources = "eps_c", "eps_f", "interaction", "sampling"
    assert min(part(fit, source) for source in sources) > 0.02 * fit[f"{variable}_tfc_error"].item()
    assert part(fit, "eps_t") == 0.0
    assert whole(fit) == pytest.approx(fit[f"{variable}_tfc_error"].item(), rel=1e-9)


def test_with_exact_exponents_all_is_sampling_and_interactions():
    dataset = noisy(campaign(realisations=30), np.random.default_rng(14), spread=0.05)
    fit = fit_tfc(dataset.rename(kappa="kappa_r"), "kappa_r", fixed=MIDDLE)
    assert [part(fit, name) for name in MIDDLE] == [0.0, 0.0, 0.0]
    assert whole(fit) == pytest.approx(fit["kappa_r_tfc_error"].item(), rel=1e-12)
    for of in ("", "_error"):  # C eps^alpha is the correction
        of_c = [fit[f"C{of}"].sel(limit=name).item() * REFERENCE[name] ** alpha for name, alpha in MIDDLE.items()]
        assert of_c == pytest.approx(fit[f"correction{of}"].sel(limit=list(MIDDLE)).values[0])
    # what no cross level tells has nothing to do with the surfaces
    of_c_and_f = fit["interaction_error"].sel(pair="eps_c eps_f").item()
    of_t = fit["correction_error"].sel(limit="eps_t").item()
    assert part(fit, "interaction") == pytest.approx(np.hypot(of_c_and_f, of_t), rel=1e-9)


def test_with_a_single_limit_there_is_no_interaction():
    dataset = noisy(campaign(levels={"eps_c": [1 / 2, 1 / 4, 1 / 8]}, realisations=30), np.random.default_rng(14))
    fit = fit_tfc(dataset, fixed=MIDDLE)
    assert part(fit, "interaction") == 0.0
    assert part(fit, "sampling") == pytest.approx(fit["kappa_tfc_error"].item(), rel=1e-12)
    assert "corrections" not in fit["message"].item()


def test_what_is_not_known_of_a_searched_exponent_is_the_part_of_its_limit():
    dataset = noisy(campaign(realisations=30), np.random.default_rng(4), spread=0.02, own=0.005)
    fit = fit_tfc(dataset, fixed={"eps_t": 1.0})
    assert [part(fit, name) > 1e-4 for name in ("eps_c", "eps_f", "eps_t")] == [True, True, False]
    assert part(fit, "eps_t") == 0.0
    assert whole(fit) == pytest.approx(fit["kappa_tfc_error"].item(), rel=1e-9)


def test_a_limit_that_is_not_varied_has_an_unknown_part():
    dataset = campaign(levels={"eps_c": [1 / 2, 1 / 4, 1 / 8]}, realisations=3)
    fit = fit_tfc(dataset, fixed={"eps_c": (0.9, 1.3)})
    assert part(fit, "eps_c") > 0.0
    assert np.isnan([part(fit, name) for name in ("eps_f", "eps_t")]).all()


@pytest.mark.parametrize(
    ("variable", "fixed"),
    [
        pytest.param("kappa", ALPHA, id="exact", marks=pytest.mark.long),
        pytest.param("kappa_r", ALPHA, id="another variable", marks=pytest.mark.long),
        pytest.param("kappa", RANGES, id="ranges", marks=pytest.mark.long),
    ],
)
def test_the_part_of_the_residual_is_the_most_that_the_means_can_add_up_to(variable, fixed):
    rng = np.random.default_rng(4)
    levels = {"eps_c": [1 / 2, 1 / 4, 1 / 8], "eps_f": [1 / 512, 1 / 1024, 1 / 2048]}
    cross = [{"eps_c": 1 / 4, "eps_f": 1 / 512}]
    dataset = noisy(campaign(levels=levels, realisations=30, cross=cross), rng, spread=0.02, own=0.005)
    dataset["kappa_r"] = 0.7 * dataset["kappa"]
    share = 1e-6 * rng.random(dataset["kappa"].shape)
    dataset["kappa_residual_error"] = share * dataset["kappa"]
    fit = fit_tfc(dataset, variable, fixed=fixed)
    worst = 0.0
    for case, error in enumerate((share * dataset[variable]).mean("realisation").values):
        moved = dataset.copy(deep=True)
        moved[variable][case] += 10 * error  # the same in every realisation: the weights stay
        shifted = fit_tfc(moved, variable, fixed=fixed)[f"{variable}_tfc"]
        worst += abs(shifted - fit[f"{variable}_tfc"]).item() / 10
    assert part(fit, "residual") == pytest.approx(worst, rel=2e-2)
    assert "residual" not in fit["message"].item()


def test_a_residual_that_is_too_large_for_the_error_is_told():
    dataset = noisy(campaign(realisations=12), np.random.default_rng(3))
    dataset["kappa_residual_error"] = 0.1 * dataset["kappa"]
    assert "ask for a smaller numerics.residual" in fit_tfc(dataset, fixed=ALPHA)["message"].item()


def test_a_dataset_without_residual_errors_and_times_says_nothing_of_them():
    fit = fit_tfc(campaign(), fixed=ALPHA)
    assert np.isnan(part(fit, "residual"))
    assert np.isnan(fit["seconds"].item())


def test_seconds_are_those_of_the_cases_fitted():
    dataset = campaign((0.3, 0.8), levels={"eps_c": [1, 1 / 2, 1 / 4, 1 / 8]})
    dataset["case_seconds"] = ("case", 2.0 ** np.arange(8))
    fit = fit_tfc(dataset, fixed=ALPHA)
    of_nyquist = (dataset["eps_c"] == 1).values
    expected = [dataset["case_seconds"].values[(dataset["hurst"] == h).values & ~of_nyquist].sum() for h in (0.3, 0.8)]
    assert fit["seconds"].values.tolist() == expected


def test_the_budget_survives_netcdf(tmp_path):
    fit_tfc(campaign((0.3, 0.8)), fixed=RANGES).to_netcdf(tmp_path / "fit.nc")
    with xr.open_dataset(tmp_path / "fit.nc") as again:
        sources = ["interaction", "sampling", "extrapolation", "rivals", "residual"]
        assert again["source"].values.tolist() == ["eps_c", "eps_f", "eps_t", *sources]
        assert again["error_budget"].sizes == {"group": 2, "source": 8}
        assert REFERENCE["eps_c"] == again["reference_eps"][0, 0]


@pytest.mark.parametrize(
    ("load", "displacement", "nodes", "solver"),
    [
        (0.007, None, (1024, 1), "verlet"),
        (0.05, None, (1024, 1), "active_set_newton"),
        (None, 0.03, (1024, 1), "verlet"),
        (0.05, None, (64, 2), "conjugate_gradients"),
    ],
)
def test_a_residual_changes_kappa_by_no_more_than_it_says(load, displacement, nodes, solver):
    nx, dimension = nodes
    surface = RandomSurface(SelfAffineWaves(0.8, 2, nx // 8), nx, 5, dimension)
    body = ElasticBody(0.33, 0.1)
    tight = Options("active_set_newton", residual=1e-12)
    problem = Problem(surface, body, Interactions(True), load, displacement, tight)
    exact = measure(solve(problem, range(6)))
    assert not exact["status"].any()
    for residual in (1e-2, 1e-5):
        loose = measure(solve(replace(problem, numerics=Options(solver, residual=residual)), range(6)))
        assert not loose["status"].any()
        changed = abs(loose["kappa"] - exact["kappa"])
        assert (changed <= loose["kappa_residual_error"] + 1e-11).all()
        if residual <= 1e-5:
            assert (loose["kappa_residual_error"] < 3e-2 * exact["kappa"]).all()


@pytest.mark.parametrize("leaves", [True, False])
def test_a_node_on_the_brink_counts(leaves):
    """Its pressure or gap is below what the residual leaves open: on the other side, kappa is another."""
    numerics = Options("active_set_newton")
    problem = Problem(
        RandomSurface(SelfAffineWaves(0.8, 2, 128), 1024, 5),
        ElasticBody(None, None),
        Interactions(True),
        0.05,
        None,
        numerics,
    )
    contact = solve(problem, range(1))
    found = contact.equilibrium
    edge = found.touching & ~np.roll(found.touching, 1, axis=1)
    node = np.flatnonzero(edge[0])[0] - (not leaves)
    brink = found.residual[0] * found.pressure.max()
    on_the_brink = replace(found, pressure=found.pressure.copy(), displacement=found.displacement.copy())
    if leaves:
        on_the_brink.pressure[0, node] = 2.0 * brink
    else:
        on_the_brink.displacement[0, node] = contact.punch[0, node] - 1e-3 * brink
    moved = replace(on_the_brink, touching=found.touching.copy())
    moved.touching[0, node] = not leaves
    here, there = (measure(replace(contact, equilibrium=each)) for each in (on_the_brink, moved))
    changed = abs(here["kappa"] - there["kappa"])
    assert changed > 1e-3
    assert changed <= here["kappa_residual_error"] <= 3.0 * changed
    assert measure(contact)["kappa_residual_error"] < 1e-3 * changed

    # what a law pulls at no gap is borne by the wall too, so that no node is about to leave
    pull = 0.5 * found.pressure.mean()
    pulled = replace(found, pressure=found.pressure - pull * found.touching)
    assert (
        measure(replace(contact, equilibrium=pulled, law_traction_at_contact=pull))["kappa_residual_error"]
        < 1e-2 * changed
    )


@pytest.mark.long
def test_a_residual_under_attraction_says_little_and_enough(tmp_path):
    scene = {
        "body": {"poissons_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.6, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": 1e-6, "range": 1e-3}},
        "loading": {"reduced_pressure": 0.02},
    }
    reference = {"eps_c": 1 / 4, "eps_f": 1 / 64, "eps_t": 1 / 4}
    asked = {"scene": scene, "name": "a", "seed": 1, "realisations": 4, "reference": reference}
    loose, exact = (
        gfmd_numba.run(asked | {"numerics": {"residual": residual}}, tmp_path / f"{residual}", workers=0)
        for residual in (1e-5, 1e-11)
    )
    assert (abs(loose["kappa"] - exact["kappa"]) <= loose["kappa_residual_error"]).all()
    assert (loose["kappa_residual_error"] < 5e-3 * exact["kappa"]).all()
