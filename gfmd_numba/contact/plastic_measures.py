"""What has flowed inside a body: the state of the process, and what is measured of it.

Strains are in g, stresses in g E*, thicknesses in L_x.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.evaluation import once
from gfmd_numba.contact.state import Change, Contact, LoadStep, Process, State
from gfmd_numba.elasticity.eigenstrain import Sublayers
from gfmd_numba.elasticity.fields import von_mises

NAME = "flow"


@dataclass(frozen=True)
class Flow:
    """What has flowed in a body: plastic strains `[component, sublayer, y, x]`, and the equivalent one of all steps.

    The surface has moved by `out` `[realisation, (y,) x]` on its own. The yield condition and the flow rule hold to a
    `residual` times the yield stress. With half the increments, the mean pressure or residual displacement would change
    by an `error`, not-a-number where it is not known.
    """

    body: Sublayers
    strain: Reals
    equivalent: Reals
    out: Reals
    residual: float = 0.0
    error: float = np.nan

    @classmethod
    def untouched(cls, body: Sublayers, shape: tuple[int, ...]) -> "Flow":
        """Nothing has flowed below a surface of a shape `[realisation, (y,) x]`."""
        equivalent = np.zeros((body.waves.thickness.size, *body.shape))
        return cls(body, np.zeros((body.components, *equivalent.shape)), equivalent, np.zeros(shape))


@dataclass(frozen=True)
class PlasticFlow(Process):
    """The process: it remembers the flow, which `plastic_flow.follow` has found."""

    name: ClassVar[str] = NAME

    def begin(self, shape: tuple[int, ...]) -> Flow | None:
        """Nothing has flowed, and how deep it will is not known."""
        return None

    def change(self, state: State, step: LoadStep) -> Change:
        """The surface has moved by what has flowed."""
        flow: Flow | None = state.memory[NAME]
        return Change(normal_offset=None if flow is None else flow.out)


def flow_of(contact: Contact) -> Flow:
    """What has flowed by the end of the step of a contact."""
    flow: Flow = contact.after.memory[NAME]
    return flow


def equivalent(tensor: Reals) -> Reals:
    """Equivalent stress `[sublayer, y, x]` of a deviatoric one `[component, sublayer, y, x]`.

    Of a strain it is 1.5 times the equivalent strain.
    """
    xx, zz, *shear = tensor
    return von_mises(xx, -xx - zz, zz, *shear)


@once
def stresses(contact: Contact) -> Reals:
    """Equivalent stress and that along x in the body under a contact, means of sublayers `[2, sublayer, y, x]`."""
    flow = flow_of(contact)
    flow.body.surface_displacement(flow.strain)
    *strains, normal = flow.body.strains(contact.equilibrium.pressure[0].reshape(flow.body.shape), with_normal=True)
    deviator = 2.0 * flow.body.shear * (np.stack(strains) - flow.strain)
    return np.stack((equivalent(deviator), normal + deviator[0] - deviator[1]))


def _of_flow(measure: Callable[[Flow], Any]) -> Callable[[Contact], Reals]:
    """A number of what has flowed in each contact `[realisation]`."""
    return lambda contact: np.array([float(measure(flow_of(contact)))])


plastic_volume = _of_flow(lambda flow: flow.body.waves.thickness @ (flow.equivalent > 0.0).mean(axis=(1, 2)))
largest_plastic_strain = _of_flow(lambda flow: flow.equivalent.max())
plastic_strain_at_base = _of_flow(lambda flow: flow.equivalent[-1].max())
flow_residual = _of_flow(lambda flow: flow.residual)
increment_error = _of_flow(lambda flow: flow.error)


def largest_von_mises(contact: Contact) -> Reals:
    """Largest equivalent stress `[realisation]`."""
    return np.array([float(stresses(contact)[0].max())])
