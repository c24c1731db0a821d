"""What `gfmd solve` writes of a contact: a dataset of one loading, or of all steps of a path."""

from collections.abc import Iterable

import xarray as xr

from gfmd_numba.contact import law_resolution, rough_bodies_dataset
from gfmd_numba.contact.contact_input import ContactInput
from gfmd_numba.contact.dataset import contact_dataset, dropped_effects, indexed, load_attributes
from gfmd_numba.contact.load_path import LoadPath, steps_of
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.solution import Contact
from gfmd_numba.contact.two_step import Pressed

_NAMES = {"displacement": "punch_displacement"}  # the body's own has the short name


def path_dataset(given: ContactInput, path: LoadPath, solved: Iterable[Contact | Pressed]) -> xr.Dataset:
    """Fields and observables in SI units over x, or (y, x), and over the steps of a path.

    The attribute `validity` says, a sentence a line, what speaks against the result.
    """
    file = given.file
    steps = [step_dataset(given, problem, each) for problem, each in zip(path.problems, solved, strict=True)]
    dataset = steps[0] if not file.path else _joined(steps, given)
    dataset.attrs |= {
        "scene": file.model_dump_json(),
        "solver": path.problems[-1].numerics.solver,
        "dropped_effects": dropped_effects(path.effects),
        "processing": "\n".join(sentence for surface in given.measured for sentence in surface.done),
        "validity": doubts(given, path, dataset),
    }
    return dataset


def step_dataset(given: ContactInput, problem: Problem, solved: Contact | Pressed) -> xr.Dataset:
    """Fields and observables of one step in SI units over x, or (y, x)."""
    scene, surfaces = given.file.scene, given.surfaces
    contact = solved if isinstance(solved, Contact) else solved.contact
    step = contact_dataset(scene, problem, surfaces.rms_gradient, contact)
    if isinstance(solved, Pressed) and surfaces.bodies is not None:
        rough_bodies_dataset.add_bodies(step, scene, surfaces.bodies, surfaces.rms_gradient, solved)
    return step


def doubts(given: ContactInput, path: LoadPath, dataset: xr.Dataset) -> str:
    """What speaks against a step, or all steps, of a path, a sentence a line."""
    steep = "" if given.surfaces.bodies is None else rough_bodies_dataset.doubt(given.surfaces.bodies, dataset)
    coarse = law_resolution.doubt(path.problems[-1], given.file.discretisation)
    implausible = (sentence for surface in given.measured for sentence in surface.doubts)
    return "\n".join([*implausible, *filter(None, (steep, coarse))])


def _joined(steps: list[xr.Dataset], given: ContactInput) -> xr.Dataset:
    """The steps of a path, with what was prescribed in each as coordinates."""
    joined = xr.concat(
        steps, "step", data_vars="all", coords="minimal", compat="override", join="exact", combine_attrs="override"
    )
    prescribed = [
        scene.loading.model_dump(exclude_none=True) | {"sliding": sliding} for scene, sliding in steps_of(given.file)
    ]
    attributes = load_attributes(given.file.scene)
    coordinates = {name: _NAMES.get(name, name) for name in prescribed[0]}
    return indexed(joined).assign_coords(
        {
            coordinate: ("step", [each[name] for each in prescribed], attributes[coordinate])
            for name, coordinate in coordinates.items()
        }
    )
