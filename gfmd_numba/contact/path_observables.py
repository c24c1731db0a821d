"""The table of what a loading path records, in addition to the observables of each of its contacts; pure data."""

from typing import Literal

from gfmd_numba.contact.observables import Observable
from gfmd_numba.scene import Scene

PATH_OBSERVABLES = {  # those of the contact at every step, those of the path once; `path_measures` finds them
    "mean_tangential_traction": Observable(
        "contact", "pressure", "mean tangential traction along x of the punch on the body"
    ),
    "mean_tangential_traction_y": Observable(
        "contact", "pressure", "mean tangential traction along y of the punch on the body"
    ),
    "stick_fraction": Observable(
        "contact",
        "1",
        "touching nodes that stick over all touching nodes",
        undefined_at_times=True,
    ),
    "energy_lost": Observable(
        "contact",
        "energy",
        "work since the last step less stored energy, per area; of friction, what slipping nodes lose",
    ),
    "hysteresis": Observable(
        "path", "energy", "energy lost along the path per area, of a closed path the area of its loop"
    ),
    "pull_off_pressure": Observable(
        "path",
        "pressure",
        "largest mean tension while the punch is withdrawn, unknown where the path ends before it falls",
        undefined_at_times=True,
    ),
}
_NEEDS: dict[str, Literal["drag", "drag of maps", "friction", "loss", "tension"]] = {
    "mean_tangential_traction": "drag",
    "mean_tangential_traction_y": "drag of maps",
    "stick_fraction": "friction",
    "energy_lost": "loss",
    "hysteresis": "loss",
    "pull_off_pressure": "tension",
}


def recorded_along(scene: Scene, order: int = 0) -> dict[str, Observable]:
    """The rows for a path of a scene, followed to an order in the slope of its bodies: those of effects that it has.

    The energy is known of flat bodies, and of rough or two elastic bodies where order 0 is all there is. What a
    hardness takes where nothing attracts is plastic work, which is always known.
    """
    interface = scene.interface
    higher_orders = scene.follows_topography and (order > 0 or not interface.couples)
    attracts = any(getattr(law, "work_of_adhesion", 0.0) > 0.0 for law in interface.laws.values())
    has = {
        "drag": interface.couples,
        "drag of maps": interface.couples and scene.dimension == 2,
        "friction": interface.friction is not None,
        "loss": ((interface.couples or attracts) and not higher_orders)
        or (interface.hardness is not None and not attracts),
        "tension": attracts and scene.loading.displacement is not None,
    }
    return {name: row for name, row in PATH_OBSERVABLES.items() if has[_NEEDS[name]]}
