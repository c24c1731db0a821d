"""Prescribed tractions and displacements node by node, read from the user's files and checked for balance."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.roughness.surface_files import read_column
from gfmd_numba.scene import COMPONENTS, Boundary, Document, InputError
from gfmd_numba.scene.quantities import LARGEST

_ROUNDING = 1e-6  # mean over largest traction that is taken for rounding of a file, and subtracted


@dataclass(frozen=True)
class Tractions:
    """Tractions `[nx]` on the body, along x and out of it, in g E*."""

    digest: str
    tangential: Reals = field(repr=False, compare=False)
    normal: Reals = field(repr=False, compare=False)


def tractions(tangential: Reals, normal: Reals) -> Tractions:
    """Tractions `[nx]` with what tells them from others."""
    digest = hashlib.sha256(tangential.tobytes() + normal.tobytes()).hexdigest()
    return Tractions(digest, tangential, normal)


def read_boundary(document: Document, boundary: Boundary, nx: int | None) -> dict[str, Reals]:
    """Whatever is prescribed, by name `[nx]` in the file's units, not-a-number where it is not.

    Raises InputError for files that do not fit the grid (of `nx` nodes, None: that of the first file) or one another.
    """
    found: dict[str, Reals] = {}
    given = {name: value for name, value in boundary if value is not None}
    for name, value in given.items():
        if isinstance(value, str):
            found[name] = _read(document, name, Path(value), nx)
            nx = len(found[name])
    assert nx is not None  # the records' promise
    arrays = {name: found[name] if name in found else np.full(nx, float(value)) for name, value in given.items()}
    unset = np.full(nx, np.nan)
    for component in COMPONENTS:
        traction, displacement = (f"{component}_{kind}" for kind in ("traction", "displacement"))
        both = np.flatnonzero(np.isfinite(arrays.get(traction, unset) + arrays.get(displacement, unset)))
        if both.size:
            raise _refused(
                document,
                traction,
                f"{arrays[traction][both[0]]:g} at node {both[0]}",
                f"a file with not-a-number at the nodes whose {displacement} is prescribed, of which this is one",
            )
    return arrays


def balanced(document: Document, arrays: Mapping[str, Reals], component: str, remedy: str) -> dict[str, Reals]:
    """The same with a mean traction of exactly 0 in one component; raises InputError, naming the remedy, if it is not.

    A mean below 1e-6 of the largest traction is rounding, as of a text file, and subtracted.
    """
    name = f"{component}_traction"
    if name not in arrays:
        return dict(arrays)
    given = arrays[name]
    values = np.nan_to_num(given, nan=0.0)
    mean = values.mean()
    if abs(mean) > _ROUNDING * abs(values).max():
        raise _refused(document, name, f"a mean of {mean:g}", f"a mean of 0, {remedy}")
    return {**arrays, name: values - mean}


def _read(document: Document, name: str, path: Path, nx: int | None) -> Reals:
    try:
        values = read_column(path)
    except ValueError as error:
        raise _refused(document, name, f"{path.name} ({error})", "one column of numbers") from None
    if (abs(values) > LARGEST).any():
        where = int(np.argmax(abs(values) > LARGEST))
        allowed = f"finite numbers of at most {LARGEST:g}, and not-a-number where nothing is prescribed"
        raise _refused(document, name, f"{path.name} ({values[where]} at index {where})", allowed)
    if not np.isfinite(values).any():
        raise _refused(document, name, f"{path.name} (no number)", "a number for at least one node")
    if nx is not None and len(values) != nx:
        raise _refused(document, name, f"{path.name} ({len(values)} values)", f"one value for each of the {nx} nodes")
    return values


def _refused(document: Document, name: str, given: str, allowed: str) -> InputError:
    return InputError(document.line(("scene", "boundary", name), given, allowed))
