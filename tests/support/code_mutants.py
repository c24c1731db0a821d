"""Small mistakes in the fit of the limit: file, what stands there, what instead, and the test that sees it."""

PACKAGE = "gfmd_numba/analysis"

MUTANTS = [
    # the law from theory
    (
        "laws.py",
        "(2.0 - 2.0 * hurst) * (index",
        "(1.0 - 2.0 * hurst) * (index",
        "test_laws.py::test_the_share_that_is_not_seen_is_that_of_the_spectrum",
    ),
    (
        "laws.py",
        "np.exp(alpha[:, :1] * np.log(eps))",
        "np.exp(alpha[:, :1] * eps)",
        "test_laws.py::test_a_power_is_that_of_thesis_4_3",
    ),
    (
        "laws.py",
        "return self.logarithmic and (self.low",
        "return (self.low",
        "test_exponent_ranges.py::test_a_range_as_wide_as_what_is_searched_is_a_range",
    ),
    # the quadrature
    (
        "exponent_posterior.py",
        "log_volume - chi2 / 2.0",
        "log_volume - chi2",
        "test_posterior.py::test_groups_that_share_exponents_weigh_them_together",
    ),
    (
        "exponent_posterior.py",
        "start=-2.0 * log_density",
        "start=np.zeros(len(nodes))",
        "test_posterior.py::test_two_laws_count_by_how_well_each_fits_over_its_ranges",
    ),
    (
        "exponent_posterior.py",
        "* each + means.of_pairs(limit, each, coefficients)",
        "* each",
        "test_posterior.py::test_a_curve_passes_through_the_fit_of_each_case",
    ),
    # estimates and errors
    (
        "extrapolation.py",
        "coefficients[:, 1 + row] * scale**power",
        "coefficients[:, 1 + row] * scale",
        "test_tfc.py::test_a_huge_offset_common_to_all_levels_leaves_the_coefficients_alone",
    ),
    (
        "extrapolation.py",
        'found["interaction"][:, number] = coefficients',
        'found["interaction"][:, 0] = coefficients',
        "test_interactions.py::test_one_cross_level_leaves_the_other_pairs_open",
    ),
    (
        "gauss_markov.py",
        "whitener=means.whitener / np.sqrt(factor)",
        "whitener=means.whitener / factor",
        "test_interactions.py::test_the_error_of_one_limit_is_that_of_its_estimate_in_each_realisation",
    ),
    # means and their covariance
    (
        "gauss_markov.py",
        "information[np.ix_(there, there)] += len(rows) * weight",
        "information[np.ix_(there, there)] += weight",
        "test_tfc.py::test_planted_parameters_are_recovered_exactly",
    ),
    (
        "gauss_markov.py",
        "unexplained = 1 - correlation[order[1:], closest] ** 2",
        "unexplained = 1 - correlation[order[1:], closest]",
        "test_ragged_designs.py::test_the_order_of_a_ragged_design_does_not_matter",
    ),
    # the budget
    (
        "limit_errors.py",
        "np.sqrt(scale * effect)",
        "np.sqrt(effect)",
        "test_error_budget.py::test_the_parts_in_quadrature_are_the_whole_error",
    ),
    (
        "limit_errors.py",
        "weight @ influence - 0.5 *",
        "weight @ influence - 0.0 *",
        "test_error_budget.py::test_the_part_of_the_residual_is_the_most_that_the_means_can_add_up_to[ranges]",
    ),
    (
        "limit_errors.py",
        "np.where(np.isfinite(prior_std), 0.0, np.inf)",
        "prior_std",
        "test_error_budget.py::test_with_exact_exponents_all_is_sampling_and_interactions",
    ),
    # whether any law fits
    (
        "gauss_markov.py",
        "form = weights @ scatter",
        "form = weights @ weights",
        "test_goodness_of_fit.py::test_chi2_is_judged_by_the_scatter_of_the_means",
    ),
    # designs
    (
        "allocation.py",
        "np.diag(ensemble.prior_precision[: columns.shape[1]])",
        "0.0 * np.diag(ensemble.prior_precision[: columns.shape[1]])",
        "test_cross_designs.py::test_a_cheap_cross_level_is_kept_and_one_that_costs_much_and_tells_little_is_not",
    ),
    (
        "allocation.py",
        "shares = _without_dear_levels(choice, shares, target)\n",
        "shares = shares\n",
        "test_cheap_designs.py::test_a_larger_error_costs_no_more",
    ),
    # which cases are fitted
    (
        "selection.py",
        "2 * n_present < n_run",
        "3 * n_present < n_run",
        "test_failed_cases.py::test_a_case_that_mostly_failed_is_left_out_by_name",
    ),
    (
        "selection.py",
        "(present | ~asked).all(axis=1) & present.any(axis=1)",
        "present.any(axis=1)",
        "test_failed_cases.py::test_a_group_without_a_complete_realisation_is_refused",
    ),
]
