"""Small mistakes in the fit of the limit, each of which some test has to see: file, what stands there, what instead."""

PACKAGE = "gfmd_numba/analysis"

MUTANTS = [
    # the law from theory
    ("laws.py", "(2.0 - 2.0 * hurst) * (index", "(1.0 - 2.0 * hurst) * (index", "test_laws"),
    ("laws.py", "np.exp(tail * (index - cut))", "np.exp(tail * (cut - index))", "test_laws"),
    (
        "laws.py",
        "1.0 / np.sqrt(1.0 - unseen[same.ravel()]) - 1.0",
        "1.0 / (1.0 - unseen[same.ravel()]) - 1.0",
        "test_laws",
    ),
    ("laws.py", "unseen[same.ravel()]) - 1.0", "unseen[same.ravel()])", "test_laws"),
    ("laws.py", "_POINTS = 128", "_POINTS = 8", "test_laws"),
    ("laws.py", "if hursts[0] > STEEPEST", "if hursts[0] >= STEEPEST", "test_laws"),
    ("laws.py", "or not known or low == high", "or not known", "test_laws"),
    ("laws.py", "known = len(set(hursts)) == 1 and", "known =", "test_laws"),
    ("laws.py", "np.exp(alpha[:, :1] * np.log(eps))", "np.exp(alpha[:, :1] * eps)", "test_laws"),
    ("laws.py", "return self.logarithmic and (self.low", "return (self.low", "test_exponent_ranges"),
    # the quadrature
    ("posterior.py", "_FINE = {1: 25, 2: 21, 3: 15}", "_FINE = {1: 7, 2: 7, 3: 7}", "test_posterior"),
    ("posterior.py", "_UNLIKELY = 25.0", "_UNLIKELY = 2.0", "test_posterior"),
    ("posterior.py", "- misfit / 2.0\n", "- misfit\n", "test_posterior"),
    ("posterior.py", "log_volume - np.log(width).sum() - misfit", "log_volume - misfit", "test_posterior"),
    (
        "posterior.py",
        "np.log(weights / 2.0 * (right - left))",
        "np.log(0.0 * weights + right - left)",
        "test_posterior",
    ),
    (
        "posterior.py",
        "size = min((corrections[limit] for limit in pair), key=abs)",
        "size = max((corrections[limit] for limit in pair), key=abs)",
        "test_posterior",
    ),
    ("posterior.py", '("eps_f", "eps_t"): (1.0, 0.5)', '("eps_f", "eps_t"): (0.5, 0.5)', "test_posterior"),
    ("posterior.py", "_INTERACTION = (0.0, 0.5)", "_INTERACTION = (0.0, 1.0)", "test_posterior"),
    ("posterior.py", "whole = whole + column * _excess", "whole = whole + 0.9 * column * _excess", "test_posterior"),
    (
        "posterior.py",
        "columns.append(size * laws_of[first] * laws_of[second])",
        "columns.append(size * laws_of[first] * laws_of[first])",
        "test_posterior",
    ),
    ("posterior.py", "moving * (ratio - 1.0)", "moving * ratio", "test_posterior"),
    ("posterior.py", "coefficients[:, [row, *mine]]", "coefficients[:, [row]]", "test_posterior"),
    ("posterior.py", "change[:, row, 0] = around[:, 1]", "change[:, row, 0] = around[:, 2]", "test_posterior"),
    # estimates and errors
    ("tfc.py", "_TAIL = 0.05", "_TAIL = 0.1", "test_posterior"),
    ("tfc.py", "freedom = group.n_realisations - 1", "freedom = 10 * group.n_realisations", "test_posterior"),
    (
        "tfc.py",
        "error = np.sqrt(weight @ (variance + (value - estimate) ** 2))",
        "error = np.sqrt(weight @ variance)",
        "test_posterior",
    ),
    ("tfc.py", "estimate = likeliest + weight @ (value - likeliest)", "estimate = likeliest", "test_posterior"),
    ("tfc.py", "variance[:, 1 + row] * scale**2", "variance[:, 1 + row] * scale", "test_tfc"),
    (
        "tfc.py",
        "group.reference[name] ** -fit.exponents[:, row]\n        found.coefficient",
        "group.reference[name] ** fit.exponents[:, row]\n        found.coefficient",
        "test_tfc",
    ),
    (
        "tfc.py",
        "found.interaction[:, PAIRS.index(pair)] = fit.coefficients",
        "found.interaction[:, 0] = fit.coefficients",
        "test_interactions",
    ),
    ("tfc.py", "whitener=means.whitener / np.sqrt(factor)", "whitener=means.whitener / factor", "test_interactions"),
    # means and their covariance
    (
        "gauss_markov.py",
        "information[np.ix_(there, there)] += len(rows) * weight",
        "information[np.ix_(there, there)] += weight",
        "test_ragged_designs",
    ),
    ("gauss_markov.py", "(1.0 + contrasts / fewest)", "(1.0 + contrasts)", "test_interactions"),
    ("gauss_markov.py", "weight = n / (n + 2 * n_cases)", "weight = n / (n + n_cases)", "test_hard_fits"),
    ("gauss_markov.py", "max(0.05 * residual.mean()", "max(0.5 * residual.mean()", "test_hard_fits"),
    (
        "gauss_markov.py",
        "slope = joint[case, above] / variance[above, case]",
        "slope = joint[case, above] / variance[case, above]",
        "test_ragged_designs",
    ),
    (
        "gauss_markov.py",
        "unexplained = 1 - correlation[order[1:], closest] ** 2",
        "unexplained = 1 - correlation[order[1:], closest]",
        "test_ragged_designs",
    ),
    # the budget
    ("error_budget.py", "np.sqrt(scale * effect)", "np.sqrt(effect)", "test_error_budget"),
    ("error_budget.py", "np.sqrt(variance - sampling)", "np.sqrt(variance)", "test_error_budget"),
    ("error_budget.py", "if parameter.limit == limit]", "if parameter.limit != limit]", "test_error_budget"),
    ("error_budget.py", "weight @ influence - 0.5 *", "weight @ influence - 0.0 *", "test_error_budget"),
    # designs
    ("allocation.py", "(count - before) * np.linalg.inv", "count * np.linalg.inv", "test_cross_designs"),
    ("allocation.py", "_FEWEST = 20", "_FEWEST = 2", "test_cross_designs"),
    ("allocation.py", "return limit == CROSS or (limit in LIMITS", "return (limit in LIMITS", "test_cross_designs"),
    ("allocation.py", "len(left) > 2)", "len(left) > 0)", "test_cross_designs"),
    (
        "allocation.py",
        "known = np.diag(ensemble.known[: columns.shape[1]])",
        "known = 0.0 * np.diag(ensemble.known[: columns.shape[1]])",
        "test_cross_designs",
    ),
    (
        "allocation.py",
        "price[np.setdiff1d(number, fitted)] = np.inf",
        "price[np.setdiff1d(number, fitted)] = 0.1",
        "test_cross_designs",
    ),
    # which cases are fitted
    ("selection.py", "2 * n_present < n_run", "3 * n_present < n_run", "test_failed_cases"),
    (
        "selection.py",
        "(present | ~asked).all(axis=1) & present.any(axis=1)",
        "present.any(axis=1)",
        "test_failed_cases",
    ),
    ("selection.py", "axis=0).argmin()]", "axis=0).argmax()]", "test_tfc"),
    ("selection.py", "return eps_c >= 1 - 1e-9", "return eps_c > 1 + 1e-9", "test_tfc"),
    ("selection.py", "dropped = some.sum() - complete.sum()", "dropped = complete.sum()", "test_failed_cases"),
]
