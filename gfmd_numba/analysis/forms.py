"""The forms of datasets: what each kind holds, over which dims, in which values; checked before anything is read."""

import json
from collections.abc import Collection, Hashable, Mapping
from dataclasses import dataclass, field
from fnmatch import fnmatchcase

import numpy as np
import xarray as xr

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.text.input_error import InputError, brief

LARGEST = 1e100  # beyond which squares overflow; no quantity of a contact comes near
_TEXTS = ("units", "long_name", "label", "symbol", "axis")  # attributes of variables


class UnusableDataError(InputError):
    """What a dataset lacks for the analysis asked of it."""


@dataclass(frozen=True, eq=False)
class DatasetForm:
    """What the datasets of a kind hold, by name: their dims, and what values they are; `*` stands for any text.

    A dim `[dim]` may be missing, `dim?` is there if the dataset has it, and `...` are any others. What is `needed` has
    to be there, also `attributes` of the dataset, which are texts; `others` have their form where they are there. Along
    the dims in `least` there are so many values at least.
    """

    name: str
    maker: str
    needed: Mapping[str, str]
    others: Mapping[str, str] = field(default_factory=dict)
    attributes: tuple[str, ...] = ()
    least: Mapping[str, int] = field(default_factory=dict)
    axes_over: str = ""  # the dim of the coordinates whose attribute `axis` calls them physics or discretisation

    def checked(self, given: object, argument: str) -> xr.Dataset:
        """Return a dataset of this form, its dims in order; InputError for anything else."""
        if not isinstance(given, xr.Dataset):
            raise InputError.of(argument, brief(given), f"an xarray.Dataset, {self.maker}")
        if not self.needed.keys() <= given.variables.keys():
            raise UnusableDataError(f"you gave no {self.name}; gfmd allows {self.maker}")
        forms = self._forms(given)
        if fault := self._fault(given, forms):
            raise UnusableDataError(f"you gave a dataset in which {fault}; gfmd allows {self.maker}")
        ordered = {}
        for name, form in forms.items():
            dims = tuple(_dims(form, given.variables[name].dims, given.dims))
            if name in given.data_vars and given.variables[name].dims != dims:
                ordered[name] = given.variables[name].transpose(*dims)
        return given.assign(ordered)

    def _forms(self, dataset: xr.Dataset) -> dict[str, str]:
        """Return the form of each variable of a dataset that has one."""
        forms: dict[str, str] = {}
        told = {**self.others, **self.needed}
        for name, variable in dataset.variables.items():
            pattern = next((each for each in told if fnmatchcase(str(name), each)), None)
            if pattern is not None:
                forms[str(name)] = told[pattern]
            elif self.axes_over and "axis" in variable.attrs:
                forms[str(name)] = f"{self.axes_over} numbers"
        return forms

    def _fault(self, dataset: xr.Dataset, forms: Mapping[str, str]) -> str:
        """Return what of a dataset has another form, nothing if all is well."""
        for dim, least in self.least.items():
            if dataset.sizes.get(dim, least) < least:
                return f"{dim} has {dataset.sizes[dim]} values"
        for name, form in forms.items():
            if fault := _fault_of(dataset.variables[name], form, dataset.dims):
                return f"{name} {fault}"
        for name in self.attributes:
            if not isinstance(text := dataset.attrs.get(name), str):
                return f"the attribute {name} is {brief(text)}"
        every = dataset.variables.items()
        return next((f"{name} {fault}" for name, variable in every if (fault := _attributes(variable))), "")


def _dims(form: str, present: Collection[Hashable], of_dataset: Collection[Hashable]) -> list[str]:
    """Return the dims that a variable has by its form, in order, of which some are present."""
    dims: list[str] = []
    for dim in form.split()[:-1]:
        name = dim.strip("[]?")
        if dim == "...":
            named = {each.strip("[]?") for each in form.split()}
            dims += [str(other) for other in present if str(other) not in named]
        elif not ("[" in dim and name not in present) and not ("?" in dim and name not in of_dataset):
            dims.append(name)
    return dims


def _fault_of(variable: xr.Variable, form: str, of_dataset: Collection[Hashable]) -> str:
    dims = _dims(form, variable.dims, of_dataset)
    if sorted(map(str, variable.dims)) != sorted(dims):
        return f"is over ({', '.join(map(str, variable.dims))}), not over ({', '.join(dims)})"
    values, kind = variable.values, form.split()[-1]
    if kind == "texts":
        return "" if all(isinstance(each, str) for each in values.ravel()) else "is no text"
    if kind == "flags":
        return "" if values.dtype.kind == "b" else "is neither true nor false"
    if values.dtype.kind not in ("biu" if kind == "whole" else "fbiu"):
        return "is no whole number" if kind == "whole" else "is no real number"
    numbers = values[np.isfinite(values)]
    if kind == "numbers":  # of a run that failed, which may be any
        return ""
    if numbers.size and max(-float(numbers.min()), float(numbers.max())) > LARGEST:
        return f"has a number beyond {LARGEST:g}"
    if kind in ("finite", "rising", "positive") and numbers.size < values.size:
        return "is not finite"
    if kind == "positive" and not (numbers > 0.0).all():
        return "is not above 0"
    rises = kind != "rising" or not values.ndim or (np.diff(values) > 0.0).all()
    return "" if rises else "does not rise"


def _attributes(variable: xr.Variable) -> str:
    """Return what is wrong with the attributes that are read of any variable."""
    given = variable.attrs
    for name in _TEXTS:
        if not isinstance(given.get(name, ""), str):
            return f"has {name} {brief(given[name])}"
    if not str(given.get("rank", 0)).isdecimal():
        return f"has rank {brief(given['rank'])}"
    if "names" in given:
        try:
            names = json.loads(given["names"])
            known = isinstance(names, list) and all(isinstance(name, str) for name in names)
            known = known and all(0 <= int(value) < len(names) for value in variable.values.ravel())
        except (TypeError, ValueError):
            known = False
        return "" if known else "has names that are not those of its values"
    return ""


_CONTACTS = "case realisation [step] numbers"
_FIELD = "step? y? x finite"
_PRESCRIBED = ("reduced_pressure", "punch_displacement", "sliding", "sliding_y")


def _all(kind: str, *names: str) -> dict[str, str]:
    return dict.fromkeys(names, kind)


CAMPAIGN = DatasetForm(
    "results of a campaign",
    "what a finished `gfmd run` leaves",
    {"case_id": "case texts", "is_reference": "case flags"},
    {
        "status": "case realisation [step] whole",
        "limit": "case texts",
        "thinnest_layer": "case numbers",
        "has_measured_slope_law": "case flags",
        "case_seconds": "case numbers",
        "rms_height": "case [realisation] numbers",
        **_all("case whole", "realisations", "nx", "dimension"),
        **_all("case positive", "eps_c", "eps_f", "eps_t"),
        **_all(_CONTACTS, "kappa", "kappa_counted", "kappa_r", "kappa_residual_error", "n_segments", "mean_pressure"),
        **_all(_CONTACTS, "contact_area_fraction", "contact_area_fraction_counted", "mean_gap", "stick_fraction"),
        **_all(_CONTACTS, "energy_lost", "mean_tangential_traction", "mean_tangential_traction_y"),
        **_all("case realisation numbers", "hysteresis", "pull_off_pressure"),
        **_all("case [step] finite", "step_load", "step_sliding", "step_sliding_y"),
    },
    least={"case": 1, "realisation": 1, "step": 1},
    axes_over="case",
)
LOADS = DatasetForm(
    "results of several loads",
    "a campaign's, or those of a path",
    {**_all("... numbers", "mean_pressure", "mean_gap"), "status": "... whole"},
    {**_all("... numbers", "reduced_pressure", "rms_height"), "height": "... x finite"},
)
CONTACT = DatasetForm("results of a contact", "what `gfmd solve` leaves of one", {})
SOLVED = DatasetForm("results of a contact", "what `gfmd solve` leaves of one", {"x": "x rising"}, least={"x": 4})
DRAWN_CONTACT = DatasetForm(
    "results of a contact",
    "what `gfmd solve` leaves of one",
    {"x": "x rising", **_all(_FIELD, "displacement", "gap", "pressure")},
    {
        "y": "y rising",
        "status": "[step] whole",
        **_all("[step] y? x finite", "height", "body_height", "counter_body_height", "plastic_depth", "slip"),
        **_all(_FIELD, "tangential_traction", "tangential_traction_y", "tangential_displacement"),
        **_all(_FIELD, "tangential_displacement_y", "prescribed_normal_traction", "prescribed_tangential_traction"),
        **_all("[step] finite", *_PRESCRIBED),
    },
    least={"x": 4, "y": 4, "step": 1},
)
LOADED_BODY = DatasetForm(
    "loaded body",
    "what `gfmd solve` leaves of one",
    {"x": "x rising", **_all(_FIELD, "normal_displacement", "tangential_displacement")}
    | _all(_FIELD, "normal_traction", "tangential_traction"),
    {"y": "y rising", **_all(_FIELD, "tangential_displacement_y", "tangential_traction_y", "body_height")},
    least={"x": 4, "y": 4},
)
FIELDS = DatasetForm(
    "fields inside a body",
    "what `gfmd fields` leaves",
    {"x": "[x] rising", "z": "z finite", "von_mises": "step? z [y] [x] numbers", "pressure": "step? [y] [x] numbers"},
    {"y": "[y] rising", **_all("[step] finite", *_PRESCRIBED)},
    least={"x": 4, "y": 4, "z": 1, "step": 1},
)
LEAKAGE = DatasetForm(
    "leakage of a contact",
    "what `gfmd leakage` leaves",
    {"x": "x rising", "direction": "direction texts", "local_flow": "[step] direction y? x finite"},
    {"y": "y rising", **_all("[step] finite", *_PRESCRIBED)},
    least={"x": 4, "y": 4, "step": 1, "direction": 2},
)
CONDUCTANCE = DatasetForm(
    "conductance of a contact",
    "what `gfmd conductance` leaves",
    {"x": "x rising", "current_density": "[step] y? x finite"},
    {"y": "y rising", **_all("[step] finite", *_PRESCRIBED)},
    least={"x": 4, "y": 4, "step": 1},
)


def _curve(name: str, option: str, over: str, own: str, attributes: tuple[str, ...] = ()) -> DatasetForm:
    """Return the form of a curve over a dim, with a variable of its own."""
    variables = (own, "contact_area_fraction", "mean_gap", "peak_pressure")
    needed = {over: f"{over} finite", "n_realisations": f"{over} whole", **_all(f"{over} numbers", *variables)}
    others = _all(f"{over} numbers", "mean_pressure", "*_standard_error")
    return DatasetForm(name, f"what `gfmd curve{option}` leaves", needed, others, attributes)


CURVES = {  # by what they are over
    "prescribed_load": _curve("load curve", "", "prescribed_load", "contact_stiffness", ("prescribed",)),
    "time": _curve("creep curve", " --times", "time", "n_segments"),
    "speed": _curve("friction curve", " --speeds", "speed", "hysteretic_friction"),
}
FIT = DatasetForm(
    "fit",
    "what `gfmd fit -o` leaves",
    {"fit_status": "group texts"},
    {**_all("group numbers", "*_tfc", "*_tfc_error"), "limit": "limit texts", "reference_eps": "group limit numbers"}
    | _all("group limit step numbers", "curve_eps", "curve"),
    attributes=("variable", "omit_nyquist"),
    axes_over="group",
)
STATISTICS = DatasetForm(
    "statistics of a contact",
    "what `gfmd statistics` leaves",
    {"pressure_density": "... pressure finite", "gap_density": "... gap finite"}
    | {"pressure": "pressure rising", "gap": "gap rising"},
    {
        "pressure_density_persson": "... pressure finite",
        "segments": "... length numbers",
        "clusters": "... area numbers",
        "reduced_pressure": "... finite",
    }
    | {"length": "length positive", "area": "area positive"},
    least={"pressure": 2, "gap": 2, "length": 1, "area": 1, "step": 1},
)
SURFACE = DatasetForm(
    "surface",
    "what `gfmd surface` leaves",
    {"x": "x rising", "height": "y? x finite", "wavenumber": "wavenumber positive", "waves": "wavenumber positive"}
    | {"spectral_density": "wavenumber finite", "distance": "distance rising", "autocorrelation": "distance finite"}
    | {"level": "level rising", **_all("level finite", "height_density", "height_density_gaussian")},
    {"y": "y rising", "spectral_density_theory": "wavenumber finite", "autocorrelation_theory": "distance finite"},
    least={"x": 2, "y": 2, "level": 2, "distance": 2, "wavenumber": 1},
)
ACCURACY = DatasetForm(
    "studies of accuracy",
    "what `gfmd accuracy` leaves",
    {**_all("point texts", "study", "curve"), **_all("point numbers", "setting", "error", "seconds", "failed")},
    {"variable": "point texts"} | _all("point numbers", "hysteresis_error", "pull_off_pressure_error", "next_order"),
)
ROUNDS = DatasetForm(
    "rounds until an error is reached",
    "what `gfmd run --until` leaves",
    _all("round [target] numbers", "round_error", "round_error_factor", "round_predicted_error")
    | {"round_cpu_seconds": "round numbers"},
    {"round": "round whole", "target": "target texts"},
    attributes=("target",),
)

_INTERFACE = 1e-8  # of their depth, up to which two levels are the sides of an interface
_FIELDS = ("height", "pressure", "gap", "relaxed_pressure")
_POINTS, _POINTS_OF_WINDOW = "points_per_period", "points_per_window"


def goes_around(dataset: xr.Dataset) -> tuple[bool, ...]:
    """Return whether the two ends of the fields meet along (y,) x, or are those of a window without a period."""
    return tuple(_POINTS_OF_WINDOW not in dataset[dim].attrs for dim in ("y", "x") if dim in dataset.dims)


def check_fields(
    dataset: xr.Dataset, needed: Collection[str], maps_only: bool = False, whole: bool = False
) -> list[str]:
    """Return the dims of the nodes, `[x]` or `[y, x]`; raises UnusableDataError for what is no solved contact.

    A part of the nodes of a period is refused, too, and where it has to be `whole`, of a window.
    """
    kind = "a map's contact" if maps_only else "a contact"
    if not {"x", "status", *needed} <= dataset.variables.keys():
        raise UnusableDataError(f"you gave no results of {kind}; gfmd allows what `gfmd solve` leaves of one")
    nodes = [dim for dim in ("y", "x") if dim in dataset.dims]
    if maps_only and "y" not in nodes:
        raise UnusableDataError(
            "you gave the contact of a profile, in which no channel leads around the contacts; gfmd allows that of a "
            "map (solve a scene with `dimension: 2`, whose surface is random or a measured map)"
        )
    fields = [dataset[name] for name in _FIELDS if name in needed]
    names = ("x", "status", *needed)
    numbers = all(dataset[name].dtype.kind in "fiu" for name in names)
    over_nodes = fields[-1].size > 0 and set(nodes) <= set(fields[-1].dims)
    enough = min(dataset.sizes.get(dim, 0) for dim in nodes) >= 4
    scalars = [dataset[name] for name in ("status", *needed) if name not in _FIELDS]
    alone = not any(set(scalar.dims) - (set(fields[-1].dims) - set(nodes)) for scalar in scalars)
    if not (numbers and over_nodes and enough and alone and {field.dims for field in fields} == {fields[-1].dims}):
        raise UnusableDataError(f"you gave altered results; gfmd allows what `gfmd solve` leaves of {kind}")
    if (dataset["status"] != 0).any():
        raise UnusableDataError("you gave a run that is not ok; gfmd allows contacts in equilibrium, whose status is 0")
    if not all(np.isfinite(field).all() for field in fields):
        raise UnusableDataError(f"you gave fields that are not finite; gfmd allows what `gfmd solve` leaves of {kind}")
    for dim in nodes:  # contacts may go around the period
        told = dataset[dim].attrs if dim in dataset.coords else {_POINTS: "unknown"}
        points = told.get(_POINTS, told.get(_POINTS_OF_WINDOW if whole else _POINTS, dataset.sizes[dim]))
        if str(points) != str(dataset.sizes[dim]):
            given = f"{dataset.sizes[dim]} of the {points} nodes along {dim}"
            raise UnusableDataError(f"you gave {given}; gfmd allows all nodes of the period, or the window")
    return nodes


def by_layer(z: Reals) -> list[Indices]:
    """Indices of levels z by the layer they are in, from the top; two levels a billionth apart are at an interface."""
    order = np.argsort(-z)
    down = -z[order]
    return np.split(order, np.flatnonzero(np.diff(down) <= _INTERFACE * down[1:]) + 1)
