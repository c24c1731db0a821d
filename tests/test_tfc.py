import numpy as np
import pytest
import xarray as xr
from described import with_axes
from scipy.stats import binom

from gfmd_numba.analysis import fit_tfc, select_limit
from gfmd_numba.analysis.least_squares import covariance_of_one

LEVELS = {
    "eps_c": [1 / 2, 1 / 4, 1 / 8],
    "eps_f": [1 / 256, 1 / 512, 1 / 1024, 1 / 2048, 1 / 4096],
    "eps_t": [1, 1 / 2, 1 / 4, 1 / 8],
}
REFERENCE = {"eps_c": 1 / 2, "eps_f": 1 / 1024, "eps_t": 1 / 2}
C = {"eps_c": 0.4, "eps_f": 6.0, "eps_t": 0.3}
ALPHA = {"eps_c": 1.1, "eps_f": 0.6, "eps_t": 1.0}
TFC = {0.3: 3.0, 0.8: 2.0}


def campaign(hursts=(0.8,), levels=LEVELS, coefficients=C, alpha=ALPHA, realisations=4):
    """Noise-free one-at-a-time campaign; alpha may be given per Hurst exponent."""
    rows = []
    for hurst in hursts:
        rows.append((hurst, "reference", REFERENCE))
        for name, values in levels.items():
            rows += [(hurst, name, REFERENCE | {name: eps}) for eps in values if eps != REFERENCE[name]]
    constants = {"poissons_ratio": 0.33, "aspect_ratio": np.inf, "reduced_pressure": 0.007}
    coords = {name: ("case", np.array([eps[name] for _, _, eps in rows])) for name in LEVELS}
    coords |= {name: ("case", np.full(len(rows), value)) for name, value in constants.items()}
    coords["rms_gradient_target"] = ("case", np.full(len(rows), 0.01))
    coords["hurst"] = ("case", np.array([hurst for hurst, _, _ in rows]))
    coords["limit"] = ("case", [limit for _, limit, _ in rows])
    coords["is_reference"] = ("case", [limit == "reference" for _, limit, _ in rows])
    coords["case_id"] = ("case", [f"case-{index}" for index in range(len(rows))])
    of = alpha if 0.8 in alpha else dict.fromkeys(hursts, alpha)
    means = [TFC[h] + sum(c * eps[n] ** of[h][n] for n, c in coefficients.items()) for h, _, eps in rows]
    kappa = np.repeat(np.array(means)[:, None], realisations, axis=1)
    dims = ("case", "realisation")
    variables = {"kappa": (dims, kappa), "status": (dims, np.zeros(kappa.shape, np.int8))}
    return with_axes(xr.Dataset(variables, coords))


def noisy(dataset, rng, spread=0.2, own=0.01):
    """Paired noise as in real contacts: variance falls with the number of asperities."""
    n_cases, n = dataset["kappa"].shape
    size = spread * (2048 * dataset["eps_t"] * dataset["eps_f"]).values[:, None] ** 0.35
    surfaces = np.stack([dataset["eps_t"], dataset["eps_f"]], axis=-1)
    _, surface = np.unique(surfaces, axis=0, return_inverse=True)
    common, of_surface = rng.standard_normal((1, n)), rng.standard_normal((n_cases, n))[surface.ravel()]
    noise = size * (0.8 * common + 0.6 * of_surface) + own * rng.standard_normal((n_cases, n))
    return dataset.assign(kappa=dataset["kappa"] + noise)


def fails(dataset, **where):
    """Mark results as crashed, their values garbage."""
    broken = dataset.copy(deep=True)
    broken["kappa"][where] = 1e3
    broken["status"][where] = 5
    return broken


def assert_refused(fit, *fragments):
    assert (fit["fit_status"] == "refused").all()
    for name in ("kappa_tfc", "kappa_tfc_error", "kappa_tfc_low", "C", "alpha", "correction", "rms_residual"):
        assert np.isnan(fit[name]).all(), name
    for fragment in fragments:
        assert fragment in fit["message"].values[0]


@pytest.mark.parametrize(
    ("exponents", "fixed"),
    [("shared", {}), ("free", {}), ("shared", {"eps_t": 1.0}), ("free", ALPHA)],
)
def test_planted_parameters_are_recovered_exactly(exponents, fixed):
    fit = fit_tfc(campaign((0.3, 0.8)), exponents=exponents, fixed=fixed, bootstrap=5)
    assert fit["fit_status"].values.tolist() == ["ok", "ok"]
    np.testing.assert_allclose(fit["kappa_tfc"], [3.0, 2.0], atol=1e-8)
    for row in range(2):
        np.testing.assert_allclose(fit["alpha"][row], list(ALPHA.values()), rtol=1e-8)
        np.testing.assert_allclose(fit["C"][row], list(C.values()), rtol=1e-7)
        at_reference = [C[name] * REFERENCE[name] ** ALPHA[name] for name in C]
        np.testing.assert_allclose(fit["correction"][row], at_reference, rtol=1e-8)
    np.testing.assert_allclose(fit["kappa_tfc_error"], 0, atol=1e-8)
    np.testing.assert_allclose(fit["rms_residual"], 0, atol=1e-10)
    assert fit["n_cases"].values.tolist() == [10, 10]


def test_free_exponents_differ_between_groups_and_shared_ones_do_not():
    planted = {0.3: ALPHA, 0.8: ALPHA | {"eps_f": 0.9}}
    dataset = campaign((0.3, 0.8), alpha=planted)
    free = fit_tfc(dataset, exponents="free", bootstrap=5)
    np.testing.assert_allclose(free["alpha"].sel(limit="eps_f"), [0.6, 0.9], rtol=1e-8)
    shared = fit_tfc(dataset, exponents="shared", bootstrap=5)["alpha"].sel(limit="eps_f")
    assert shared[0] == shared[1]
    assert 0.6 < shared[0] < 0.9


def test_a_group_with_two_levels_borrows_the_shared_exponent():
    dataset = campaign((0.3, 0.8))
    dataset = dataset.isel(case=~((dataset["hurst"] == 0.3) & (dataset["eps_c"] == 1 / 8)).values)
    fit = fit_tfc(dataset, bootstrap=5)
    np.testing.assert_allclose(fit["kappa_tfc"], [3.0, 2.0], atol=1e-8)
    alone = fit_tfc(dataset, exponents="free", bootstrap=5)
    assert alone["fit_status"].values.tolist() == ["refused", "ok"]


def test_full_product_without_a_reference_case():
    base = campaign()
    axes = np.meshgrid([1 / 2, 1 / 4, 1 / 8], [1 / 256, 1 / 1024, 1 / 4096], [1 / 2, 1 / 4, 1 / 8])
    c, f, t = (axis.ravel() for axis in axes)
    dataset = base.isel(case=np.zeros(c.size, int)).assign_coords(
        eps_c=("case", c), eps_f=("case", f), eps_t=("case", t), is_reference=("case", np.zeros(c.size, bool))
    )
    dataset["kappa"] += 2 + 0.4 * dataset["eps_c"] ** 1.1 + 6 * dataset["eps_f"] ** 0.6 + 0.3 * dataset["eps_t"]
    dataset["kappa"] -= base["kappa"].values[0, 0]
    fit = fit_tfc(dataset, bootstrap=5)
    np.testing.assert_allclose(fit["kappa_tfc"], 2.0, atol=1e-8)
    np.testing.assert_allclose(fit["correction"].sel(limit="eps_t"), 0.3 / 8, rtol=1e-7)  # at the finest level


def test_noisy_parameters_lie_inside_the_error_bars():
    rng = np.random.default_rng(4)
    fit = fit_tfc(
        noisy(campaign((0.3, 0.8), realisations=30), rng, spread=0.02, own=0.005),
        fixed={"eps_t": 1.0},
        bootstrap=100,
    )
    assert (fit["fit_status"] == "ok").all()
    assert (abs(fit["kappa_tfc"] - [3.0, 2.0]) < 3 * fit["kappa_tfc_error"]).all()
    assert (abs(fit["C"] - list(C.values())) < 3 * fit["C_error"]).all()
    free = ["eps_c", "eps_f"]
    assert (abs(fit["alpha"] - list(ALPHA.values())) < 3 * fit["alpha_error"]).sel(limit=free).all()
    assert (fit["alpha_error"].sel(limit="eps_t") == 0).all()
    # the error of a 30-realisation mean, enlarged by the extrapolation
    assert (fit["kappa_tfc_error"] > 0.02 / np.sqrt(30)).all()
    assert (fit["kappa_tfc_error"] < 0.2 / np.sqrt(30)).all()


def test_ninety_percent_interval_covers_the_truth():
    rng = np.random.default_rng(11)
    truth, n = campaign(realisations=30), 60
    fixed = {"eps_f": ALPHA["eps_f"], "eps_t": ALPHA["eps_t"]}
    inside, error = 0, []
    for _ in range(n):
        fit = fit_tfc(noisy(truth, rng), fixed=fixed, bootstrap=80)
        inside += int(fit["kappa_tfc_low"].item() <= 2.0 <= fit["kappa_tfc_high"].item())
        error.append((fit["kappa_tfc"].item() - 2.0, fit["kappa_tfc_error"].item()))
    # percentile intervals of 30 realisations cover nearer 87 % than 90 %; all 60 would mean errors too large
    assert binom.ppf(1e-3, n, 0.87) <= inside < n
    scatter, claimed = np.sqrt(np.mean(np.square(error), axis=0))
    assert 0.7 < claimed / scatter < 1.4


def test_weighted_fit_is_more_precise_than_ordinary_least_squares():
    """On paired data whose variances differ between cases, at fixed exponents where OLS is linear."""
    rng = np.random.default_rng(2)
    truth = campaign(realisations=30)
    names = list(C)
    design = np.column_stack([np.ones(10), *(truth[name].values ** ALPHA[name] for name in names)])
    ordinary, weighted = [], []
    for _ in range(200):
        dataset = noisy(truth, rng)
        beta = np.linalg.lstsq(design, dataset["kappa"].mean("realisation").values, rcond=None)[0]
        fit = fit_tfc(dataset, fixed=ALPHA, bootstrap=0)
        ordinary.append([beta[0] - 2.0, beta[1] - C["eps_c"]])
        weighted.append([fit["kappa_tfc"].item() - 2.0, fit["C"].sel(limit="eps_c").item() - C["eps_c"]])
    ratio = np.std(weighted, axis=0) / np.std(ordinary, axis=0)
    assert ratio[0] < 0.95
    assert ratio[1] < 1.0


def test_a_huge_offset_common_to_all_levels_leaves_the_coefficients_alone():
    rng = np.random.default_rng(5)
    dataset = campaign((0.3, 0.8), realisations=20)
    dataset["kappa"] = dataset["kappa"] + 0.01 * rng.standard_normal(dataset["kappa"].shape)
    shifted = dataset.assign(kappa=dataset["kappa"] + 100 * rng.standard_normal(20))
    plain, paired = (fit_tfc(data, fixed=ALPHA, bootstrap=50) for data in (dataset, shifted))
    np.testing.assert_allclose(paired["C"], plain["C"], rtol=1e-5)
    np.testing.assert_allclose(paired["C_error"], plain["C_error"], rtol=1e-3)
    assert (paired["kappa_tfc_error"] > 1000 * plain["kappa_tfc_error"]).all()
    unpaired = shifted.copy(deep=True)
    unpaired["kappa"][3] = rng.permutation(unpaired["kappa"][3].values)
    assert (fit_tfc(unpaired, fixed=ALPHA, bootstrap=50)["C_error"][0] > 100 * plain["C_error"][0]).any()


def test_one_draw_of_realisations_serves_all_groups():
    dataset = campaign((0.3, 0.8), realisations=10)
    noise = np.random.default_rng(7).standard_normal((10, 10))
    dataset["kappa"] = dataset["kappa"] + 0.1 * np.concatenate([noise, noise])
    fit = fit_tfc(dataset, exponents="free", fixed=ALPHA, bootstrap=10)
    np.testing.assert_allclose(fit["kappa_tfc_error"][0], fit["kappa_tfc_error"][1], rtol=1e-9)


def test_same_seed_same_numbers():
    dataset = noisy(campaign(realisations=10), np.random.default_rng(0))
    first, again = (fit_tfc(dataset, fixed=ALPHA, bootstrap=20, seed=3) for _ in range(2))
    xr.testing.assert_identical(first, again)
    other = fit_tfc(dataset, fixed=ALPHA, bootstrap=20, seed=4)
    assert other["kappa_tfc_error"] != first["kappa_tfc_error"]


def test_error_bars_cover_an_exponent_known_only_to_a_range():
    planted = ALPHA | {"eps_f": 0.67}
    dataset = noisy(campaign(alpha=planted, realisations=30), np.random.default_rng(14), spread=0.02)
    others = {"eps_c": ALPHA["eps_c"], "eps_t": ALPHA["eps_t"]}
    exact, ranged = (fit_tfc(dataset, fixed=others | {"eps_f": e}, bootstrap=200) for e in (0.67, (0.5, 1.0)))
    assert ranged["kappa_tfc_low"] < 2.0 < ranged["kappa_tfc_high"]
    assert ranged["kappa_tfc_error"] > 1.5 * exact["kappa_tfc_error"]
    eps_f = ranged.sel(limit="eps_f", group=0)
    assert abs(eps_f["alpha"] - 0.67) < 2 * eps_f["alpha_error"]
    assert abs(eps_f["C"] - C["eps_f"]) < 3 * eps_f["C_error"]
    assert ranged.attrs["fixed"] == "eps_c: 1.1, eps_t: 1, eps_f: 0.5..1"


WIDE = {"eps_c": (0.5, 2.5), "eps_f": (0.3, 1.5), "eps_t": (0.5, 2.0)}


def test_what_the_data_say_of_an_exponent_counts_within_its_range():
    long = LEVELS | {"eps_f": [4.0**-n for n in range(3, 9)]}
    dataset = noisy(campaign(levels=long, realisations=60), np.random.default_rng(3), spread=0.02)
    eps_f = fit_tfc(dataset, fixed=WIDE, bootstrap=200).sel(limit="eps_f", group=0)
    assert eps_f["alpha_error"] < 0.2 * (1.5 - 0.3) / np.sqrt(12)
    assert abs(eps_f["alpha"] - ALPHA["eps_f"]) < 3 * eps_f["alpha_error"]


def test_an_exponent_pressed_to_the_low_end_of_its_range_is_told():
    dataset = noisy(campaign(realisations=60), np.random.default_rng(5), spread=0.02)
    said = [fit_tfc(dataset, fixed=ALPHA | {"eps_f": ends}, bootstrap=100) for ends in ((0.2, 2.0), (1.0, 2.0))]
    assert ["low end of its range" in fit["message"].item() for fit in said] == [False, True]
    assert "exponent of eps_f is pressed to the low end of its range, 1: allow less" in said[1]["message"].item()


def test_no_power_of_eps_f_is_passed_off_as_a_limit_where_there_is_a_logarithm():
    dataset = campaign(realisations=3)
    steep = [with_axes(dataset.assign_coords(hurst=("case", np.full(10, hurst)))) for hurst in (0.8, 1)]
    notes = [fit_tfc(each, fixed=ALPHA, bootstrap=5) for each in steep]
    assert ["1 / log(1 / eps_f)" in fit["message"].item() for fit in notes] == [False, True]


def test_without_a_correction_all_exponents_of_a_range_are_as_good():
    flat = dict.fromkeys(C, 0.0)
    dataset = noisy(campaign(coefficients=flat, realisations=60), np.random.default_rng(4))
    fit = fit_tfc(dataset, fixed=WIDE, bootstrap=400)
    uniform = [(high - low) / np.sqrt(12) for low, high in WIDE.values()]
    np.testing.assert_allclose(fit["alpha_error"].isel(group=0), uniform, rtol=0.35)


def test_errors_are_right_when_exponents_lie_anywhere_in_their_ranges():
    rng = np.random.default_rng(12)
    found = []
    for _ in range(40):
        planted = {name: rng.uniform(*ends) for name, ends in WIDE.items()}
        coefficients = {name: C[name] * REFERENCE[name] ** (ALPHA[name] - planted[name]) for name in C}
        truth = campaign(alpha=planted, coefficients=coefficients, realisations=30)
        fit = fit_tfc(noisy(truth, rng), fixed=WIDE, bootstrap=40)
        found.append((fit["kappa_tfc"].item() - 2.0, fit["kappa_tfc_error"].item()))
    scatter, claimed = np.sqrt(np.mean(np.square(found), axis=0))
    assert 0.65 < claimed / scatter < 1.5


@pytest.mark.parametrize("exponents", ["shared", "free"])
def test_without_noise_the_error_is_that_of_the_range(exponents):
    dataset = campaign((0.3, 0.8), realisations=3)
    fit = fit_tfc(dataset, exponents=exponents, fixed=ALPHA | {"eps_t": (0.8, 1.2)}, bootstrap=400)
    ends = [
        fit_tfc(dataset, exponents=exponents, fixed=ALPHA | {"eps_t": end}, bootstrap=0)["kappa_tfc"]
        for end in (0.8, 1.2)
    ]
    # kappa_tfc is nearly linear in the exponent over so short a range
    np.testing.assert_allclose(fit["kappa_tfc_error"], abs(ends[1] - ends[0]) / np.sqrt(12), rtol=0.1)
    assert (fit["kappa_tfc_low"] >= ends[0]).all()
    assert (fit["kappa_tfc_high"] <= ends[1]).all()
    assert (fit["alpha_error"].sel(limit="eps_c") < 1e-12).all()


def test_a_range_of_no_width_is_an_exact_exponent():
    dataset = noisy(campaign(realisations=10), np.random.default_rng(0))
    exact, ranged = (fit_tfc(dataset, fixed=ALPHA | {"eps_t": e}, bootstrap=20) for e in (1.0, [1.0, 1.0]))
    xr.testing.assert_identical(exact, ranged)


@pytest.mark.parametrize("spread", [0.0, 0.02])
def test_a_flat_limit_has_no_exponent(spread):
    rng = np.random.default_rng(6)
    dataset = campaign(coefficients={"eps_c": 0.4, "eps_f": 6.0, "eps_t": 0.0}, realisations=15)
    dataset["kappa"] = dataset["kappa"] + spread * rng.standard_normal(dataset["kappa"].shape)
    fixed = {"eps_c": 1.1, "eps_f": 0.6}
    why = "touches the bounds" if spread else "has no influence"
    assert_refused(
        fit_tfc(dataset, fixed=fixed, bootstrap=60),
        f"exponent of eps_t {'with' if spread else why}",
        why,
        "levels 1, 1/2, 1/4, 1/8",
        "15 realisations",
        "`gfmd fit --fixed eps_t=1`",
        "`fit: {fixed: {eps_t: [1/2, 1]}}`",
        "fixed={'eps_t': (0.5, 1.0)}",
    )
    rescued = fit_tfc(dataset, fixed=fixed | {"eps_t": 1.0}, bootstrap=60)
    assert rescued["fit_status"] == "ok"
    assert abs(rescued["kappa_tfc"] - 2.0) < 5 * rescued["kappa_tfc_error"] + 1e-9


def test_an_exponent_known_only_to_a_factor_of_ten_is_refused():
    rng = np.random.default_rng(8)
    dataset = campaign(alpha=ALPHA | {"eps_t": 0.8}, realisations=30)
    dataset["kappa"] = dataset["kappa"] + 0.16 * rng.standard_normal(dataset["kappa"].shape)
    fit = fit_tfc(dataset, fixed={"eps_c": 1.1, "eps_f": 0.6}, bootstrap=150)
    assert_refused(fit, "exponent of eps_t with 90 % interval 0.1", "uncertain by more than a factor 8")
    mean = dataset["kappa"].mean("realisation")
    dataset["kappa"] = mean + 0.2 * (dataset["kappa"] - mean)
    assert fit_tfc(dataset, fixed={"eps_c": 1.1, "eps_f": 0.6}, bootstrap=150)["fit_status"] == "ok"


def test_one_doubtful_exponent_refuses_every_group_that_shares_it():
    dataset = noisy(campaign((0.3, 0.8), coefficients=C | {"eps_t": 0.0}, realisations=10), np.random.default_rng(1))
    fit = fit_tfc(dataset, bootstrap=30)
    assert_refused(fit, "exponent of eps_t")
    assert "exponent of eps_t" in fit["message"].values[1]


def test_two_levels_need_a_fixed_exponent():
    dataset = campaign(levels=LEVELS | {"eps_t": [1, 1 / 2]})
    assert_refused(fit_tfc(dataset, bootstrap=5), "eps_t needs three levels, has two (1, 1/2)", "fixed={'eps_t'")
    fit = fit_tfc(dataset, fixed={"eps_t": 1.0}, bootstrap=5)
    np.testing.assert_allclose(fit["kappa_tfc"], 2.0, atol=1e-8)


def test_a_limit_that_is_not_varied_is_named_and_left_in_the_result():
    fit = fit_tfc(campaign(levels={"eps_c": LEVELS["eps_c"], "eps_f": LEVELS["eps_f"]}), bootstrap=5)
    assert fit["fit_status"] == "ok"
    assert fit["message"] == "eps_t is not varied: kappa_tfc is not extrapolated in it"
    np.testing.assert_allclose(fit["kappa_tfc"], 2.0 + 0.3 / 2, atol=1e-8)
    assert np.isnan(fit["C"].sel(limit="eps_t"))


def test_no_limit_varied_is_refused():
    assert_refused(fit_tfc(campaign(levels={}), bootstrap=5), "no discretisation is varied")


def test_limits_varied_together_are_refused():
    dataset = campaign(levels={"eps_c": LEVELS["eps_c"]})
    dataset = dataset.assign_coords(eps_t=dataset["eps_c"] / 2)
    assert_refused(fit_tfc(dataset, bootstrap=5), "3 cases cannot tell eps_c, eps_t apart")


def test_a_single_realisation_has_no_sampling_error():
    fit = fit_tfc(campaign(realisations=1))
    assert fit["fit_status"] == "ok"
    np.testing.assert_allclose(fit["kappa_tfc"], 2.0, atol=1e-8)
    assert np.isnan(fit["kappa_tfc_error"])
    assert np.isnan(fit["kappa_tfc_low"])
    assert "sampling error is unknown (1 realisation," in fit["message"].item()


def test_roughness_at_nyquist_is_left_out_by_default():
    dataset = campaign(levels=LEVELS | {"eps_c": [1, 1 / 2, 1 / 4, 1 / 8]})
    dataset["kappa"][dataset["eps_c"].values == 1] += 0.3
    fit = fit_tfc(dataset, bootstrap=5)
    np.testing.assert_allclose(fit["kappa_tfc"], 2.0, atol=1e-8)
    assert fit["n_cases"] == 10
    kept = fit_tfc(dataset, omit_nyquist=False, bootstrap=5)
    assert kept["n_cases"] == 11
    assert abs(kept["kappa_tfc"] - 2.0) > 1e-3


def test_a_reference_at_nyquist_is_fitted_and_said():
    dataset = campaign(levels={name: LEVELS[name] for name in ("eps_f", "eps_t")})
    dataset["eps_c"][:] = 1.0
    fit = fit_tfc(dataset, bootstrap=5)
    np.testing.assert_allclose(fit["kappa_tfc"], 2.0 + 0.4 * 0.5**1.1, atol=1e-8)
    assert fit["message"].item().startswith("eps_c = 1 is fitted as well")


def test_each_group_carries_the_mean_of_its_reference_case():
    dataset = noisy(campaign((0.3, 0.8), realisations=9), np.random.default_rng(3))
    backwards = dataset.isel(case=slice(None, None, -1))
    fit = fit_tfc(backwards, fixed=ALPHA, bootstrap=5)
    for group in range(2):
        values = dataset["kappa"].where(dataset["hurst"] == fit["hurst"][group]).where(dataset["is_reference"])
        values = values.dropna("case", how="all")[0]
        np.testing.assert_allclose(fit["reference"][group], values.mean())
        np.testing.assert_allclose(fit["reference_error"][group], values.std(ddof=1) / 3)
    assert fit["reference_eps"][0].values.tolist() == list(REFERENCE.values())


def test_of_several_references_the_finest_counts():
    """An eps in the grid of a campaign makes each of its values a reference with limits of its own."""
    coarse = campaign((0.3, 0.8), levels=LEVELS | {"eps_c": [1 / 2]})
    names = np.char.add(coarse["case_id"].values, "-fine")
    fine = coarse.assign_coords(eps_c=coarse["eps_c"] / 4, case_id=("case", names))
    fine["kappa"] += 0.4 * ((1 / 8) ** 1.1 - (1 / 2) ** 1.1)
    for order in ([coarse, fine], [fine, coarse]):
        both = xr.concat(order, "case")
        fit = fit_tfc(both, fixed=ALPHA, bootstrap=5)
        assert fit["reference_eps"].sel(limit="eps_c").values.tolist() == [1 / 8, 1 / 8]
        expected = np.array([3.0, 2.0]) + 0.4 * (1 / 8) ** 1.1 + 6 * (1 / 1024) ** 0.6 + 0.15
        np.testing.assert_allclose(fit["reference"], expected)
        np.testing.assert_allclose(fit["kappa_tfc"] + fit["correction"].sum("limit"), expected)
        assert set(select_limit(both, "eps_f")["eps_c"].values) == {1 / 8}


@pytest.mark.parametrize("lacking", ["is_reference", "case_id", "eps_t"])
def test_a_dataset_that_is_no_campaign_is_named(lacking):
    with pytest.raises(ValueError, match="given no campaign's results"):
        fit_tfc(campaign().drop_vars(lacking))
    with pytest.raises(ValueError, match="given no campaign's results"):
        fit_tfc(campaign().isel(case=0))


def test_only_complete_realisations_are_fitted():
    whole = noisy(campaign((0.3, 0.8), realisations=12), np.random.default_rng(9))
    broken = fails(whole, case=7, realisation=3)
    broken["kappa"][5, 4] = np.nan
    fit = fit_tfc(broken, exponents="free", fixed=ALPHA, bootstrap=40)
    assert fit["n_excluded"].values.tolist() == [2, 0]
    assert fit["n_realisations"].values.tolist() == [10, 12]
    assert fit["n_cases"].values.tolist() == [10, 10]
    assert fit["message"].values.tolist() == ["2 of 12 realisations dropped, not good in every case", ""]
    rest = whole.isel(realisation=np.delete(np.arange(12), [3, 4]))
    for row, same in enumerate((rest, whole)):
        expected = fit_tfc(same, exponents="free", fixed=ALPHA, bootstrap=0)
        for name in ("kappa_tfc", "C", "chi2"):
            np.testing.assert_allclose(fit[name][row], expected[name][row], rtol=1e-12)


def test_bootstrap_of_incomplete_groups_scatters_as_if_the_rest_had_never_been_run():
    whole = noisy(campaign((0.3, 0.8), realisations=30), np.random.default_rng(13))
    broken = fails(whole, case=5, realisation=slice(0, 10))
    few, all_of_them = (fit_tfc(data, fixed=ALPHA, bootstrap=400)["kappa_tfc_error"] for data in (broken, whole))
    expected = fit_tfc(whole.isel(realisation=slice(10, 30)), fixed=ALPHA, bootstrap=400)["kappa_tfc_error"]
    np.testing.assert_allclose(few[0], expected[0], rtol=0.15)
    np.testing.assert_allclose(few[1], all_of_them[1], rtol=1e-12)


def test_a_case_that_mostly_failed_is_left_out_by_name():
    dataset = noisy(campaign(realisations=12), np.random.default_rng(9))
    fit = fit_tfc(fails(dataset, case=2, realisation=slice(0, 7)), fixed=ALPHA, bootstrap=5)
    case = "eps_c = 1/8, eps_f = 1/1024, eps_t = 1/2"
    assert fit["message"] == f"left out, failed in more than half of the realisations: {case}"
    assert (fit["n_cases"], fit["n_realisations"], fit["n_excluded"]) == (9, 12, 7)
    half = fit_tfc(fails(dataset, case=2, realisation=slice(0, 6)), fixed=ALPHA, bootstrap=5)
    assert (half["n_cases"], half["n_realisations"], half["n_excluded"]) == (10, 6, 6)


def test_realisations_not_run_yet_are_no_failures_of_single_cases():
    dataset = campaign(realisations=12)
    dataset["kappa"][:, 4:] = np.nan
    fit = fit_tfc(dataset, bootstrap=5)
    np.testing.assert_allclose(fit["kappa_tfc"], 2.0, atol=1e-8)
    assert (fit["n_cases"], fit["n_realisations"], fit["message"]) == (10, 4, "")


def test_a_group_without_a_complete_realisation_is_refused():
    dataset = campaign(realisations=4)
    for realisation in range(4):
        dataset = fails(dataset, case=realisation, realisation=realisation)
    assert_refused(fit_tfc(dataset, bootstrap=5), "no realisation is good in all 10 cases")


def test_a_group_with_one_complete_realisation_has_no_sampling_error():
    dataset = noisy(campaign((0.3, 0.8), realisations=4), np.random.default_rng(12), spread=0.01)
    for realisation in range(3):
        dataset = fails(dataset, case=realisation, realisation=realisation)
    fit = fit_tfc(dataset, fixed=ALPHA, bootstrap=40)
    assert fit["n_realisations"].values.tolist() == [1, 4]
    assert np.isnan(fit["kappa_tfc_error"]).values.tolist() == [True, False]
    assert "sampling error is unknown (1 realisation," in fit["message"].values[0]


def test_missing_results_do_not_break_the_pairing():
    """A case that lost realisations with large offsets must not inherit the offset of those that remain."""
    rng = np.random.default_rng(10)
    dataset = campaign(realisations=20)
    offset = 10 * rng.standard_normal(20)
    dataset["kappa"] = dataset["kappa"] + offset + 0.001 * rng.standard_normal(dataset["kappa"].shape)
    broken = fails(dataset, case=2, realisation=np.argsort(offset)[10:])
    fit = fit_tfc(broken, fixed=ALPHA, bootstrap=0)
    assert fit["n_cases"] == 10
    np.testing.assert_allclose(fit["C"].values[0], list(C.values()), rtol=0.05)


def test_a_case_that_failed_entirely_is_left_out_by_name():
    dataset = fails(campaign(realisations=6), case=4)
    fit = fit_tfc(dataset, bootstrap=5)
    assert fit["message"] == "left out, no good realisation: eps_c = 1/2, eps_f = 1/512, eps_t = 1/2"
    np.testing.assert_allclose(fit["kappa_tfc"], 2.0, atol=1e-8)
    assert fit["n_cases"] == 9
    assert fit["n_excluded"] == 6


def test_a_failed_reference_still_fixes_where_corrections_are_quoted():
    fit = fit_tfc(fails(campaign(levels=LEVELS | {"eps_t": [1, 1 / 4, 1 / 8]}), case=0), bootstrap=5)
    np.testing.assert_allclose(fit["kappa_tfc"], 2.0, atol=1e-8)
    np.testing.assert_allclose(fit["correction"].sel(limit="eps_t"), 0.15, rtol=1e-7)


def test_a_group_that_failed_entirely_does_not_take_the_others_along():
    dataset = campaign((0.3, 0.8))
    dataset = fails(dataset, case=np.flatnonzero(dataset["hurst"].values == 0.3))
    fit = fit_tfc(dataset, bootstrap=5)
    assert fit["fit_status"].values.tolist() == ["refused", "ok"]
    np.testing.assert_allclose(fit["kappa_tfc"][1], 2.0, atol=1e-8)


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"variable": "kapa"}, "no variable 'kapa'"),
        ({"exponents": "both"}, "'shared' or 'free'"),
        ({"fixed": {"eps_x": 1.0}}, "eps_x"),
        ({"fixed": {"eps_c": -1.0}}, "positive"),
        ({"fixed": {"eps_c": np.nan}}, "positive"),
        ({"fixed": {"eps_c": (0.0, 1.0)}}, "positive"),
        ({"fixed": {"eps_c": (1.0, 0.5)}}, r"not 'eps_c': \(1.0, 0.5\)"),
        ({"fixed": {"eps_c": (1.0, np.inf)}}, "positive"),
        ({"fixed": {"eps_c": (0.5, 0.7, 1.0)}}, r"\(low, high\)"),
        ({"fixed": {"eps_c": "1.0"}}, "not 'eps_c': '1.0'"),
    ],
)
def test_wrong_options_are_named(options, match):
    with pytest.raises(ValueError, match=match):
        fit_tfc(campaign(), **options)


def test_result_survives_netcdf(tmp_path):
    fit = fit_tfc(campaign((0.3, 0.8)), fixed={"eps_t": 1.0}, bootstrap=5)
    fit.to_netcdf(tmp_path / "fit.nc")
    with xr.open_dataset(tmp_path / "fit.nc") as again:
        np.testing.assert_array_equal(again["kappa_tfc"], fit["kappa_tfc"])
        assert again.attrs["fixed"] == "eps_t: 1"
        assert again.attrs["variable"] == "kappa"
        assert again["fit_status"].values.tolist() == ["ok", "ok"]


def test_select_limit_orders_from_coarse_to_fine_and_includes_the_reference():
    chosen = select_limit(campaign((0.8,)).isel(case=slice(None, None, -1)), "eps_t")
    assert chosen["eps_t"].values.tolist() == [1, 1 / 2, 1 / 4, 1 / 8]
    assert chosen["is_reference"].values.tolist() == [False, True, False, False]
    assert set(chosen["eps_c"].values) == {1 / 2}
    with pytest.raises(ValueError, match="unknown limit 'eps_x'"):
        select_limit(campaign(), "eps_x")


def ragged(dataset, **counts):
    """Leave each limit the number of realisations given for it."""
    asked = np.array([counts.get(str(limit), dataset.sizes["realisation"]) for limit in dataset["limit"].values])
    kept = np.arange(dataset.sizes["realisation"]) < asked[:, None]
    values = dataset["kappa"].where(kept)
    return dataset.assign(kappa=values).assign_coords(realisations=("case", asked))


def test_limits_with_fewer_realisations_lose_little_and_stay_unbiased():
    """Fine levels only have to tell their difference from the reference: they need fewer surfaces."""
    estimates, errors = [], []
    for seed in range(60):
        whole = noisy(campaign(realisations=120), np.random.default_rng(seed), own=0.01)
        designs = whole, ragged(whole, eps_c=10), whole.isel(realisation=slice(10))
        fits = [fit_tfc(design, fixed=ALPHA, bootstrap=40 if seed < 10 else 0) for design in designs]
        estimates.append([fit["kappa_tfc"].item() for fit in fits])
        errors.append([fit["kappa_tfc_error"].item() for fit in fits])
    scatter = np.std(estimates, axis=0, ddof=1)
    assert np.abs(np.mean(estimates, axis=0) - TFC[0.8] < 3 * scatter / np.sqrt(60)).all()
    assert scatter[1] < 1.5 * scatter[0]
    assert scatter[2] > 2.0 * scatter[0]  # ten surfaces everywhere
    stated = np.nanmean(errors, axis=0)
    np.testing.assert_allclose(stated[:2], scatter[:2], rtol=0.3)
    assert fits[1]["n_realisations"] == 10


def test_the_order_of_a_ragged_design_does_not_matter():
    whole = noisy(campaign(realisations=20), np.random.default_rng(3))
    design = ragged(whole, eps_c=5, eps_t=8)
    turned = design.isel(case=slice(None, None, -1))
    first, second = (fit_tfc(each, fixed=ALPHA, bootstrap=0)["kappa_tfc"] for each in (design, turned))
    np.testing.assert_allclose(first, second, rtol=1e-10)


def test_what_shared_surfaces_have_alike_is_no_slope():
    values = np.random.default_rng(1).standard_normal((12, 2))
    values[:4, 0], values[4:, 1] = 0.1, np.nan  # areas of few nodes: four surfaces have the same
    covariance = covariance_of_one(values)
    assert np.linalg.cond(covariance) < 100
    np.testing.assert_allclose(np.diag(covariance), np.nanvar(values, axis=0, ddof=1), rtol=1e-6)


def test_a_failure_in_a_ragged_design_is_dropped_where_it_was_asked_for():
    design = ragged(noisy(campaign(realisations=20), np.random.default_rng(3)), eps_c=5)
    fit = fit_tfc(fails(design, case=0, realisation=2), fixed=ALPHA, bootstrap=5)
    assert fit["message"] == "1 of 20 realisations dropped, not good in every case"
    assert (fit["n_realisations"], fit["n_excluded"]) == (4, 1)
