"""Surfaces in netCDF files are tried in a fork, which is quicker than a new process."""

from support.forked_trial import tried_in_a_fork  # noqa: F401
