"""The table of observables: what is recorded of every contact, with units and meaning; pure data."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Observable:
    """A recorded quantity: what it tells of, its unit and its meaning.

    Units are 1, g, g L_x, g E*, g^2 E* L_x and seconds; E*/stiffness is 1 but for a scene with a `stiffness_scale`.
    `function` is "module:function" of a contact, None for what its equilibrium says under that name. One that is
    `undefined_at_times` may be not-a-number in a run that is ok: without contact it is 0/0, or unknown on maps. One
    that `needs_hardness` is recorded of contacts with a hardness alone.

    `no_limit` says why what a contact has becomes 0 or infinite in the thermodynamic, fractal and continuum limit,
    however its roughness is scaled; nothing where it does not. `held` is what then has to stay fixed while eps_f and
    eps_t go to 0: the load p / (g E*), the gradient g, the rms height, or nothing ("").
    """

    of: Literal["contact", "surface", "run", "path"]
    unit: Literal["1", "E*/stiffness", "gradient", "height", "pressure", "energy", "s"]
    long_name: str
    function: str | None = None
    undefined_at_times: bool = False
    needs_hardness: bool = False
    no_limit: str = ""
    held: Literal["", "load", "gradient", "height"] = ""

    @property
    def without_limit(self) -> str:
        """Why it never has a limit; nothing where it may have one."""
        return _ELSEWHERE.get(self.of, self.no_limit)


_ELSEWHERE = {"surface": "it tells of the surface alone", "run": "it tells of the computation alone"}
_OF_AN_ERROR = "it estimates an error, which vanishes with finer levels"
_AREA, _CONTACT = "gfmd_numba.contact.contact_area", "gfmd_numba.contact.evaluation"

OBSERVABLES = {
    "kappa": Observable(
        "contact",
        "E*/stiffness",
        "area-load coefficient a_r g E* / p, contact area corrected for its edges",
        f"{_CONTACT}:kappa",
        undefined_at_times=True,
    ),
    "kappa_residual_error": Observable(
        "contact",
        "E*/stiffness",
        "largest change of kappa to expect from the residual of the solver",
        f"{_CONTACT}:kappa_residual_error",
        undefined_at_times=True,
        no_limit=_OF_AN_ERROR,
    ),
    "kappa_counted": Observable(
        "contact",
        "E*/stiffness",
        "area-load coefficient a_r g E* / p, contact area as counted nodes",
        f"{_CONTACT}:kappa_counted",
        undefined_at_times=True,
    ),
    "kappa_r": Observable(
        "contact",
        "E*/stiffness",
        "area-load coefficient a_r g_r E* / p with the rms gradient over the contact",
        f"{_CONTACT}:kappa_r",
        undefined_at_times=True,
    ),
    "contact_area_fraction": Observable(
        "contact",
        "1",
        "contact length over L_x, or area over L_x^2, corrected for its edges",
        f"{_AREA}:contact_area_fraction",
        held="load",
    ),
    "contact_area_fraction_counted": Observable(
        "contact", "1", "touching nodes over all nodes", f"{_AREA}:contact_area_fraction_counted", held="load"
    ),
    "contact_area_fraction_error": Observable(
        "contact",
        "1",
        "standard deviation of contact_area_fraction by edges between the nodes of profiles",
        f"{_AREA}:contact_area_fraction_error",
        undefined_at_times=True,
        no_limit=_OF_AN_ERROR,
    ),
    "plastic_area_fraction": Observable(
        "contact",
        "1",
        "nodes at the hardness over all nodes",
        f"{_AREA}:plastic_area_fraction",
        needs_hardness=True,
        held="gradient",
    ),
    "mean_plastic_depth": Observable(
        "contact",
        "height",
        "mean depth by which the punch has been flattened",
        f"{_CONTACT}:mean_plastic_depth",
        needs_hardness=True,
        held="height",
    ),
    "kappa_edges": Observable(
        "contact",
        "E*/stiffness",
        "area-load coefficient a_r g E* / p, each contact edge located from the pressures next to it",
        f"{_CONTACT}:kappa_edges",
        undefined_at_times=True,
    ),
    "kappa_edges_error": Observable(
        "contact",
        "E*/stiffness",
        "standard deviation of kappa_edges by stretches of too few nodes to locate their edges",
        f"{_CONTACT}:kappa_edges_error",
        undefined_at_times=True,
        no_limit=_OF_AN_ERROR,
    ),
    "n_segments": Observable(
        "contact",
        "1",
        "number of separate stretches of contact, or clusters of a map",
        f"{_AREA}:n_segments",
        no_limit="contacts become ever more as eps_f and eps_t go to 0",
    ),
    "mean_segment_length": Observable(
        "contact",
        "1",
        "mean length of a stretch of contact over L_x, corrected for its edges",
        f"{_AREA}:mean_segment_length",
        undefined_at_times=True,
        no_limit="contacts become ever smaller as eps_f and eps_t go to 0",
    ),
    "elastic_energy": Observable(
        "contact",
        "energy",
        "elastic energy per nominal area of the deformation by the punch, beyond uniform compression",
        f"{_CONTACT}:elastic_energy",
        held="height",
    ),
    "mean_pressure": Observable(
        "contact",
        "pressure",
        "mean contact pressure",
        f"{_CONTACT}:mean_pressure",
        no_limit="the loading prescribes it, or a displacement does, for which its laws are not known",
    ),
    "peak_pressure": Observable(
        "contact",
        "pressure",
        "largest contact pressure",
        f"{_CONTACT}:peak_pressure",
        no_limit="peaks become ever sharper and more as eps_f and eps_t go to 0, and the largest pressure grows",
    ),
    "mean_gap": Observable("contact", "height", "mean gap between the surfaces", f"{_CONTACT}:mean_gap", held="height"),
    "rms_gradient": Observable("surface", "gradient", "rms gradient of the punch", f"{_CONTACT}:rms_gradient"),
    "rms_gradient_contact": Observable(
        "contact",
        "gradient",
        "rms gradient of the punch over the contact",
        f"{_CONTACT}:rms_gradient_contact",
        undefined_at_times=True,
        held="gradient",
    ),
    "nayak": Observable("surface", "1", "Nayak's parameter m0 m4 / m2^2 of the punch", f"{_CONTACT}:nayak"),
    "full_contact_pressure": Observable(
        "surface", "pressure", "rms fluctuation of the pressure in full contact, (sum_q K(q)^2 |h(q)|^2)^(1/2)"
    ),
    "status": Observable("run", "1", "how the run ended"),
    "residual": Observable(
        "run", "1", "largest violation of the contact conditions over the largest pressure, or relative load imbalance"
    ),
    "n_iterations": Observable("run", "1", "solver iterations"),
    "n_transforms": Observable("run", "1", "fast Fourier transforms of the whole grid"),
    "wall_time": Observable("run", "s", "time spent in the solver"),
}


def recorded(hardness: bool) -> dict[str, Observable]:
    """The observables of a contact with or without a hardness."""
    return {name: row for name, row in OBSERVABLES.items() if hardness or not row.needs_hardness}
