"""Fields inside the body under a solved contact, as a dataset."""

import numpy as np
import numpy.typing as npt
import xarray as xr

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.bodies import elastic_body
from gfmd_numba.elasticity import fields, topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.scene import Body, InputError, LoadedBody
from gfmd_numba.simulate import map_fields
from gfmd_numba.simulate.fields_dataset import OF_PROFILES, Scales, add_fields, add_formed, add_von_mises, begun
from gfmd_numba.simulate.solved_contact import described, nodes_of, tractions_on
from gfmd_numba.text.input_error import brief

_LEVELS = 101


def body_fields(
    contact: xr.Dataset,
    z: npt.ArrayLike | None = None,
    body: str = "body",
    x: float | None = None,
    y: float | None = None,
    planes: npt.ArrayLike | None = None,
) -> xr.Dataset:
    """Displacement, strain and stress `(z, x)`, of a path `(step, z, x)`, inside a body of a solved contact.

    `z` counts from the mean plane of the undeformed surface, negative inside, in m (L_x without a length); by default
    101 levels from the surface down to the rigid base, else to L_x or the last layer, denser near the surface; at an
    interface of layers stresses are those above it. Stresses are in Pa (E* without a modulus), numbered as Voigt does.

    Below a map the fields are on the vertical section nearest to `y` `(z, x)` or to `x` `(z, y)`, without either on
    the one through the largest von Mises stress of all steps, or on whole horizontal `planes` at these z `(z, y, x)`;
    `peak_...` `(z)` is the largest stress of each whole plane, and its place.

    (x, z) of a rough body are labels, its places while it was flat: `formed_1` and `formed_3` (u'' of thesis 5.2) take
    them to the stress-free body; `formed_2`, along y, is there below maps. A `counter_body` is seen in axes of its own,
    z out of it. What belongs to a run that is not ok is not-a-number. Raises InputError for z outside the body, x or y
    outside the period or of a profile, planes that do not fit in memory, and a dataset that no contact was solved for.
    Thesis (2.4) to (2.6), (5.6).
    """
    scene, order = described(contact, body)
    asked = scene.body if body == "body" or isinstance(scene, LoadedBody) else scene.counter_body
    assert asked is not None  # described's promise
    length = scene.length or 1.0
    elastic = elastic_body(asked, scene.length)
    if z is not None and planes is not None:
        raise InputError(f"planes: you gave {brief(planes)} in addition to z; gfmd allows either of them")
    name, given = ("z", z) if planes is None else ("planes", planes)
    unit = "L_x" if scene.length is None else "m"
    heights = _levels(elastic, length) if given is None else _checked(elastic, length, given, name, unit)
    whole = contact if "step" in contact.dims else contact.expand_dims("step")
    if len(nodes_of(scene)) == 2:
        wanted = map_fields.Wanted(heights, x, y, planes is not None)
        steps = map_fields.of_steps(whole, asked, body, elastic, length, order, wanted)
    elif x is None and y is None and planes is None:
        every = (whole.isel(step=i) for i in range(whole.sizes["step"]))
        steps = [_one(asked, elastic, length, order, step, heights, body) for step in every]
    else:
        argument, value = next((n, v) for n, v in (("x", x), ("y", y), ("planes", planes)) if v is not None)
        raise InputError(
            f"{argument}: you gave {brief(value)}; gfmd allows nothing for a profile, which is one section"
        )
    for step in steps:
        step.attrs |= {"title": f"fields inside the {body.replace('_', ' ')}", "body": body}
    if "step" not in contact.dims:
        return steps[0]
    joined = xr.concat(steps, "step", data_vars="all", coords="minimal", compat="override", join="exact")
    return joined.assign_coords({name: given for name, given in contact.coords.items() if given.dims == ("step",)})


def _levels(body: ElasticBody, length: float) -> Reals:
    layers = 0.0 if body.stack is None else body.stack.height
    lowest = max(1.0, layers) if body.aspect_ratio is None else body.aspect_ratio
    return 0.0 - lowest * length * np.linspace(0.0, 1.0, _LEVELS) ** 2


def _checked(body: ElasticBody, length: float, given_z: npt.ArrayLike, name: str, unit: str) -> Reals:
    try:
        z = np.atleast_1d(np.asarray(given_z, dtype=np.float64))
    except (TypeError, ValueError):
        raise InputError(f"{name}: you gave {brief(given_z)}; gfmd allows a number, or one row of numbers") from None
    lowest = body.base * length
    outside = ~(np.isfinite(z) & (z <= 0.0) & (z >= lowest * (1.0 + 1e-12)))
    if z.ndim != 1 or z.size == 0 or outside.any():
        given = f"{z[outside][0]:g}" if z.ndim == 1 and z.size else f"an array of shape {z.shape}"
        allowed = f"one row of heights from {lowest:g} (the base) to 0 (the surface), in {unit}"
        raise InputError(f"{name}: you gave {given}; gfmd allows {allowed}")
    return z


def _one(
    body: Body, elastic: ElasticBody, length: float, order: int, contact: xr.Dataset, z: Reals, name: str
) -> xr.Dataset:
    scales, names = Scales.of(contact, body, length), tuple(OF_PROFILES)
    tractions, height = tractions_on(name, contact, ("x",)), f"{name}_height"
    dataset = begun(contact, z, scales)
    surface: fields.LoadedSurface = fields.surface_under_tractions(tractions / scales.worth["stress"], elastic)
    if height in contact:
        heights = contact[height].values / length
        surface = topography.rough_surface(tractions / scales.worth["stress"], heights, elastic, order)
        formed = topography.formed_at(heights, z / length, elastic, order, ("u1", "u3"))
        add_formed(dataset, ("z", "x"), dict(zip(("formed_1", "formed_3"), formed, strict=True)), scales)
    values = dict(zip(names, fields.section(surface, z / length, elastic, names), strict=True))
    if body.state == "plane_stress":
        values["stress2"] = np.zeros_like(values["stress2"])
    add_fields(dataset, ("z", "x"), values, OF_PROFILES, scales, int(contact["status"]) != 0)
    add_von_mises(dataset, ("z", "x"), scales)
    dataset["pressure"] = ("x", -tractions[-1], scales.attributes("stress", "pressure on the surface"))
    return dataset
