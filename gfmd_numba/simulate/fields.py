"""Fields inside the body under a solved contact: of profiles, and of maps on a section or on planes.

The contact comes back from its dataset, if all nodes of its period are there.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import xarray as xr

from gfmd_numba.arrays import Reals
from gfmd_numba.arrays.threads import shared_by
from gfmd_numba.contact.contact_dataset import CONVENTIONS, POINTS, POINTS_OF_WINDOW, Units, cf_attributes
from gfmd_numba.elasticity import fields, free_fields, topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.fields import DISPLACEMENTS, STRAINS, STRESSES, Axis, Inside, Largest, LoadedSurface
from gfmd_numba.elasticity.scales import effective_modulus, scales_of
from gfmd_numba.scene import COMPONENTS, Body, InputError, Scene, SceneFile
from gfmd_numba.scene.checks import beyond_memory
from gfmd_numba.scene.measured_record import AXES
from gfmd_numba.text.input_error import brief
from gfmd_numba.text.recorded_scene import asked

_LEVELS = 101
_BELOW = 1e-9  # of the depth of an interface is the level below it deeper than that above
_NAMES = DISPLACEMENTS + STRAINS + STRESSES
_ARRAYS = 40  # of the size of the map that fields of one plane take
_ARRAYS_OF_TOPOGRAPHY, _ARRAYS_OF_ORDER = 30, 40  # more of them above order 0 in the slope, and for each order
_PADDED = 2  # times as many for each axis without a period
_ARRAYS_OF_A_PLANE = 2 * 20  # that stay in memory, and are joined

_ALONG, _OF_PLANES = ("x", "y", "z"), ("y and z", "x and z", "x and y")  # in Voigt's order
_OF_MAPS = {
    **{f"u{i}": f"displacement along {way}" for i, way in enumerate(_ALONG, 1)},
    "u3": "displacement along z, out of the body",
    **{f"strain{i}": f"strain along {way}" for i, way in enumerate(_ALONG, 1)},
    **{f"strain{i}": f"engineering shear strain of {plane}" for i, plane in enumerate(_OF_PLANES, 4)},
    **{f"stress{i}": f"stress along {way}, tension positive" for i, way in enumerate(_ALONG, 1)},
    **{f"stress{i}": f"shear stress of {plane}" for i, plane in enumerate(_OF_PLANES, 4)},
}
_OF_PROFILES = _OF_MAPS | {
    "strain5": "engineering shear strain in the plane",
    "stress2": "stress out of the plane, tension positive",
    "stress5": "shear stress in the plane",
}
_IN_PLANE = ("u1", "u3", "strain1", "strain3", "strain5", "stress1", "stress2", "stress3", "stress5")  # of profiles
_LONG_NAMES = {1: _OF_PROFILES, 2: _OF_MAPS}
_QUANTITIES = {"u": ("displacement", "length"), "strain": ("strain", "1"), "stress": ("stress", "stress")}
_ROUNDING = 1e-3  # of the spacing, by which nodes may be off their places
_WHOLE = "all nodes of the period, as `gfmd solve` leaves them; cut the fields inside afterwards"
_ALTERED = "contact: you gave a contact that was altered; gfmd allows what `gfmd solve` leaves"
_PRESCRIBED, _COUNTER = "prescribed_", "counter_body_"


@dataclass(frozen=True)
class _Inside:
    """One body of a solved contact: its `name`, record and elasticity, and the order its topography is followed to.

    `units` are what lengths in L_x and stresses in its E* are worth in the file, and `nodes` the dims of its nodes. A
    body is loaded in a window that `ends` along some of (y,) x.
    """

    name: str
    record: Body
    elastic: ElasticBody
    order: int
    units: Units
    nodes: tuple[str, ...]
    ends: tuple[bool, ...]

    @property
    def length(self) -> float:
        """Period in the unit of the file."""
        return self.units.worth["length"]

    def tractions(self, step: xr.Dataset) -> Reals:
        """Tractions `[component, (y,) x]` on the body, in its E*."""
        return tractions_on(self.name, step, self.nodes) / self.units.worth["stress"]

    def heights(self, step: xr.Dataset) -> Reals | None:
        """Topography `[(y,) x]` in L_x, None for a flat body, and without a period, where it is not followed inside."""
        name = f"{self.name}_height"
        if any(self.ends):
            return None  # which order 0 is
        return step[name].values / self.length if name in step else None

    def below(self, step: xr.Dataset) -> Inside:
        """The inside under the tractions of a step."""
        tractions, heights = self.tractions(step), self.heights(step)
        if any(self.ends):
            return free_fields.under_tractions(tractions, self.elastic, self.ends)
        surface: LoadedSurface = fields.surface_under_tractions(tractions, self.elastic)
        if heights is not None and heights.any():
            surface = topography.rough_surface(tractions, heights, self.elastic, self.order)
        return Inside((surface,), self.elastic)


@dataclass(frozen=True)
class _Wanted:
    """Heights z in the unit of x, and the section x = ... or y = ... through them, or whole planes."""

    z: Reals
    x: float | None
    y: float | None
    planes: bool


@shared_by(1)
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
    101 levels from the surface down to the rigid base, else to L_x or the last layer, denser near the surface, and two
    at each interface of layers, as stresses jump there: those of a level at it are above it. Stresses are in Pa (E*
    without a modulus), numbered as Voigt does.

    Below a map the fields are on the vertical section nearest to `y` `(z, x)` or to `x` `(z, y)`, without either on
    the one through the largest von Mises stress of all steps, or on whole horizontal `planes` at these z `(z, y, x)`;
    `peak_...` `(z)` is the largest stress of each whole plane, and its place. Without a period the fields are those in
    the window, and below it.

    (x, z) of a rough body are labels, its places while it was flat: `formed_1` and `formed_3` (u'' of thesis 5.2) take
    them to the stress-free body; `formed_2`, along y, is there below maps. A `counter_body` is seen in axes of its own,
    z out of it. What belongs to a run that is not ok is not-a-number. Raises InputError for z outside the body, x or y
    outside the period or of a profile, planes that do not fit in memory, and a dataset that no contact was solved for.
    Thesis (2.4) to (2.6), (5.6).
    """
    scene, order = described(contact, body)
    asked = scene.body if body == "body" else scene.counter_body
    assert asked is not None  # described's promise
    length = scene.length or 1.0
    elastic = scales_of(scene).bodies[0 if body == "body" else 1]
    if z is not None and planes is not None:
        raise InputError.of("planes", f"{brief(planes)} in addition to z", "either of them")
    name, given = ("z", z) if planes is None else ("planes", planes)
    unit = "L_x" if scene.length is None else "m"
    heights = _levels(elastic, length) if given is None else _checked(elastic, length, given, name, unit)
    whole = contact if "step" in contact.dims else contact.expand_dims("step")
    every = [whole.isel(step=i) for i in range(whole.sizes["step"])]
    ends = scene.ends
    inside = _Inside(body, asked, elastic, order, _units(contact, asked, length), nodes_of(scene), ends)
    if scene.dimension == 2:
        steps = _of_map(every, inside, _Wanted(heights, x, y, planes is not None))
    elif x is None and y is None and planes is None:
        steps = [_section(step, heights, inside) for step in every]
    else:
        argument, value = next((n, v) for n, v in (("x", x), ("y", y), ("planes", planes)) if v is not None)
        raise InputError.of(argument, brief(value), "nothing for a profile, which is one section")
    for step in steps:
        step.attrs |= {"title": f"fields inside the {body.replace('_', ' ')}", "body": body}
    if "step" not in contact.dims:
        return steps[0]
    joined = xr.concat(steps, "step", data_vars="all", coords="minimal", compat="override", join="exact")
    return joined.assign_coords({name: given for name, given in contact.coords.items() if given.dims == ("step",)})


def _units(contact: xr.Dataset, body: Body, length: float) -> Units:
    stress = (contact["pressure"] if "pressure" in contact else contact["normal_traction"]).attrs["units"]
    worth = {"length": length, "stress": effective_modulus(body, stress != "1"), "1": 1.0}
    return Units(worth, {"length": contact["x"].attrs["units"], "stress": stress, "1": "1"})


def _levels(body: ElasticBody, length: float) -> Reals:
    layers = 0.0 if body.stack is None else body.stack.height
    lowest = max(1.0, layers) if body.aspect_ratio is None else body.aspect_ratio
    levels = lowest * np.linspace(0.0, 1.0, _LEVELS) ** 2
    if body.stack is not None:  # stresses jump: both sides of each interface
        bottoms = np.cumsum(body.stack.heights)[: None if body.stack.base is not None else -1]
        levels = np.unique(np.concatenate([levels, bottoms, bottoms * (1.0 + _BELOW)]))
    return 0.0 - levels * length


def _checked(body: ElasticBody, length: float, given_z: npt.ArrayLike, name: str, unit: str) -> Reals:
    try:
        z = np.atleast_1d(np.asarray(given_z, dtype=np.float64))
    except (TypeError, ValueError):
        raise InputError.of(name, brief(given_z), "a number, or one row of numbers") from None
    lowest = body.base_z * length
    outside = ~(np.isfinite(z) & (z <= 0.0) & (z >= lowest * (1.0 + 1e-12)))
    if z.ndim != 1 or z.size == 0 or outside.any():
        given = f"{z[outside][0]:g}" if z.ndim == 1 and z.size else f"an array of shape {z.shape}"
        allowed = f"one row of heights from {lowest:g} (the base) to 0 (the surface), in {unit}"
        raise InputError.of(name, given, allowed)
    return z


def _dataset(
    step: xr.Dataset,
    inside: _Inside,
    z: Reals,
    values: Mapping[str, Reals],
    formed: Mapping[str, Reals],
    cut: Mapping[str, int],
) -> xr.Dataset:
    """Dataset of named fields (L_x, E*) at heights z and the nodes of a cut, and of what forms the topography (L_x).

    Fields are not-a-number where the run failed. Raises InputError for any that are not finite.
    """
    section, units, long_names = step.isel(cut), inside.units, _LONG_NAMES[len(inside.nodes)]
    nodes = sorted(inside.nodes, key=lambda dim: dim in cut)
    dims = ("z", *(dim for dim in nodes if dim not in cut))
    coordinates = {"z": ("z", z, cf_attributes("height above the undeformed surface", units.names["length"]))}
    dataset = xr.Dataset(
        coords=coordinates | {dim: section[dim] for dim in nodes},
        attrs={"Conventions": CONVENTIONS, "scene": step.attrs["scene"], **asked(step.attrs)},
    )
    failed = int(step["status"]) != 0
    for name, field in values.items():
        quantity, kind = _QUANTITIES[name[:-1]]
        scaled = np.full_like(field, np.nan) if failed else field * units.worth[kind]
        if not failed and not np.isfinite(scaled).all():
            raise InputError.of("contact", "a contact whose fields are not finite", "what `gfmd solve` leaves")
        dataset[f"{quantity}_{name[-1]}"] = dims, scaled, cf_attributes(long_names[name], units.names[kind])
    stresses = (dataset[f"stress_{i}"].values for i in range(1, 7) if f"stress_{i}" in dataset)
    attributes = cf_attributes("von Mises's equivalent stress", units.names["stress"])
    dataset["von_mises"] = dims, fields.von_mises(*stresses), attributes
    for name, moved in formed.items():
        dataset[name] = units.variable(dims, "length", "displacement that forms the topography", moved)
    borne = xr.DataArray(-tractions_on(inside.name, step, inside.nodes)[-1], dims=inside.nodes).isel(cut)
    dataset["pressure"] = dims[1:], borne.values, cf_attributes("pressure on the surface", units.names["stress"])
    return dataset


def _of_map(steps: Sequence[xr.Dataset], inside: _Inside, wanted: _Wanted) -> list[xr.Dataset]:
    """Fields of each step of a map's contact; raises InputError for what is wanted of it that cannot be had."""
    order, z, topographies = inside.order, wanted.z / inside.length, [inside.heights(step) for step in steps]
    is_followed = order > 0 and any(heights is not None and heights.any() for heights in topographies)
    arrays = _ARRAYS + is_followed * (_ARRAYS_OF_TOPOGRAPHY + order * _ARRAYS_OF_ORDER)
    _check(steps[0], len(steps), inside, wanted, arrays * _PADDED ** sum(inside.ends))
    largest = [inside.below(step).largest_von_mises(z) for step in steps]
    if wanted.planes:
        found = []
        for step in steps:
            below = inside.below(step)
            planes = np.stack([below.plane(float(depth), _NAMES) for depth in z], axis=1)
            found.append(_dataset(step, inside, wanted.z, dict(zip(_NAMES, planes, strict=True)), {}, {}))
    else:
        place = _place(steps, largest, inside, wanted)
        found = [_section(step, wanted.z, inside, place) for step in steps]
    for step, dataset, peaks in zip(steps, found, largest, strict=True):
        _add_peaks(dataset, peaks, inside.units, int(step["status"]) != 0)
    return found


def _check(step: xr.Dataset, n_steps: int, inside: _Inside, wanted: _Wanted, arrays: int) -> None:
    for name, given in (("x", wanted.x), ("y", wanted.y)):
        if given is None:
            continue
        if wanted.planes or (name == "y" and wanted.x is not None):
            other = "planes" if wanted.planes else "x"
            raise InputError.of(name, f"{brief(given)} in addition to {other}", "one section x, y, or planes")
        number = isinstance(given, (int, float, np.floating, np.integer)) and not isinstance(given, bool)
        if not number or not 0.0 <= given <= inside.length:
            unit = "m" if inside.units.names["length"] == "m" else "L_x"
            raise InputError.of(name, brief(given), f"a number from 0 to {inside.length:g}, in {unit}")
    ny, nx, levels = step.sizes["y"], step.sizes["x"], wanted.z.size
    if allowed := beyond_memory(ny * nx, arrays, "a section below it"):
        raise InputError.of("contact", f"{ny} x {nx} nodes", allowed)
    kept = arrays + _ARRAYS_OF_A_PLANE * levels * n_steps
    if wanted.planes and (allowed := beyond_memory(ny * nx, kept, "this stack of planes")):
        raise InputError.of("planes", f"{levels} heights", f"fewer, or {allowed}")


def _place(
    steps: Sequence[xr.Dataset], largest: Sequence[Largest], inside: _Inside, wanted: _Wanted
) -> tuple[Axis, int]:
    """Axis across a section and the nearest of its nodes; without either, the section has the largest stress of all."""
    across: Axis = "y" if wanted.x is None else "x"
    nodes = steps[0].sizes[across]
    given = wanted.y if wanted.x is None else wanted.x
    if given is None:
        found = [(peak.von_mises.max(), peak.y[peak.von_mises.argmax()]) for peak in largest]
        ok = [each for each, step in zip(found, steps, strict=True) if int(step["status"]) == 0]
        place = max(ok, default=(0.0, 0.0))[1]
    else:
        place = given / inside.length
    nearest = round(place * nodes)
    return across, min(nearest, nodes - 1) if inside.ends[inside.nodes.index(across)] else nearest % nodes


def _section(step: xr.Dataset, z: Reals, inside: _Inside, place: tuple[Axis, int] | None = None) -> xr.Dataset:
    """Fields of a map on the section across an axis at one of its nodes, or of a profile."""
    depths, heights = z / inside.length, inside.heights(step)
    cut: dict[str, int] = {} if place is None else {place[0]: place[1]}
    at = () if place is None else (place[0], place[1] / step.sizes[place[0]])
    names, displacements = (_IN_PLANE, _IN_PLANE[:2]) if place is None else (_NAMES, DISPLACEMENTS)
    values = dict(zip(names, inside.below(step).section(depths, names, *at), strict=True))
    if inside.record.state == "plane_stress" and place is None:
        values["stress2"] = np.zeros_like(values["stress2"])
    formed: dict[str, Reals] = {}
    if heights is not None:
        moved = topography.formed_at(heights, depths, inside.elastic, inside.order, displacements, *at)
        formed = {name.replace("u", "formed_"): each for name, each in zip(displacements, moved, strict=True)}
    return _dataset(step, inside, z, values, formed, cut)


def _add_peaks(dataset: xr.Dataset, largest: Largest, units: Units, failed: bool) -> None:
    """Add the largest von Mises stress of each whole plane and where it is."""
    for variable, kind, values, long_name in (
        ("peak_von_mises", "stress", largest.von_mises, "largest von Mises stress of the whole plane"),
        ("peak_x", "length", largest.x, "position along x of the largest von Mises stress of the plane"),
        ("peak_y", "length", largest.y, "position along y of the largest von Mises stress of the plane"),
    ):
        scaled = np.full_like(values, np.nan) if failed else values * units.worth[kind]
        dataset[variable] = ("z", scaled, cf_attributes(long_name, units.names[kind]))


_TRACTIONS = tuple(component.key("traction") for component in COMPONENTS[2])
_ON_EACH = ("pressure", *_TRACTIONS)
_FIELDS = (
    *(whose + name for whose in ("", _COUNTER) for name in _ON_EACH),
    *(_PRESCRIBED + each for each in _TRACTIONS),
    "body_height",
    "counter_body_height",
)


def described(contact: xr.Dataset, body: str) -> tuple[Scene, int]:
    """Scene of a dataset and the order its topography was followed to; raises InputError."""
    found = contact.variables.keys()
    solved = ({"x", "pressure"} <= found or {"x", "normal_traction"} <= found) and "von_mises" not in found
    if "scene" not in contact.attrs or not solved:  # fields inside a body have the pressure on it as well
        raise InputError.of("contact", "no results of a contact", "what `gfmd solve` leaves")
    try:
        file = SceneFile.model_validate_json(contact.attrs["scene"])
    except ValueError:
        raise InputError.of("contact", "a contact whose scene is unreadable", "what `gfmd solve` leaves") from None
    scene, order = file.scene, file.slope_order
    if scene.creeps:
        raise InputError.of("contact", "one of a viscoelastic body", "elastic bodies, as this is not built yet")
    if scene.body.plasticity is not None:
        allowed = "elastic bodies: a contact of a body that flows has von_mises_stress and stress_x of its own"
        raise InputError.of("contact", "one of a body that flows inside", allowed)
    if not isinstance(body, str) or body not in scene.deformable:
        raise InputError.of("body", brief(body), " or ".join(map(repr, scene.deformable)))
    nodes = nodes_of(scene)
    if not _is_whole(contact, nodes) or not found >= _needed(scene, order):
        raise InputError(_ALTERED)
    for dim in nodes:
        _check_period(contact[dim], dim, scene.length or 1.0)
    return scene, order


def nodes_of(scene: Scene) -> tuple[str, ...]:
    """Dims of the nodes of a scene."""
    return AXES[-scene.dimension :]


def tractions_on(body: str, step: xr.Dataset, nodes: tuple[str, ...]) -> Reals:
    """Tractions `[component, (y,) x]` on a body, along the surface and last out of the body, in the unit of the file.

    They are those of the punch and those that are prescribed. Where surfaces are inclined, the file has those on each
    body.
    """
    names = [component.key("traction") for component in COMPONENTS[len(nodes)]]
    whose = _COUNTER if body == "counter_body" and _COUNTER + "pressure" in step else ""
    found = _found(step, [whose + name for name in names], nodes)
    if "pressure" in step:
        found[-1] = -step[whose + "pressure"].values
    if body == "counter_body":
        if not whose:  # the tangential tractions of the file are those on `body`
            found[:-1] *= -1.0
        return found
    return found + _found(step, [_PRESCRIBED + name for name in names], nodes)


def _found(step: xr.Dataset, names: list[str], nodes: tuple[str, ...]) -> Reals:
    """Variables of these names `[name, (y,) x]`, zero where there is none."""
    found = np.zeros((len(names), *(step.sizes[dim] for dim in nodes)))
    for i, name in enumerate(names):
        if name in step:
            found[i] = step[name].values
    return found


def _needed(scene: Scene, order: int) -> set[str]:
    """Names of the tractions without which prescribed ones, or those on inclined surfaces, would be incomplete."""
    names = [component.key("traction") for component in COMPONENTS[scene.dimension]]
    needed = set()
    if scene.boundary is not None:
        needed |= {(_PRESCRIBED if scene.has_punch else "") + name for name in names}
    if order > 0 and scene.touches_inclined:
        needed |= {whose + name for whose in ("", _COUNTER) for name in ("pressure", *names[:-1])}
        if scene.counter_body is None:
            needed -= {name for name in needed if name.startswith(_COUNTER)}
    return needed


def _check_period(x: xr.DataArray, dim: str, length: float) -> None:
    """Raise InputError unless the nodes along x, or y, are all those of the period, or of the window."""
    present = x.size
    solved = x.attrs.get(POINTS, x.attrs.get(POINTS_OF_WINDOW, present))
    if str(solved) != str(present):
        raise InputError.of("contact", f"{present} of the {solved} nodes of its period", _WHOLE)
    spacing, at = length / present, x.values.astype(np.float64)
    rounding = 4.0 * float(np.finfo(x.dtype).eps) * abs(at).max() if x.dtype.kind == "f" else 0.0
    if not (abs(np.diff(at) - spacing) <= _ROUNDING * spacing + rounding).all():
        given = f"nodes {dim} from {at[0]:.6g} to {at[-1]:.6g} that are not all {spacing:.6g} apart, as in a period"
        raise InputError.of("contact", given, _WHOLE)


def _is_whole(contact: xr.Dataset, nodes: tuple[str, ...]) -> bool:
    """Whether what the fields are made from is there, in numbers with units over the nodes, and a step if any."""
    fields = [contact[name] for name in _FIELDS if name in contact]
    if "status" not in contact or any(dim not in contact.variables for dim in nodes):
        return False
    if any(contact[dim].dims != (dim,) or contact.sizes[dim] < 4 for dim in nodes):
        return False
    laid_out = {field.dims for field in fields} <= {nodes, ("step", *nodes)}
    laid_out &= contact["status"].dims in ((), ("step",))
    places = [contact[dim] for dim in nodes]
    numbers = all(each.dtype.kind in "fiu" for each in (*places, contact["status"], *fields))
    named = all("units" in each.attrs for each in (*places, *fields))
    return laid_out and numbers and named and contact.sizes.get("step", 1) > 0
