"""Datasets of contacts and loaded bodies: variables in the units of the file, each with its unit and long_name."""

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from gfmd_numba.arrays import Reals
from gfmd_numba.arrays.threads import team
from gfmd_numba.contact import jumps, plastic_flow, relative_softening
from gfmd_numba.contact.boundary_values import solve_boundary_values
from gfmd_numba.contact.contact_input import BoundaryInput, ContactInput
from gfmd_numba.contact.evaluation import finite_status, gap, measure
from gfmd_numba.contact.load_path import PathRecord
from gfmd_numba.contact.observables import (
    OBSERVABLES,
    OF_PUNCH,
    OF_SUM,
    PRESCRIBED,
    ROUGH_BODY_OBSERVABLES,
    Observable,
    recorded_along,
)
from gfmd_numba.contact.problem import Effect, Problem
from gfmd_numba.contact.reduced_loads import SLIDING, times_of
from gfmd_numba.contact.rough_surfaces import RoughBody
from gfmd_numba.contact.slopes import tractions_on
from gfmd_numba.contact.state import Contact, Followed
from gfmd_numba.contact.two_step import RoughContact
from gfmd_numba.contact.validity import path_warnings, rough_body_warnings
from gfmd_numba.elasticity import free_body, topography
from gfmd_numba.elasticity.scales import scales_of
from gfmd_numba.elasticity.topography import Response
from gfmd_numba.interface import vector_slip
from gfmd_numba.scene import COMPONENTS, Scene
from gfmd_numba.scene.measured_record import AXES
from gfmd_numba.scene.quantities import (
    FORCE_ON_A_MAP,
    LINE_LOAD,
    MEAN_PRESSURE,
    PUNCH_DISPLACEMENT,
    REDUCED_PRESSURE,
    RMS_GRADIENT_TARGET,
)
from gfmd_numba.solvers import status

CONVENTIONS = "CF-1.11"
# attributes of x, which tell a whole period from a part of one, and a window that has no period
POINTS, POINTS_OF_WINDOW = "points_per_period", "points_per_window"
INDICES = {
    "case": "case, in the order of the campaign",
    "realisation": "realisation: the same random surface in every case",
    "step": "step of the path, from the first loading",
}

Described = tuple[str, str, str, npt.ArrayLike]  # name, kind of unit, long_name and values of a variable
_TOLD = {
    "residual": "largest unbalanced traction over the largest traction",
    "n_transforms": "fast Fourier transforms of the surface",
}


@dataclass(frozen=True)
class Units:
    """What each unit of a dimensionless problem is worth in a file, and what it is called there."""

    worth: Mapping[str, float]
    names: Mapping[str, str]

    @classmethod
    def of(cls, scene: Scene, rms_gradient: float = 1.0) -> "Units":
        """Units of a scene, of heights in units of a gradient: m and Pa, or L_x and E*, which are called 1."""
        scales = scales_of(scene)
        height, pressure = rms_gradient * scales.length, rms_gradient * scales.modulus
        metre, pascal = "m" if scene.length else "1", "Pa" if scene.has_moduli else "1"
        both = [unit for unit in (pascal, metre) if unit != "1"]
        each = {
            "1": (1.0, "1"),
            "gradient": (rms_gradient, "1"),
            "length": (scales.length, metre),
            "height": (height, metre),
            "E*": (scales.modulus, pascal),
            "pressure": (pressure, pascal),
            "energy": (pressure * height, "J m-2" if len(both) == 2 else "".join(both) or "1"),
            "s": (1.0, "s"),
        }
        named_alone = {"force per length": "N m-1", "force": "N", "speed": "m s-1" if scene.length else "s-1"}
        return cls(
            {kind: worth for kind, (worth, _) in each.items()},
            {kind: name for kind, (_, name) in each.items()} | named_alone,
        )

    def variable(
        self, dims: Hashable | Sequence[Hashable], kind: str, long_name: str, values: npt.ArrayLike, name: str = ""
    ) -> tuple[Hashable | Sequence[Hashable], npt.NDArray[Any], dict[str, Any]]:
        """Variable of a dataset, in the unit of its file; an observable is described by its name, too."""
        attributes = measure_attributes(name, self.names[kind], long_name)
        return dims, scaled(np.asarray(values), self.worth[kind]), attributes

    def variables(self, dims: Sequence[Hashable], described: Iterable[Described]) -> dict[str, Any]:
        """Variables of the same dims by name."""
        return {name: self.variable(dims, kind, told, values) for name, kind, told, values in described}

    def positions(self, shape: tuple[int, ...], length: float | None, ends: tuple[bool, ...] = ()) -> dict[str, Any]:
        """Coordinates of the nodes of a whole period, or window."""
        points = [POINTS_OF_WINDOW if end else POINTS for end in ends or (False,) * len(shape)]
        return {
            dim: (
                dim,
                np.arange(nodes) / nodes * (length or 1.0),
                cf_attributes(f"position along {dim}", self.names["height"]) | {name: nodes},
            )
            for dim, nodes, name in zip(AXES[-len(shape) :], shape, points, strict=True)
        }


def units_of(given: ContactInput) -> Units:
    """What each unit of the dimensionless problem of a contact is worth, and what it is called in results."""
    return Units.of(given.file.scene, given.surfaces.rms_gradient)


def modulus_attributes(scene: Scene) -> dict[str, str]:
    """Attributes of a dataset whose E* is that of one layer among others; none of any other."""
    if all(body.layers is None for body in scene.deformable.values()) or not scene.has_moduli:
        return {}
    scales = scales_of(scene)
    whose = "the topmost layer" if len(scene.deformable) == 1 else "both bodies together, of layers the topmost"
    return {"effective_modulus": f"{scales.modulus:.17g} Pa: E* is that of {whose}"}


def load_attributes(scene: Scene) -> dict[str, dict[str, Any]]:
    """CF attributes of what a loading prescribes, by the name of its coordinate."""
    height = "m" if scene.length else "1"
    return {
        "reduced_pressure": cf_attributes(REDUCED_PRESSURE),
        "prescribed_pressure": cf_attributes(MEAN_PRESSURE, "Pa"),
        "line_load": cf_attributes(LINE_LOAD, "N m-1"),
        "force": cf_attributes(FORCE_ON_A_MAP, "N"),
        "punch_displacement": cf_attributes(PUNCH_DISPLACEMENT, height),
        "time": cf_attributes("time since the first load began to act", "s"),
        "speed": cf_attributes("sliding speed of the punch along x", "m s-1" if scene.length else "s-1"),
        "sliding": cf_attributes("tangential displacement of the punch since first touch", height),
        "sliding_y": cf_attributes("tangential displacement of the punch along y since first touch", height),
    }


def dropped_effects(effects: Iterable[Effect]) -> str:
    """One line for each effect of the scene that was left out of the computation."""
    return "\n".join(f"{effect.name}: {effect.reason}" for effect in effects if effect.state == "dropped")


def cf_attributes(long_name: str, units: str = "1") -> dict[str, Any]:
    """What every variable and coordinate that is written says of itself."""
    return {"long_name": long_name, "units": units}


def measure_attributes(name: str, unit: str, long_name: str) -> dict[str, Any]:
    """CF attributes of a measure."""
    attributes = cf_attributes(long_name, unit)
    if name == "status":
        attributes |= status.flag_attributes(status.SENTENCES)
    if name.startswith("kappa"):
        attributes["comment"] = (
            "not-a-number where the mean pressure is not above 0: under tension area has no such law"
        )
    return attributes


def refuse_nonfinite(dataset: xr.Dataset) -> None:
    """Change a status that is ok where a result of one run, in its units, is not finite."""
    dataset["status"].values = finite_status({str(name): dataset.variables[name].values for name in dataset.data_vars})


def scaled(values: npt.NDArray[Any], factor: float) -> npt.NDArray[Any]:
    """Values in file units; counts and flags keep their integer type."""
    if factor == 1.0:
        return values
    rows = np.atleast_1d(values)
    found = np.empty(rows.shape, np.result_type(values, factor))
    team().by_rows(lambda some: np.multiply(rows[some], factor, out=found[some]), rows.shape)
    return found.reshape(values.shape)


def campaign_dataset(
    coordinates: Mapping[str, tuple[str | tuple[str, ...], list[Any], dict[str, Any]]],
    rows: Mapping[str, Observable],
    values: list[dict[str, npt.NDArray[Any]]],
    unit: Mapping[str, str],
) -> xr.Dataset:
    """Dataset `(case, realisation)` of the measures of every case, already in file units, with `step` along a path."""
    variables = {}
    values = [case | {"status": finite_status(case)} for case in values]
    for name, row in rows.items():
        stacked = np.stack([case[name] for case in values])
        variables[name] = (
            ("case", "realisation", "step")[: stacked.ndim],
            stacked,
            measure_attributes(name, unit[row.unit], row.long_name),
        )
    return indexed(xr.Dataset(variables, attrs={"Conventions": CONVENTIONS})).assign_coords(coordinates)


def indexed(dataset: xr.Dataset) -> xr.Dataset:
    """Dataset with a number for each case, realisation and step."""
    counted = [str(dim) for dim in dataset.dims if dim in INDICES]
    return dataset.assign_coords(
        {name: (name, np.arange(dataset.sizes[name]), cf_attributes(INDICES[name])) for name in counted}
    )


def path_dataset(given: ContactInput, solved: Iterable[Contact]) -> xr.Dataset:
    """Fields and observables in SI units over x, or (y, x), and over the steps of a path.

    The attribute `validity` holds the warnings about the result, one sentence a line.
    """
    file, (problem, effects) = given.file, given.reduced
    steps, record = _steps(given, problem, solved)
    del solved  # and with it the last contact: warnings need its memory
    joined = steps[0]
    if file.path:
        how: Any = {"data_vars": "all", "coords": "minimal", "compat": "override", "join": "exact"}
        joined = indexed(xr.concat(steps, "step", combine_attrs="override", **how))
        joined.update(_recorded(given, record))
    dataset = _with_loads(joined, given, problem)
    if file.scene.interface.reaches_across:
        resolution = relative_softening.softening(problem)
        dataset[relative_softening.NAME] = ((), resolution, cf_attributes(relative_softening.LONG_NAME))
    warned = path_warnings(given, problem, dataset)
    dataset.attrs |= {
        **given.record,
        "solver": problem.numerics.solver,
        "dropped_effects": dropped_effects(effects),
        "processing": given.processing,
        "validity": "\n".join(filter(None, (*given.implausible, warned))),
    }
    return dataset


def _steps(given: ContactInput, problem: Problem, solved: Iterable[Contact]) -> tuple[list[xr.Dataset], PathRecord]:
    """Datasets of the steps of a path, and what is recorded of it.

    It ends at its first step that is not ok, as it does in campaigns: the next one would begin there.
    """
    record, steps = PathRecord(), []
    for at_load, contact in zip(problem.at_each_load, solved, strict=False):
        steps.append(step_dataset(given, at_load, contact))
        is_ok = bool(steps[-1]["status"] == status.Status.ok)
        if given.file.path:
            record.add(at_load, contact, is_ok)
        if contact.followed is not None:
            _add_followed(steps[-1], given, at_load, contact, contact.followed)
        if not is_ok:
            break
    return steps, record


def step_dataset(given: ContactInput, problem: Problem, solved: Contact) -> xr.Dataset:
    """Fields and observables of one step in SI units over x, or (y, x)."""
    step, bodies = contact_dataset(given, problem, solved.in_plane), given.bodies
    if bodies:
        for name in OBSERVABLES.keys() & step.keys():
            step[name].attrs["long_name"] = OBSERVABLES[name].long_name.replace(OF_PUNCH, OF_SUM)
        step["height"].attrs["long_name"] = "sum of the heights of both surfaces, peaks towards each other"
        if isinstance(solved, RoughContact):
            _add_bodies(step, given, bodies, problem, solved)
        elif len(bodies) > 1:  # that creep, at order 0
            together = "normal displacements of both bodies together, positive towards each other"
            step["displacement"].attrs["long_name"] = together
    return step


def contact_dataset(given: ContactInput, problem: Problem, contact: Contact) -> xr.Dataset:
    """Fields over x, or (y, x), and scalars of the first realisation of a contact.

    Displacements count from the unloaded body on a slab or without a period, and from their own mean on a periodic
    half-space, whose mean displacement has no reference.
    """
    scene, unit, dims = given.file.scene, units_of(given), AXES[-given.file.scene.dimension :]
    coordinates = unit.positions(contact.heights.shape[1:], scene.length, scene.ends)
    coordinates["rms_gradient_target"] = ((), given.surfaces.rms_gradient, cf_attributes(RMS_GRADIENT_TARGET))
    # measured before fields are copied, as both take memory
    rows = ((name, OBSERVABLES[name], values[0]) for name, values in measure(contact).items())
    measures = {name: unit.variable((), row.unit, row.long_name, value, name) for name, row, value in rows}
    variables: dict[str, Any] = unit.variables(dims, _fields_of(given, problem, contact))
    if problem.plasticity is not None:
        variables |= _inside(contact, unit, dims)
    variables |= measures
    if contact.equilibrium.growing_wave is not None:
        attributes = cf_attributes("index of the wave that grew most before it was unstable")
        variables["growing_wave"] = ((), contact.equilibrium.growing_wave[0], attributes)
    attrs = {"Conventions": CONVENTIONS, "title": "rough contact"} | modulus_attributes(scene)
    dataset = xr.Dataset(variables, coordinates, attrs)  # at once: each addition aligns what is there
    refuse_nonfinite(dataset)
    return dataset


def _fields_of(given: ContactInput, problem: Problem, contact: Contact) -> Iterator[Described]:
    """Fields of the first realisation; tangential ones on maps along x and y, none where the normal one is alone."""
    displacement, tangential = contact.equilibrium.displacement[0], contact.equilibrium.tangential
    if problem.displacement is None and not any(problem.ends):
        uniform = float(given.scales.bodies[0].condensed_stiffness(np.zeros(1))[0])
        by_mean = 0.0 if problem.mean_pressure is None or uniform == 0.0 else problem.mean_pressure / uniform
        displacement = displacement - displacement.mean() - by_mean / contact.change.factor
    if contact.change.normal_offset is not None:
        displacement = displacement + contact.change.normal_offset[0]
    yield "height", "height", "height of the punch, peaks towards the body", contact.heights[0]
    yield "pressure", "pressure", "contact pressure", contact.equilibrium.pressure[0]
    yield "displacement", "height", "normal displacement of the body, positive towards the punch", displacement
    yield "gap", "height", "gap between the surfaces", gap(contact)[0]
    if "springs" in contact.memory:
        relaxed = "pressure that the relaxed body would bear in this shape, E* times strains of about this size"
        yield "relaxed_pressure", "pressure", relaxed, -contact.memory["springs"].traction[0, 0, -1]
    if problem.interface.hardness is not None:
        flattened = "depth by which the punch has been flattened, kept when it is unloaded"
        yield "plastic_depth", "height", flattened, np.asarray(contact.plastic_depth)[0]
    if problem.wear_rate is not None:
        yield "worn_depth", "height", "depth by which the punch has worn", contact.memory["worn"][0]
    if tangential is not None and contact.tangential_displacement is not None:
        moved, rubs = "tangential displacement of the body", "tangential traction of the punch on the body"
        yield from _by_axis("tangential_displacement", "height", moved, contact.tangential_displacement[0], " ")
        yield from _by_axis("tangential_traction", "pressure", rubs, tangential.traction[0], " ")
        if problem.interface.friction is not None:
            slid = vector_slip.length(tangential.slip[0]) if contact.slip_path is None else contact.slip_path[0]
            yield "slip", "height", "way a touching node has slid in this step, 0 where it sticks", slid
    if problem.tractions is not None:
        prescribed = *problem.tractions.tangential, problem.tractions.normal
        for component, values in zip(COMPONENTS[given.file.scene.dimension], prescribed, strict=True):
            long_name = f"prescribed traction on the body, {component.way}"
            yield f"prescribed_{component.key('traction')}", "pressure", long_name, values
    if problem.plasticity is not None:
        out = np.asarray(contact.change.normal_offset)[0]
        yield "residual_displacement", "height", "displacement of the body by what has flowed, without a load", out


def _inside(contact: Contact, unit: Units, dims: tuple[str, ...]) -> dict[str, Any]:
    """Means of the sublayers of a body that may flow, and the depths of their middles."""
    plastic, (von_mises, along) = plastic_flow.plastic_state(contact), plastic_flow.stresses(contact)
    bottoms = np.cumsum(plastic.body.waves.thickness)
    shape = len(bottoms), *contact.heights.shape[1:]
    own = (
        ("equivalent_plastic_strain", "gradient", "equivalent plastic strain", plastic.equivalent.reshape(shape)),
        ("von_mises_stress", "pressure", "von Mises stress", von_mises.reshape(shape)),
        ("stress_x", "pressure", "stress along x, tension above 0", along.reshape(shape)),
    )
    found = unit.variables(("depth", *dims), own)
    middles = bottoms - 0.5 * plastic.body.waves.thickness
    return found | {"depth": unit.variable(("depth",), "length", "depth of the middle of a sublayer", middles)}


def _add_bodies(
    found: xr.Dataset, given: ContactInput, bodies: tuple[RoughBody, ...], problem: Problem, solved: RoughContact
) -> None:
    """Add heights and displacements `[(y,) x]` of each body, of profiles forming tractions, and the next order."""
    dims, pairing = found["height"].dims, solved.correction.pairing
    assert problem.rough is not None  # as its bodies are
    whole, rms_gradient = units_of(given), given.surfaces.rms_gradient
    for name, body, response in zip(given.file.scene.deformable, bodies, solved.responses, strict=True):
        prefix, whose = ("", "body") if name == "body" else ("counter_body_", "counter body")
        unit = Units(
            {"height": whole.worth["length"], "pressure": whole.worth["E*"] / body.compliance_fraction}, whole.names
        )
        outwards = f"topography of the {whose}, peaks outwards"
        found[f"{name}_height"] = unit.variable(dims, "height", outwards, body.heights)
        without = replace(problem, tractions=None)  # prescribed tractions have variables of their own
        alone = None if pairing is None else tractions_on(body, without, solved, rms_gradient, pairing)
        along, pressure = tractions_on(body, problem, solved, rms_gradient, pairing)
        if any(problem.ends):
            own = [_moved_around_a_window(body, whose, along, pressure, problem.ends)]
        else:
            own = [
                *_moved(body, whose, response, along, pressure),
                *forming_tractions(body, whose, problem.rough.order),
            ]
        if alone is not None:
            rubbed, normal = alone
            assert rubbed is not None  # between inclined surfaces
            if prefix:  # the pressure on the lower body is that of the contact
                own.append(("pressure", "pressure", f"contact pressure on the {whose}", normal))
            rubs = f"tangential traction of the contact on the {whose}, along the plane"
            own += _by_axis("tangential_traction", "pressure", rubs, rubbed)
        found.update({prefix + key: variable for key, variable in unit.variables(dims, own).items()})
    if pairing is not None and problem.interface.couples:  # what friction compares, on the axes of the surfaces
        equilibrium = solved.equilibrium
        assert equilibrium.tangential is not None  # where something rubs
        told = "contact pressure along the normal of the touching surface"
        found["surface_pressure"] = whole.variable(dims, "pressure", told, equilibrium.pressure[0])
        rubs, values = "traction on the body along the touching surface", equilibrium.tangential.traction[0]
        found.update(whole.variables(dims, _by_axis("surface_traction", "pressure", rubs, values)))
    row = ROUGH_BODY_OBSERVABLES["next_order"]
    found["next_order"] = whole.variable((), "length", row.long_name, solved.next_order)
    refuse_nonfinite(found)


def _moved(
    body: RoughBody, whose: str, response: Response, along: Reals | None, pressure: Reals
) -> Iterator[Described]:
    sideways = np.zeros((pressure.ndim, *pressure.shape)) if along is None else along
    flat = body.elastic.response(pressure.shape).apply(np.stack((*sideways, -pressure)))
    yield "displacement", "height", f"normal displacement of the {whose}, out of it", flat[-1] + response.u3
    if response.along is not None:
        way = f"tangential displacement of the {whose}"
        yield from _by_axis("tangential_displacement", "height", way, flat[:-1] + response.along)


def _moved_around_a_window(
    body: RoughBody, whose: str, along: Reals | None, pressure: Reals, ends: tuple[bool, ...]
) -> Described:
    """The same, of the normal displacement alone."""
    sideways = () if along is None else along.reshape(-1, *pressure.shape)
    moved = free_body.displaced(np.stack((*sideways, -pressure)), body.elastic, ends)[-1]
    return "displacement", "height", f"normal displacement of the {whose}, out of it", moved


def forming_tractions(body: RoughBody, whose: str, order: int) -> Iterator[Described]:
    """Tractions (E*) that form the topography; none of maps.

    `order` is that in the slope to which the topography is then followed.
    """
    if body.heights.ndim > 1:
        return
    names = "stress5", "stress3"
    tangential, normal = topography.formed_at(body.heights, np.zeros(1), body.elastic, order, names)[:, 0]
    forms = f"traction that forms the topography of the {whose} from flat (5.15)"
    yield "forming_traction", "pressure", f"normal {forms}", normal
    yield "tangential_forming_traction", "pressure", f"tangential {forms}", tangential


def _by_axis(name: str, kind: str, long_name: str, along: Reals, comma: str = ", ") -> Iterator[Described]:
    """A tangential field `[component, (y,) x]`, one along x and on maps one along y."""
    for values, component in zip(along, COMPONENTS[2], strict=False):
        yield f"{name}{component.end}", kind, f"{long_name}{comma}{component.way}", values


def _add_followed(
    step: xr.Dataset, given: ContactInput, problem: Problem, contact: Contact, followed: Followed
) -> None:
    """Add the load at the largest jump of a step of a path, and how stable its end is."""
    name, kind = ("displacement", "height") if problem.mean_pressure is None else ("pressure", "pressure")
    found = {f"jump_{name}": (kind, f"{name} at the largest jump since the last step", followed.jump_at)}
    if problem.interface.couples:
        sliding = "tangential displacement of the punch at the largest jump since the last step"
        found["jump_sliding"] = ("height", sliding, followed.jump_sliding)
    curvature = jumps.stability(problem, contact)
    if curvature is not None:
        found["stability"] = ("1", "smallest curvature of the energy over that of the bodies alone", curvature)
    step.update({key: units_of(given).variable((), *variable) for key, variable in found.items()})


def _recorded(given: ContactInput, record: PathRecord) -> dict[str, Any]:
    of_path, of_steps = record.of_path(), record.of_steps()
    found = {}
    for name, row in recorded_along(given.file.scene, given.surfaces.order).items():
        dims, values = ((), of_path) if row.of == "path" else ("step", of_steps)
        found[name] = units_of(given).variable(dims, row.unit, row.long_name, values[name])
    return found


def _with_loads(dataset: xr.Dataset, given: ContactInput, problem: Problem) -> xr.Dataset:
    """Return the dataset with the loading of each step of a path as coordinates; a load also as p/(g E*)."""
    attributes = load_attributes(given.file.scene)
    found: dict[str, list[float]] = {}
    for (scene, sliding), load in zip(given.steps, (problem.step, *problem.path), strict=True):
        own = {} if problem.displacement is not None else {"reduced_pressure": load.load}
        own[scene.loading.control] = float(getattr(scene.loading, scene.loading.control))
        own |= {} if scene.loading.speed is None else {"speed": float(scene.loading.speed)}
        for name, value in (own | dict(zip(SLIDING, map(float, sliding), strict=False))).items():
            found.setdefault(PRESCRIBED.get(name, name), []).append(value)
    if (given.file.scene.creeps and given.file.scene.loading.speed is None) or given.file.scene.has_slip_rates:
        found["time"] = times_of(scene for scene, _ in given.steps)
    dims, some = ("step", slice(dataset.sizes["step"])) if given.file.path else ((), 0)
    named = found if given.file.path else found.keys() - set(SLIDING)
    return dataset.assign_coords(
        {name: (dims, values[some], attributes[name]) for name, values in found.items() if name in named}
    )


def boundary_dataset(given: BoundaryInput) -> xr.Dataset:
    """Displacements and tractions of all components over `x`, or (y, x), and how they were reached, in SI units.

    Of a rough body also its topography, and what forms that. The attribute `validity` holds the warnings.
    """
    file, scene, solved = given.file, given.file.scene, solve_boundary_values(given)
    deformed = solved.deformed
    unit, dims = Units.of(scene, 1.0), AXES[-scene.dimension :]
    found: dict[str, Any] = {}
    for kind, quantity, values in (
        ("height", "displacement", deformed.displacement),
        ("pressure", "traction", deformed.traction),
    ):
        for component, of_nodes in zip(COMPONENTS[scene.dimension], values, strict=True):
            long_name = f"{component.name} {quantity} of the body, {component.way}"
            found[component.key(quantity)] = unit.variable(dims, kind, long_name, of_nodes)
    for body in given.bodies:
        outwards = "topography of the body, peaks outwards"
        found["body_height"] = unit.variable(dims, "height", outwards, body.heights)
        found |= unit.variables(dims, forming_tractions(body, "body", file.slope_order))
        row = ROUGH_BODY_OBSERVABLES["next_order"]
        found["next_order"] = unit.variable((), row.unit, row.long_name, solved.next_order)
    for name in ("status", "residual", "n_iterations", "n_transforms", "wall_time"):
        row, value = OBSERVABLES[name], getattr(deformed, name)
        value = np.int8(value) if name == "status" else value
        found[name] = unit.variable((), row.unit, _TOLD.get(name, row.long_name), value, name)
    attributes = {"Conventions": CONVENTIONS, "title": "loaded body", **given.record}
    attributes |= {"solver": solved.solver} | modulus_attributes(scene)
    dataset = xr.Dataset(found, unit.positions(deformed.traction.shape[1:], scene.length), attributes)
    refuse_nonfinite(dataset)
    sentences = given.implausible
    if given.bodies:
        sentences += given.doubts
        warned = rough_body_warnings(given.bodies, file.slope_order, scene.ends, dataset)
        sentences += [sentence for _, sentence in warned]
        dataset.attrs["processing"] = given.processing
    dataset.attrs["validity"] = "\n".join(filter(None, sentences))
    return dataset
