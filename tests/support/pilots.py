"""What a pilot says of numbers of realisations, in one call."""

from gfmd_numba.analysis.allocation import Pilot


def cheapest_design(pilot, seconds, target, variable="kappa", fixed=None):
    return Pilot.of(pilot, variable, fixed or {}).cheapest_design(seconds, target)


def predictions(results, counts, variable="kappa", fixed=None):
    return Pilot.of(results, variable, fixed or {}).predictions(counts)
