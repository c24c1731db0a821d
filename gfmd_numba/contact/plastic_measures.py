"""Observables of plastic flow inside a body; `plastic_flow.py` has its state. Strains in g, stresses in g E*."""

from collections.abc import Callable
from typing import Any

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.plastic_flow import PlasticState, plastic_state, stresses
from gfmd_numba.contact.state import Contact


def _of_state(measure: Callable[[PlasticState], Any]) -> Callable[[Contact], Reals]:
    """Return an observable `[realisation]` from a number of the plastic state."""
    return lambda contact: np.array([float(measure(plastic_state(contact)))])


plastic_volume = _of_state(lambda state: state.body.waves.thickness @ (state.equivalent > 0.0).mean(axis=(1, 2)))
largest_plastic_strain = _of_state(lambda state: state.equivalent.max())
plastic_strain_at_base = _of_state(lambda state: state.equivalent[-1].max())
flow_residual = _of_state(lambda state: state.residual)
increment_error = _of_state(lambda state: state.error)


def largest_von_mises(contact: Contact) -> Reals:
    """Largest equivalent stress `[realisation]`."""
    return np.array([float(stresses(contact)[0].max())])
