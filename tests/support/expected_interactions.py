"""Interactions of limits as a fit expects them before any cross level tells."""

from itertools import combinations

from support.synthetic_campaigns import ALPHA, REFERENCE, WANING, C

SCATTER = 0.5
WANES = ("eps_f", "eps_t")  # the correction in eps_t is all interaction with eps_f
# of each limit at the reference, where the others are at theirs
CORRECTIONS = {name: c * REFERENCE[name] ** ALPHA[name] for name, c in C.items()}
CORRECTIONS["eps_f"] += sum(WANING["interactions"].values())


def drawn(rng):
    """Coefficients and interactions of a campaign, drawn from what is expected."""
    interactions = {
        pair: SCATTER * rng.standard_normal() * min(CORRECTIONS[name] for name in pair)
        for pair in combinations(CORRECTIONS, 2)
        if pair != WANES
    }
    left = SCATTER * rng.standard_normal() * CORRECTIONS["eps_t"]
    interactions[WANES] = CORRECTIONS["eps_t"] - left - interactions["eps_c", "eps_t"]
    coefficients = {
        name: (correction - sum(size for pair, size in interactions.items() if name in pair))
        / REFERENCE[name] ** ALPHA[name]
        for name, correction in CORRECTIONS.items()
    }
    return {"coefficients": coefficients, "interactions": interactions}
