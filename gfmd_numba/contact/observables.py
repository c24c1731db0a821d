"""The tables of observables of contacts, of rough bodies and of paths, with units and meaning.

Pure data, and functions that select the rows of a scene.
"""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any, Literal

from gfmd_numba.scene import Scene
from gfmd_numba.scene.measured_record import AXES

_ELSEWHERE = {"surface": "it tells of the surface alone", "run": "it tells of the computation alone"}
_OF_AN_ERROR = "it estimates an error, which vanishes with finer levels"
_MODULES = {"flow": "plastic_measures"}  # of functions, by what they need; all others stand in `evaluation`
_OF_A_LAYER = "it depends on the sublayers, of which limits know nothing"
# coordinates of what a loading prescribes; the fields of a contact have the short names
PRESCRIBED = {"displacement": "punch_displacement", "pressure": "prescribed_pressure"}
OF_PUNCH, OF_SUM = "of the punch", "of the sum of the heights"
OF_TOUCHING = {  # observables, and statistics of a contact, that there are only where nodes touch
    *("kappa", "kappa_counted", "kappa_edges", "kappa_r", "rms_gradient_contact", "n_segments", "contact_radius"),
    *("contact_area_fraction", "contact_area_fraction_counted", "contact_area_fraction_persson"),
    *("perimeter", "contact_connects", "largest_contact_fraction"),
}

Unit = Literal["1", "gradient", "length", "height", "pressure", "energy", "s"]


@dataclass(frozen=True)
class Observable:
    """A recorded quantity: its unit and meaning, and whether it is of the contact, the surface, the run or the path.

    Units are 1, g, L_x, g L_x, g E*, g^2 E* L_x and seconds. `function` is "module:function" of a contact, by default
    that of its name in `evaluation`, or in the module of what it `needs`; of a run the equilibrium has the number. One
    that is `undefined_at_times` may be not-a-number in a run that is ok: without contact it is 0/0, or unknown on maps.
    One is recorded where what it `needs` is there.

    `no_limit` says why what a contact has becomes 0 or infinite in the thermodynamic, fractal and continuum limit,
    however its roughness is scaled; nothing where it does not. `held` is what then has to stay fixed while eps_f and
    eps_t go to 0: the load p / (g E*), the gradient g, the rms height, or nothing ("").
    """

    unit: Unit
    long_name: str
    function: str | None = None
    of: Literal["contact", "surface", "run", "path"] = "contact"
    undefined_at_times: bool = False
    no_limit: str = ""
    held: Literal["", "load", "gradient", "height"] = ""
    needs: str = ""

    def function_of(self, name: str) -> str:
        """Name of its function, as "module:function"."""
        return self.function or f"gfmd_numba.contact.{_MODULES.get(self.needs, 'evaluation')}:{name}"

    @property
    def without_limit(self) -> str:
        """Why it never has a limit; nothing where it may have one."""
        return _ELSEWHERE.get(self.of, self.no_limit)


def _kappa(long_name: str) -> Observable:
    return Observable("1", f"area-load coefficient {long_name}", undefined_at_times=True, held="load")


def _of_flow(unit: Unit, long_name: str) -> Observable:
    return Observable(unit, long_name, needs="flow", no_limit=_OF_A_LAYER)


def _error(long_name: str, **others: Any) -> Observable:
    return Observable("1", long_name, undefined_at_times=True, no_limit=_OF_AN_ERROR, **others)


OBSERVABLES = {
    "kappa": _kappa("a_r g E* / p, contact area corrected for its edges"),
    "kappa_residual_error": _error("largest change of kappa to expect from the residual of the solver"),
    "kappa_counted": _kappa("a_r g E* / p, contact area as counted nodes"),
    "kappa_r": _kappa("a_r g_r E* / p with the rms gradient over the contact"),
    "contact_area_fraction": Observable(
        "1", "contact length over L_x, or area over L_x^2, corrected for its edges", held="load"
    ),
    "contact_area_fraction_counted": Observable("1", "touching nodes over all nodes", held="load"),
    "contact_area_fraction_error": _error("standard deviation of contact_area_fraction by edges between the nodes"),
    "plastic_area_fraction": Observable("1", "nodes at the hardness over all nodes", needs="hardness", held="gradient"),
    "mean_plastic_depth": Observable(
        "height", "mean depth by which the punch has been flattened", needs="hardness", held="height"
    ),
    "mean_worn_depth": Observable("height", "mean depth by which the punch has worn", needs="worn", held="height"),
    "plastic_volume": _of_flow("length", "volume of the body that has flowed over the nominal area"),
    "largest_plastic_strain": _of_flow("gradient", "largest equivalent plastic strain of a sublayer"),
    "plastic_strain_at_base": _of_flow("gradient", "largest equivalent plastic strain of the lowest sublayer"),
    "largest_von_mises": _of_flow("pressure", "largest von Mises stress of a sublayer"),
    "flow_residual": Observable(
        "1",
        "largest violation of the yield condition and the flow rule over the yield stress",
        needs="flow",
        no_limit=_OF_AN_ERROR,
    ),
    "increment_error": _error(
        "relative change of pressures or residual displacements with half the increments of the step", needs="flow"
    ),
    "time_error": Observable(
        "1",
        "relative error of pressures and displacements by the divisions of all steps so far",
        needs="divisions",
        no_limit=_OF_AN_ERROR,
    ),
    "hysteretic_friction": Observable(
        "gradient",
        "friction by hysteresis: force against the sliding of the punch along x, over the load",
        needs="sliding",
        held="height",
    ),
    "hysteretic_friction_error": Observable(
        "gradient",
        "difference from the force on the slopes of the punch over the load, an error of the grid",
        needs="sliding",
        no_limit=_OF_AN_ERROR,
    ),
    "kappa_edges": _kappa("a_r g E* / p, each contact edge located from the pressures next to it"),
    "kappa_edges_error": _error(
        "standard deviation of kappa_edges by stretches of too few nodes to locate their edges"
    ),
    "n_segments": Observable(
        "1",
        "number of separate stretches of contact, or clusters of a map",
        no_limit="contacts become ever more as eps_f and eps_t go to 0",
    ),
    "mean_segment_length": Observable(
        "1",
        "mean length of a stretch of contact over L_x, corrected for its edges",
        undefined_at_times=True,
        no_limit="contacts become ever smaller as eps_f and eps_t go to 0",
    ),
    "contact_radius": Observable(
        "length",
        "half the contact length of a profile, of a map the radius of a disc as large as the contact area",
        needs="form",
        held="load",
    ),
    "elastic_energy": Observable(
        "energy",
        "elastic energy per nominal area of the deformation by the punch, beyond uniform compression",
        held="height",
    ),
    "mean_pressure": Observable(
        "pressure",
        "mean contact pressure",
        no_limit="the loading prescribes it, or a displacement does, for which its laws are not known",
    ),
    "peak_pressure": Observable(
        "pressure",
        "largest contact pressure",
        no_limit="peaks become ever sharper and more as eps_f and eps_t go to 0, and the largest pressure grows",
    ),
    "mean_gap": Observable("height", "mean gap between the surfaces", held="height"),
    "approach": Observable(
        "height", "displacement of the punch into the body beyond first touch", needs="window", held="height"
    ),
    "edge_contact": Observable(
        "1",
        "touching nodes at the ends of the window over all nodes there",
        needs="window",
        no_limit="it says whether the window is too small",
    ),
    "rms_gradient": Observable("gradient", "rms gradient of the punch", of="surface"),
    "rms_gradient_contact": Observable(
        "gradient", "rms gradient of the punch over the contact", undefined_at_times=True, held="gradient"
    ),
    "nayak": Observable("1", "Nayak's parameter m0 m4 / m2^2 of the punch", needs="period", of="surface"),
    "full_contact_rms_pressure": Observable(
        "pressure", "rms fluctuation of the pressure in full contact, (sum_q K(q)^2 |h(q)|^2)^(1/2)", of="surface"
    ),
    "status": Observable("1", "how the run ended", of="run"),
    "residual": Observable(
        "1",
        "largest violation of the contact conditions over the largest pressure, or relative load imbalance",
        of="run",
    ),
    "n_iterations": Observable("1", "solver iterations", of="run"),
    "n_transforms": Observable("1", "fast Fourier transforms of the whole grid", of="run"),
    "wall_time": Observable("s", "time spent in the solver", of="run"),
}
PATH_OBSERVABLES = {  # those of the contact at every step, those of the path once; `PathRecord` finds them
    "mean_tangential_traction": Observable(
        "pressure", "mean tangential traction along x of the punch on the body", needs="drag along x"
    ),
    "mean_tangential_traction_y": Observable(
        "pressure", "mean tangential traction along y of the punch on the body", needs="drag along y"
    ),
    "stick_fraction": Observable(
        "1",
        "touching nodes that stick over all touching nodes",
        undefined_at_times=True,
        needs="friction",
        held="height",
    ),
    "slid_over_peaks": Observable(
        "gradient",
        "longest way of a touching node past the body over the mean distance of the peaks",
        undefined_at_times=True,
        needs="drag along x",
        no_limit="peaks come ever closer as eps_f goes to 0",
    ),
    "energy_lost": Observable(
        "energy",
        "work since the last step less stored energy, per area; of friction, what slipping nodes lose",
        needs="loss",
    ),
    "hysteresis": Observable(
        "energy", "energy lost along the path per area, of a closed path the area of its loop", needs="loss", of="path"
    ),
    "pull_off_pressure": Observable(
        "pressure",
        "largest mean tension while the punch is withdrawn, unknown where the path ends before it falls",
        undefined_at_times=True,
        needs="tension",
        of="path",
    ),
}
ROUGH_BODY_OBSERVABLES = {
    "next_order": Observable("height", "most that the next order in the slope would add to a displacement")
}
LIMITED = {name: row for name, row in (OBSERVABLES | PATH_OBSERVABLES).items() if not row.without_limit}


def recorded(
    hardness: bool,
    ends: tuple[bool, ...] = (),
    form: bool = False,
    processes: Collection[str] = (),
    steadily: bool = False,
    passes: bool = False,
) -> dict[str, Observable]:
    """The observables of a contact with or without a hardness, axes along which it ends, and a form of its punch.

    `processes` are their names. A step that slides `steadily` takes no time, one that `passes` over the body does.
    """
    has = {"": True, "hardness": hardness, "period": not any(ends), "window": any(ends), "form": form}
    has |= {name: name in processes for name in ("springs", "worn", "flow")}
    has |= {"sliding": steadily or passes, "springs": has["springs"] and not steadily}
    has |= {"divisions": has["springs"] or has["worn"]}
    return {name: row for name, row in OBSERVABLES.items() if has[row.needs]}


def recorded_along(scene: Scene, order: int = 0) -> dict[str, Observable]:
    """The rows for a path of a scene, followed to an order in the slope of its bodies: those of effects that it has.

    The energy is known of flat bodies, and of rough or two elastic bodies where order 0 is all there is. What a
    hardness takes where nothing attracts is plastic work, which is always known. What a body that creeps loses is known
    where nothing jumps.
    """
    interface = scene.interface
    higher_orders = scene.follows_topography and (order > 0 or not interface.couples)
    attracts = interface.attracts
    has = {
        **{f"drag along {axis}": interface.couples for axis in AXES[-scene.dimension :]},
        "friction": interface.friction is not None,
        "loss": scene.loading.speed is None and not attracts and not scene.wears_by_slip
        if scene.creeps
        else ((interface.couples or attracts) and not higher_orders and not scene.wears_by_slip)
        or (interface.hardness is not None and not attracts),
        "tension": attracts and scene.loading.displacement is not None,
    }
    return {name: row for name, row in PATH_OBSERVABLES.items() if has.get(row.needs)}


def needed_for(name: str) -> str:
    """What a path needs to have a quantity that is recorded along it."""
    return {
        "drag along x": "a punch is dragged against friction or a law that holds sideways",
        "drag along y": "a punch is dragged along y on a map, against friction or a law that holds sideways",
        "friction": "nodes stick or slip where there is friction",
        "loss": "energy is lost by friction, attraction or creep, and not known with a boundary, at a topography_order "
        "above 0, with attraction and creep together, or with friction and wear",
        "tension": "a punch is pulled off against attraction by a prescribed displacement",
    }[PATH_OBSERVABLES[name].needs]


def why_no_limit(name: str) -> str:
    """Why a recorded quantity never has a limit, as a clause with its name; nothing of any other name."""
    row = (OBSERVABLES | PATH_OBSERVABLES).get(name)
    return f"{name} has no limit, because {row.without_limit}" if row is not None and row.without_limit else ""


def unheld(row: Observable, scene: Scene, varied: Collection[str]) -> str:
    """Why a quantity becomes 0 or infinite in the limits of a scene that are varied; nothing where it does not.

    With heights or gradients fixed, self-affine roughness keeps one of the two while eps_f and eps_t go to 0. A
    hardness is a pressure, which has to keep its ratio to g E*. The energy that creep or a hardness takes is in
    proportion to the heights. So are the distances in which contacts begin to slip and to relax: at ever smaller
    heights, none sticks, and no wave is slow enough to dissipate.
    """
    if not {"eps_f", "eps_t"} & set(varied):
        return ""
    by_height = any(getattr(surface, "rms_height", None) is not None for surface in scene.surfaces.values())
    control, held = scene.loading.control, row.held
    if row.needs == "loss" and not scene.interface.couples and not scene.interface.attracts:
        held = "height"
    elif held in ("", "load") and scene.interface.hardness is not None:
        held = "gradient"
    grows = "with a fixed rms_height the gradient g grows without bound as eps_f and eps_t go to 0"
    if held == "gradient" and by_height:
        return f"{grows}; give the roughness an rms_gradient"
    if held == "load" and by_height and control != "reduced_pressure":
        return f"{grows}, and p / (g E*) falls to 0; give the roughness an rms_gradient"
    if by_height and control == "reduced_pressure" and (held == "height" or row.unit in ("pressure", "energy")):
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
