"""The table of what a loading path records, in addition to the observables of each of its contacts; pure data."""

from collections.abc import Collection
from typing import Literal

from gfmd_numba.contact.observables import OBSERVABLES, Observable
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
LIMITED = {name: row for name, row in (OBSERVABLES | PATH_OBSERVABLES).items() if not row.without_limit}
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


def needed_for(name: str) -> str:
    """What a path needs to have a quantity that is recorded along it."""
    return {
        "drag": "a punch is dragged against friction or a law that holds sideways",
        "drag of maps": "a punch is dragged along y on a map, against friction or a law that holds sideways",
        "friction": "nodes stick or slip where there is friction",
        "loss": "energy is lost by friction or attraction, and not known with a boundary or at a topography_order "
        "above 0",
        "tension": "a punch is pulled off against attraction by a prescribed displacement",
    }[_NEEDS[name]]


def why_no_limit(name: str) -> str:
    """Why a recorded quantity never has a limit, as a clause with its name; nothing of any other name."""
    row = (OBSERVABLES | PATH_OBSERVABLES).get(name)
    return f"{name} has no limit, because {row.without_limit}" if row is not None and row.without_limit else ""


def unheld(row: Observable, scene: Scene, varied: Collection[str]) -> str:
    """Why a quantity becomes 0 or infinite in the limits of a scene that are varied; nothing where it does not.

    With heights or gradients fixed, self-affine roughness keeps one of the two while eps_f and eps_t go to 0. A
    hardness is a pressure, which has to keep its ratio to g E*.
    """
    if not {"eps_f", "eps_t"} & set(varied):
        return ""
    by_height = any(getattr(surface, "rms_height", None) is not None for surface in scene.surfaces.values())
    control, held = scene.loading.control, row.held
    if held in ("", "load") and scene.interface.hardness is not None:
        held = "gradient"
    grows = "with a fixed rms_height the gradient g grows without bound as eps_f and eps_t go to 0"
    if held == "gradient" and by_height:
        return f"{grows}; give the roughness an rms_gradient"
    if held == "load" and by_height and control != "reduced_pressure":
        return f"{grows}, and p / (g E*) falls to 0; give the roughness an rms_gradient"
    if by_height and control == "reduced_pressure" and row.unit in ("pressure", "energy", "height"):
        return "with a fixed rms_height and reduced_pressure the pressure grows with the gradient; give a pressure"
    if held != "height":
        return ""
    if not by_height:
        return (
            "with a fixed rms_gradient the heights vanish as eps_f and eps_t go to 0; give the roughness an rms_height "
            "and the load as a pressure, and vary eps_c and eps_f alone"
        )
    if "eps_t" in varied:
        return (
            "with a fixed rms_height the roughness becomes ever steeper as eps_t goes to 0; give a reference, and "
            "limits without eps_t"
        )
    return ""
