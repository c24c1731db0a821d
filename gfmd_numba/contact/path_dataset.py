"""What `gfmd solve` writes of a contact: a dataset of one loading, or of all steps of a path."""

from collections.abc import Iterable
from functools import partial

import numpy as np
import xarray as xr

from gfmd_numba.contact import branch, law_resolution, rough_bodies_dataset
from gfmd_numba.contact.bodies import contact_modulus
from gfmd_numba.contact.contact_input import ContactInput
from gfmd_numba.contact.dataset import (
    PRESCRIBED,
    cf_attributes,
    contact_dataset,
    dropped_effects,
    indexed,
    load_attributes,
    scales,
    units,
)
from gfmd_numba.contact.edges import edge
from gfmd_numba.contact.path_measures import PathRecord
from gfmd_numba.contact.path_observables import recorded_along
from gfmd_numba.contact.plausible_numbers import implausible
from gfmd_numba.contact.prescribed_load import SLIDING, Sliding, reduced_pressure, steps_of
from gfmd_numba.contact.problem import Effect, Problem
from gfmd_numba.contact.solution import condensed_stiffness
from gfmd_numba.contact.state import Contact, Followed
from gfmd_numba.contact.two_step import Pressed
from gfmd_numba.scene import Scene
from gfmd_numba.solvers.status import Status
from gfmd_numba.text.si_prefix import si_prefix

# of E*, of slopes and of the contact: strains are about as large as either, and few nodes are those of sharp edges
LARGEST_PRESSURE, STEEPEST_SLOPE, LARGEST_SHARE = 0.2, 0.3, 0.01
FARTHEST = 0.25  # of the distance of two peaks, from a peak to where the mean plane is

_UNKNOWN_EDGES = 0.05  # of the contact area


def path_dataset(
    given: ContactInput, problem: Problem, effects: Iterable[Effect], solved: Iterable[Contact | Pressed]
) -> xr.Dataset:
    """Fields and observables in SI units over x, or (y, x), and over the steps of a path.

    The path ends at its first step that is not ok, as it does in campaigns: the next one would begin there. The
    attribute `validity` holds the reasons to doubt the result, one sentence a line.
    """
    file = given.file
    record, steps = PathRecord(), []
    for at_load, each in zip(problem.at_each_load, solved, strict=False):
        contact = each if isinstance(each, Contact) else each.contact
        steps.append(step_dataset(given, at_load, each))
        is_ok = bool(steps[-1]["status"] == Status.ok)
        if file.path:
            record.add(at_load, each, is_ok)
        if contact.followed is not None:
            _add_followed(steps[-1], given, at_load, contact, contact.followed)
        if not is_ok:
            break
    dataset = _with_loads(_joined(steps) if file.path else steps[0], given)
    if file.path:
        _add_record(dataset, given, record)
    if file.scene.interface.reaches_across:
        resolution = law_resolution.resolution(problem)
        dataset[law_resolution.NAME] = ((), resolution, cf_attributes(law_resolution.LONG_NAME))
    dataset.attrs |= {
        "scene": file.model_dump_json(),
        "solver": problem.numerics.solver,
        "dropped_effects": dropped_effects(effects),
        "processing": "\n".join(sentence for surface in given.measured for sentence in surface.done),
        "validity": "\n".join(filter(None, (*implausible(file.scene, file.path), doubts(given, problem, dataset)))),
    }
    return dataset


def step_dataset(given: ContactInput, problem: Problem, solved: Contact | Pressed) -> xr.Dataset:
    """Fields and observables of one step in SI units over x, or (y, x)."""
    scene, surfaces = given.file.scene, given.surfaces
    contact = solved if isinstance(solved, Contact) else solved.in_plane
    step = contact_dataset(scene, problem, surfaces.rms_gradient, contact)
    if isinstance(solved, Pressed) and surfaces.bodies is not None:
        rough_bodies_dataset.add_bodies(step, scene, surfaces.bodies, surfaces.rms_gradient, problem, solved)
    return step


def _add_followed(
    step: xr.Dataset, given: ContactInput, problem: Problem, contact: Contact, followed: Followed
) -> None:
    """Add the load at the largest jump of a step of a path, and how stable its end is."""
    scene = given.file.scene
    scale, unit = scales(scene, given.surfaces.rms_gradient), units(scene)
    name, kind = ("displacement", "height") if problem.mean_pressure is None else ("pressure", "pressure")
    found = {f"jump_{name}": (kind, f"{name} at the largest jump since the last step", followed.jump_at)}
    if scene.interface.couples:
        sliding = "tangential displacement of the punch at the largest jump since the last step"
        found["jump_sliding"] = ("height", sliding, followed.jump_sliding)
    curvature = branch.stability(problem, contact)
    if curvature is not None:
        found["stability"] = ("1", "smallest curvature of the energy over that of the bodies alone", curvature)
    step.update(
        {
            key: ((), value * scale[of], cf_attributes(long_name, unit[of]))
            for key, (of, long_name, value) in found.items()
        }
    )


def _add_record(dataset: xr.Dataset, given: ContactInput, record: PathRecord) -> None:
    """Add what is recorded along a path to its dataset."""
    scene = given.file.scene
    scale, unit, of_path = scales(scene, given.surfaces.rms_gradient), units(scene), record.of_path()
    found, of_steps = {}, record.of_steps()
    for name, row in recorded_along(scene, given.file.numerics.slope_order(scene)).items():
        dims, values = ((), of_path) if row.of == "path" else ("step", of_steps)
        found[name] = (dims, values[name] * scale[row.unit], cf_attributes(row.long_name, unit[row.unit]))
    dataset.update(found)


def doubts(given: ContactInput, problem: Problem, dataset: xr.Dataset) -> str:
    """Return the reasons to doubt the steps of a path, one sentence a line."""
    bodies, order = given.surfaces.bodies, given.file.numerics.slope_order(given.file.scene)
    rough = "" if bodies is None else rough_bodies_dataset.doubt(bodies, order, dataset)
    coarse = law_resolution.doubt(problem, given.file.discretisation)
    of_surfaces = (sentence for surface in given.measured for sentence in surface.doubts)
    own = (doubt(given, dataset) for doubt in (_beyond_small_strains, _past_asperities, _overlap, _rounded_heights))
    short = _short_stretches(problem, dataset)
    return "\n".join([*of_surfaces, *filter(None, (rough, coarse, *own, short))])


def _short_stretches(problem: Problem, dataset: xr.Dataset) -> str:
    """Return a warning about contacts of few nodes on a thin body, whose edges are not known; else nothing."""
    shape = problem.surface.shape
    short = edge(partial(condensed_stiffness, problem), 1.0 / shape[-1], len(shape)).short
    touching = dataset["contact_area_fraction_counted"] * np.prod(shape)
    across = (touching / dataset["n_segments"].where(touching > 0)) ** (1.0 / len(shape))
    unknown = float((2.0 * len(shape) * short / across**2).max())
    if not unknown > _UNKNOWN_EDGES:
        return ""
    return (
        f"contacts are {float(across.min()):.2g} node spacings wide on average, on a body thin against these: the "
        f"correction for their edges leaves {100.0 * unknown:.2g} % of the contact area unknown, so refine the grid"
    )


def _beyond_small_strains(given: ContactInput, dataset: xr.Dataset) -> str:
    """Return a warning where the pressure or the slope of much of the contact is beyond the theory of small strains.

    Without a length or moduli, heights and pressures have a scale that is free: then mean pressures above E* count.
    """
    scene, nodes = given.file.scene, ["y", "x"] if "y" in dataset.dims else ["x"]
    ratios = dataset["pressure"].where(np.isfinite(dataset["pressure"])) / contact_modulus(scene)
    touching = dataset["gap"] <= 0.0
    steep = _slopes(dataset, nodes).where(touching, 0.0)
    beyond = touching & ((ratios > LARGEST_PRESSURE) | (steep > STEEPEST_SLOPE))
    shares = beyond.sum(nodes) / np.maximum(touching.sum(nodes), 1)
    share, peak, slope = (float(each.max()) for each in (shares, ratios, steep))
    has_scale = scene.length is not None or scene.has_moduli
    if not (float(ratios.mean(nodes).max()) > 1.0 or (has_scale and (share > LARGEST_SHARE or peak > 1.0))):
        return ""
    return (
        f"strains are no longer small on {100.0 * share:.3g} % of the contact, where the pressure exceeds "
        f"{LARGEST_PRESSURE:g} E* or the slope {STEEPEST_SLOPE:g} (the largest are {peak:.3g} E* and {slope:.2g}), and "
        "linear elasticity is off by as much: check load, moduli and heights"
    )


def _slopes(dataset: xr.Dataset, nodes: list[str]) -> xr.DataArray:
    """Size of the gradient of the heights between the neighbours of each node."""
    squares = [
        ((dataset["height"].roll({dim: -1}) - dataset["height"].roll({dim: 1})) / (2.0 * float(dataset[dim][1]))) ** 2
        for dim in nodes
    ]
    found: xr.DataArray = sum(squares[1:], squares[0]) ** 0.5
    return found


def _past_asperities(given: ContactInput, dataset: xr.Dataset) -> str:
    """Return a warning about sliding so far that asperities would meet others, nothing for less.

    Peaks of a random profile are 2 pi (m2 / m4)^(1/2) apart (Longuet-Higgins, Phil. Trans. R. Soc. A 249:321, 1957).
    """
    if "sliding" not in dataset or "tangential_displacement" not in dataset:
        return ""
    nodes = ["y", "x"] if "y" in dataset.dims else ["x"]
    ends = ("", "_y")[: len(nodes)]
    ways = [abs(dataset[f"sliding{end}"] - dataset[f"tangential_displacement{end}"]) for end in ends]
    touching = dataset["gap"] <= 0.0
    apart = sum(way**2 for way in ways) ** 0.5
    slid = float(apart.where(touching | ~touching.any(nodes)).max())
    profile_gradient = float(dataset["rms_gradient"].max()) / len(nodes) ** 0.5
    distance = 2.0 * np.pi * float((dataset["height"].std(nodes) / dataset["nayak"] ** 0.5).max()) / profile_gradient
    if not slid > FARTHEST * distance:
        return ""
    unit = "m" if given.file.scene.length else "L_x"
    way, peaks = (_with_prefix(value, unit) for value in (slid, distance))
    return (
        f"the punch has slid {way} past the body, {slid / distance:.2g} times the mean distance of the peaks ({peaks})."
        f" Each node still faces the same node of the punch: beyond {FARTHEST:g} times that distance, asperities of "
        "real surfaces meet at other places"
    )


def _with_prefix(value: float, unit: str) -> str:
    factor, name = si_prefix(value, unit)
    return f"{factor * value:.3g} {name}"


def _overlap(given: ContactInput, dataset: xr.Dataset) -> str:
    """Return a warning about surfaces that reach far through each other under a cohesive law, nothing for others."""
    law = given.file.scene.interface.cohesive
    deepest = 0.0 if law is None else -float(dataset["gap"].min()) / law.normal_length
    if not deepest > 1.0:
        return ""
    return (
        f"the surfaces overlap by up to {deepest:.3g} times normal_length, and without a hard_wall no area counts as "
        "contact: add one to the interface unless you mean that"
    )


def _rounded_heights(given: ContactInput, dataset: xr.Dataset) -> str:
    """Return a warning about heights that single precision rounds too much for a law of a short range, else nothing."""
    numerics, laws = given.file.numerics, given.file.scene.interface.laws.values()
    acting = [law for law in laws if law.across_open_gap]
    lengths = [value for law in acting for name, value in law if name != "work_of_adhesion"]
    if numerics.precision == "double" or not lengths:
        return ""
    rounding = 0.5 * float(np.finfo(np.float32).eps) * float(np.ptp(dataset["height"].values)) / min(lengths)
    if rounding <= numerics.residual:
        return ""
    return (
        f"single precision rounds the heights, and with them the gaps, by up to {rounding:.2g} of the shortest length "
        "of the interaction law, and its tractions as much: take numerics.precision double"
    )


def _joined(steps: list[xr.Dataset]) -> xr.Dataset:
    return indexed(
        xr.concat(
            steps, "step", data_vars="all", coords="minimal", compat="override", join="exact", combine_attrs="override"
        )
    )


def _with_loads(dataset: xr.Dataset, given: ContactInput) -> xr.Dataset:
    """Return the dataset with the loading of each step of a path as coordinates; a load also as p/(g E*)."""
    attributes = load_attributes(given.file.scene)
    found: dict[str, list[float]] = {}
    for scene, sliding in steps_of(given.file.scene, given.file.path):
        for name, value in _prescribed(scene, sliding, given.surfaces.rms_gradient).items():
            found.setdefault(PRESCRIBED.get(name, name), []).append(value)
    if not given.file.path:
        found = {name: values for name, values in found.items() if name not in SLIDING}
        return dataset.assign_coords({name: ((), values[0], attributes[name]) for name, values in found.items()})
    n = dataset.sizes["step"]
    return dataset.assign_coords({name: ("step", values[:n], attributes[name]) for name, values in found.items()})


def _prescribed(scene: Scene, sliding: Sliding, rms_gradient: float) -> dict[str, float]:
    load = reduced_pressure(scene, rms_gradient, contact_modulus(scene))
    reduced = {} if load is None else {"reduced_pressure": load}
    own = {name: float(value) for name, value in scene.loading if value is not None}
    return reduced | own | dict(zip(SLIDING, map(float, sliding), strict=False))
