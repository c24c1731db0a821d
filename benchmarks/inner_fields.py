"""Fields inside bodies below loaded profiles, each by its name."""

from types import SimpleNamespace

from gfmd_numba.elasticity.fields import Inside

NAMES = ("u1", "u3", "strain1", "strain3", "strain5", "stress1", "stress2", "stress3", "stress5")


def inside(surface, z, body):
    """Fields `[z, x]` of a profile."""
    return SimpleNamespace(**dict(zip(NAMES, Inside((surface,), body).section(z, NAMES), strict=True)))
