"""What a pilot says of numbers of realisations, in one call."""

from types import SimpleNamespace

from gfmd_numba.analysis.allocation import Pilot


def cheapest_design(pilot, seconds, target, variable="kappa", fixed=None):
    """The realisations of each case, the error that the design promises for them, and what they cost."""
    known = Pilot.of(pilot, variable, fixed or {})
    realisations = known.cheapest_design(seconds, target)
    error = max(each.error * each.caution for each in known.predictions(realisations))
    return SimpleNamespace(realisations=realisations, error=error, seconds=realisations @ seconds)


def predictions(results, counts, variable="kappa", fixed=None):
    return Pilot.of(results, variable, fixed or {}).predictions(counts)
