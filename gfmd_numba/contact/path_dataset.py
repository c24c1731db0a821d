"""What `gfmd solve` writes of a contact: a dataset of one loading, or of all steps of a path."""

from collections.abc import Iterable

import xarray as xr

from gfmd_numba.contact import law_resolution, rough_bodies_dataset
from gfmd_numba.contact.contact_input import ContactInput
from gfmd_numba.contact.dataset import contact_dataset, dropped_effects, indexed, load_attributes
from gfmd_numba.contact.load_path import LoadPath, steps_of
from gfmd_numba.contact.solution import Contact
from gfmd_numba.contact.two_step import Pressed

_NAMES = {"displacement": "punch_displacement"}  # the body's own has the short name


def path_dataset(given: ContactInput, path: LoadPath, solved: Iterable[Contact | Pressed]) -> xr.Dataset:
    """Fields and observables in SI units over x, or (y, x), and over the steps of a path.

    The attribute `validity` says, a sentence a line, what speaks against the result.
    """
    file, surfaces = given.file, given.surfaces
    steps = []
    for problem, each in zip(path.problems, solved, strict=True):
        contact = each if isinstance(each, Contact) else each.contact
        step = contact_dataset(file.scene, problem, surfaces.rms_gradient, contact)
        if isinstance(each, Pressed) and surfaces.bodies is not None:
            rough_bodies_dataset.add_bodies(step, file.scene, surfaces.bodies, surfaces.rms_gradient, each)
        steps.append(step)
    dataset = steps[0] if not file.path else _joined(steps, given)
    dataset.attrs |= {
        "scene": file.model_dump_json(),
        "solver": path.problems[-1].numerics.solver,
        "dropped_effects": dropped_effects(path.effects),
        "processing": "\n".join(sentence for surface in given.measured for sentence in surface.done),
        "validity": "\n".join(_doubts(given, path, dataset)),
    }
    return dataset


def _doubts(given: ContactInput, path: LoadPath, dataset: xr.Dataset) -> list[str]:
    steep = "" if given.surfaces.bodies is None else rough_bodies_dataset.doubt(given.surfaces.bodies, dataset)
    coarse = law_resolution.doubt(path.problems[-1], given.file.discretisation)
    implausible = [sentence for surface in given.measured for sentence in surface.doubts]
    return [*implausible, *filter(None, (steep, coarse))]


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
