"""Prescribed tractions and displacements node by node, read from the user's files and checked for balance."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.scales import scales_of
from gfmd_numba.roughness.surface_files import read_values
from gfmd_numba.scene import COMPONENTS, Boundary, Document, InputError, Scene
from gfmd_numba.scene.document import Location
from gfmd_numba.scene.quantities import LARGEST

_ROUNDING = 1e-6  # mean over largest traction that is taken for rounding of a file, and subtracted


@dataclass(frozen=True)
class Tractions:
    """Tractions on the body out of it `[(ny,) nx]` and along it `[component, (ny,) nx]`, along x first, in g E*."""

    digest: str
    tangential: Reals = field(repr=False, compare=False)
    normal: Reals = field(repr=False, compare=False)


def tractions(tangential: Reals, normal: Reals) -> Tractions:
    """Tractions, shaped as `Tractions` says, with what tells them from others."""
    digest = hashlib.sha256(tangential.tobytes() + normal.tobytes()).hexdigest()
    return Tractions(digest, tangential, normal)


def tractions_on_the_body(
    document: Document, scene: Scene, arrays: Mapping[str, Reals], shape: tuple[int, ...], rms_gradient: float
) -> Tractions:
    """Tractions of what `read_boundary` has read, with a punch whose rms gradient they are divided by.

    Raises InputError for a mean traction that nothing holds, or that the loading decides already.
    """
    *tangential, normal = (component.key("traction") for component in COMPONENTS[scene.dimension])
    is_held = any(scene.ends)  # by the body around it, and the load is what the punch bears
    if scene.loading.displacement is None and not is_held:
        control = scene.loading.control
        arrays = balanced(document, arrays, normal, f"as loading.{control} prescribes the mean pressure")
    for name in tangential if scene.body.is_half_space and not is_held else ():
        arrays = balanced(document, arrays, name, f"or {scene.body.holder}, as nothing holds a half-space")
    scale = rms_gradient * scales_of(scene).modulus
    found = [np.nan_to_num(arrays.get(name, np.zeros(shape)), nan=0.0) / scale for name in (*tangential, normal)]
    return tractions(np.stack(found[:-1]), found[-1])


def read_boundary(
    document: Document, boundary: Boundary, dimension: int, shape: tuple[int, ...] | None
) -> dict[str, Reals]:
    """Whatever is prescribed, by name `[(ny,) nx]` in the file's units, not-a-number where it is not.

    Raises InputError for files that do not fit the grid of that shape (None: that of the first file) or one another.
    """
    found: dict[str, Reals] = {}
    given = {name: value for name, value in boundary if value is not None}
    for name, value in given.items():
        if isinstance(value, str):
            found[name] = read_nodes(document, ("scene", "boundary", name), Path(value), dimension, shape, whole=False)
            shape = found[name].shape
    assert shape is not None  # the records' promise
    arrays = {name: found[name] if name in found else np.full(shape, float(value)) for name, value in given.items()}
    unset = np.full(shape, np.nan)
    for component in COMPONENTS[dimension][::-1]:
        traction, displacement = (component.key(quantity) for quantity in ("traction", "displacement"))
        both = np.flatnonzero(np.isfinite(arrays.get(traction, unset) + arrays.get(displacement, unset)))
        if both.size:
            raise refused(
                document,
                ("scene", "boundary", traction),
                f"{arrays[traction].flat[both[0]]:g} at node {_place(both[0], shape)}",
                f"a file with not-a-number at the nodes whose {displacement} is prescribed, of which this is one",
            )
    return arrays


def balanced(document: Document, arrays: Mapping[str, Reals], name: str, remedy: str) -> dict[str, Reals]:
    """Return the arrays, of which the traction of that name then has a mean of exactly 0.

    A mean below 1e-6 of the largest traction is rounding, as of a text file, and is subtracted. Raises InputError, with
    the remedy, for a larger one.
    """
    if name not in arrays:
        return dict(arrays)
    given = arrays[name]
    values = np.nan_to_num(given, nan=0.0)
    mean = values.mean()
    if abs(mean) > _ROUNDING * abs(values).max():
        raise refused(document, ("scene", "boundary", name), f"a mean of {mean:g}", f"a mean of 0, {remedy}")
    return {**arrays, name: values - mean}


_FILES = {1: "a column of numbers as text, or an array of one dimension", 2: "rows of numbers, one for each y"}


def read_nodes(
    document: Document, place: Location, path: Path, dimension: int, shape: tuple[int, ...] | None, whole: bool
) -> Reals:
    """Values `[(ny,) nx]` of a file that is named at a place, of which some may be not-a-number unless it is `whole`.

    Raises InputError for one that does not fit a grid of that shape (None: any), or has no number.
    """
    try:
        values = read_values(path, dimension)
    except ValueError as error:
        raise refused(document, place, f"{path.name} ({error})", _FILES[dimension]) from None
    wrong = (abs(values) > LARGEST) | (whole & np.isnan(values))
    if wrong.any():
        where = int(np.argmax(wrong))
        at = f"{values.flat[where]} at index {_place(where, values.shape)}"
        holes = "" if whole else ", and not-a-number where nothing is prescribed"
        allowed = f"finite numbers of at most {LARGEST:g}{holes}"
        raise refused(document, place, f"{path.name} ({at})", allowed)
    if not np.isfinite(values).any():
        raise refused(document, place, f"{path.name} (no number)", "a number for at least one node")
    if shape is not None and values.shape != shape:
        given, allowed = (" x ".join(map(str, each)) for each in (values.shape, shape))
        raise refused(document, place, f"{path.name} ({given} values)", f"one value for each of the {allowed} nodes")
    return values


def _place(node: int, shape: tuple[int, ...]) -> str:
    """Index of a node of an array in that shape, as a file's reader counts it: of maps the row, then the column."""
    return ", ".join(str(int(index)) for index in np.unravel_index(node, shape))


def refused(document: Document, place: Location, given: str, allowed: str) -> InputError:
    """Error of what a file has, and what is allowed in its place."""
    return InputError(document.line(place, given, allowed))
