"""Made-up campaigns whose kappa goes to its limit as contacts see more of the slope."""

import numpy as np
from scipy.integrate import quad

from support.synthetic_campaigns import REFERENCE, TFC, WANING_OF_KAPPA, with_axes

MEASURED = {0.5: (3.7, 0.71), 0.8: (8.9, 0.57), 0.9: (13.0, 0.55), 1.0: (19.2, 0.54)}  # k_c and m at p* = 0.007


def factor(hurst, eps):
    """1 / sqrt(1 - S), of a spectrum of slopes k^(1 - 2 H) up to 1 / eps."""
    (cut, tail), steepness, end = MEASURED[hurst], 2 - 2 * hurst, -np.log(eps)
    seen = quad(lambda q: np.exp(steepness * q) / (1 + (cut * np.exp(-q)) ** tail), 0, end, limit=200)[0]
    return (quad(lambda q: np.exp(steepness * q), 0, end)[0] / seen) ** 0.5


def of_unseen_slope(dataset, hurst):
    """The campaign with that law in place of the power of eps_f, whose coefficient is 6 and exponent 0.6."""
    eps = dataset["eps_f"].values
    law = np.array([factor(hurst, each) for each in eps]) - 1.0
    at = factor(hurst, REFERENCE["eps_f"]) - 1.0
    power = eps**0.6
    waning = dataset["kappa"].values[:, 0] - TFC[0.8] - 6.0 * power - 0.4 * dataset["eps_c"].values ** 1.1
    waning = waning * (law / at * REFERENCE["eps_f"] ** 0.6 / power) ** WANING_OF_KAPPA
    kappa = TFC[0.8] * (1.0 + law) + 0.4 * dataset["eps_c"].values ** 1.1 + waning
    dataset = dataset.assign_coords(hurst=("case", np.full(dataset.sizes["case"], hurst)))
    return with_axes(dataset.assign(kappa=dataset["kappa"] * 0.0 + kappa[:, np.newaxis]))
