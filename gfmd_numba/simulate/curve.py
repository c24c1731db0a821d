"""The curve of a scene over loads, times or speeds: one warm-started path for each realisation, and the mean of all.

A viscoelastic body creeps under the load of its scene, which is looked at after one time after another. Or the punch
slides over it, at one speed after another.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from types import GenericAlias
from typing import Any, Literal, get_args

import numpy as np
import xarray as xr
from pydantic import BaseModel, Field, create_model
from pydantic_core import PydanticCustomError

from gfmd_numba.analysis.secant_stiffness import nearness
from gfmd_numba.arrays.threads import shared_by
from gfmd_numba.contact.contact_dataset import CONVENTIONS, cf_attributes, load_attributes, step_dataset, units_of
from gfmd_numba.contact.contact_input import ContactInput, check_loads, check_room, read_contact, with_measured_surfaces
from gfmd_numba.contact.load_path import solve_path
from gfmd_numba.contact.observables import OBSERVABLES, PRESCRIBED
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.reduced_loads import steps_of
from gfmd_numba.contact.state import Contact, Tell
from gfmd_numba.contact.validity import FEW_NODES, NARROW_CONTACTS, input_warnings, path_warnings
from gfmd_numba.scene import Document, InputError, Loading, Random, Scene, SceneFile, validate
from gfmd_numba.scene.document import located
from gfmd_numba.scene.loading import Step, check_loading, control_of
from gfmd_numba.scene.plausible_numbers import implausible
from gfmd_numba.scene.quantities import RECORD, REDUCED_PRESSURE, check_scales
from gfmd_numba.scene.units import has_unit
from gfmd_numba.solvers import status
from gfmd_numba.text.input_error import brief
from gfmd_numba.text.numbers import with_prefix

SHOWN = (
    "reduced_pressure",
    "mean_pressure",
    "contact_area_fraction",
    "contact_area",
    "contact_length",
    "contact_radius",
    "approach",
    "mean_gap",
    "contact_stiffness",
    "peak_pressure",
    "n_segments",
    "plastic_area_fraction",
    "largest_plastic_strain",
    "elastic_energy",
    "hysteretic_friction",
    "hysteretic_friction_error",
    "time_error",
)
_TITLES = {"time": "creep curve", "speed": "friction curve"}  # of curves that are not over loads
_PRESSURES = {"reduced_pressure", "mean_pressure"}  # without an error where the scene prescribes them
_METHOD = (
    "difference of two solutions, at each load and 0.1 % before it, at the first of falling loads below it "
    "(displacements: 0.1 % of their range; at most half-way to the next load); no exact tangent"
)
_SHORT = 1e-3  # of a load, or of the range of displacements: the step over which the stiffness is measured

_TIME, _SPEED = "time", "speed"  # what is prescribed of a curve over times, or over speeds
Over = Literal["loads", "times", "speeds"]
_OF_VISCOELASTIC = "nothing without a relaxation of the body: give loads, or one that `gfmd relaxation` finds from DMA"
_OF_ELASTIC = "times, or speeds, for a viscoelastic body, under the load of its scene, or a path that takes time"


@cache
def _record(over: Over, prescribed: str) -> type[BaseModel]:
    """Record of the values that a curve is over, and of its number of realisations."""
    many = Field(min_length=1, max_length=10_000, strict=False)
    kind, _ = get_args(Loading.model_fields["duration" if prescribed == _TIME else prescribed].annotation)  # or None
    fields: dict[str, Any] = {over: (GenericAlias(tuple, (kind, ...)), many)}
    return create_model("_Curve", __config__=RECORD, realisations=(int, Field(1, ge=1, le=1_000_000)), **fields)


@dataclass(frozen=True)
class LoadCurve:
    """The loads of a scene, as its loading prescribes them, and what each realisation is read from.

    A curve over `time` has times in s as its loads, one over `speed` speeds in m/s, or in L_x/s without a length.
    """

    given: ContactInput  # of the first realisation, at the loading of the file
    document: Document
    prescribed: str
    loads: tuple[float, ...]
    realisations: int

    @property
    def falls(self) -> bool:
        """Whether the punch is unloaded from the first load on."""
        return len(self.loads) > 1 and self.loads[1] < self.loads[0]


def read_curve(file: SceneFile, document: Document, over: Over, values: object, realisations: object) -> LoadCurve:
    """Check a scene and the loads, the times in s since its load began to act, or the speeds of its punch.

    Raises InputError, by the names of these arguments, for what makes no sense.
    """
    file = _without_path(file, document)
    asked = Document(None, "", {over: _listed(values), "realisations": realisations})
    if (over == "loads") != (not file.scene.creeps):
        raise asked.refused((over,), _OF_ELASTIC if over == "loads" else _OF_VISCOELASTIC)
    prescribed = _control(file.scene, asked.value((over,))) if over == "loads" else over.removesuffix("s")
    checked = validate(asked, _record(over, prescribed)).model_dump()
    points, n_realisations = checked[over], checked["realisations"]
    if over == "loads":
        file = _loaded(file, prescribed, points[0])
    with located(asked):
        check_scales(points, file.scene.length, file.scene.has_moduli, (over,))
    _check_order(asked, points, over)
    if over == "times":
        _check_times(asked, points, file.scene.loading.duration or 0.0)
    if n_realisations > 1 and not any(isinstance(each, Random) for each in file.scene.surfaces.values()):
        raise asked.error(("realisations",), n_realisations, "1, as no surface of this scene is random")
    given = read_contact(_with_path(file, _SPEED, points) if over == "speeds" else file, document)
    curve = LoadCurve(given, document, prescribed, points, n_realisations)
    if over == "loads":
        if prescribed == "displacement":
            check_room(file, given.surfaces, asked, {("loads", i): load for i, load in enumerate(points)})
        path = _with_path(given.file, prescribed, _approached(curve))
        scenes = (scene for scene, _ in steps_of(path.scene, path.path))
        check_loads(((("loads", i // 2), scene) for i, scene in enumerate(scenes)), given.surfaces, asked)
    return curve


def _without_path(file: SceneFile, document: Document) -> SceneFile:
    """A scene file with its measured surfaces; raises InputError for one with a path, or without a punch."""
    if not file.scene.has_punch:
        raise document.fault(("scene",), "a loaded body without a punch", "a contact, with a loading")
    if file.path:
        allowed = "no path in the scene of a load curve, which follows the loads"
        raise document.fault(("path",), f"a path of {len(file.path)} steps", allowed)
    return with_measured_surfaces(file, document)[0]


def _listed(values: object) -> object:
    if isinstance(values, Iterable) and not isinstance(values, str | bytes | Mapping):
        return values.tolist() if isinstance(values, np.ndarray) else list(values)
    return values


def _control(scene: Scene, loads: object) -> str:
    """What the loads are: what the first one's unit tells, and without one what the loading of the scene prescribes."""
    if isinstance(loads, list) and len({isinstance(load, str) and has_unit(load) for load in loads}) > 1:
        raise InputError.of("loads", brief(loads), "loads that all have a unit, or none")
    first = loads[0] if isinstance(loads, list) and loads else None
    told, hint = control_of(first) if isinstance(first, str) else ("", "")
    if hint:
        raise InputError.of("loads[0]", brief(first), f"numbers, or text with the unit of a load; {hint}")
    return told or scene.loading.control


def _loaded(file: SceneFile, control: str, load: float) -> SceneFile:
    """The same with a loading of another kind; raises InputError for one that the scene has no scales for."""
    if control == file.scene.loading.control:
        return file
    loading = Loading.model_validate({control: load})
    try:
        check_loading(loading, file.scene.length, file.scene.has_moduli, bool(file.scene.surfaces))
    except PydanticCustomError as error:
        context = error.context or {}
        raise InputError.of("loads", f"{control}s with a unit", context["allowed"]) from None
    return file.model_copy(update={"scene": file.scene.model_copy(update={"loading": loading})})


def _check_order(asked: Document, loads: tuple[float, ...], name: str) -> None:
    rises = len(loads) > 1 and loads[1] > loads[0]
    for i, (before, load) in enumerate(pairwise(loads)):
        if load == before or (load > before) != rises:
            raise asked.error((name, i + 1), load, f"{name} that all rise, or all fall, unlike {before:g} before it")


def _check_times(asked: Document, times: tuple[float, ...], begun: float) -> None:
    if len(times) > 1 and times[1] < times[0]:
        raise asked.error(("times", 1), times[1], "times that rise")
    if times[0] <= begun:
        raise asked.error(("times", 0), times[0], f"times after the duration of the loading, {begun:g} s")


def _with_path(file: SceneFile, prescribed: str, loads: tuple[float, ...]) -> SceneFile:
    first, *others = loads
    loading = file.scene.loading.model_copy(update={prescribed: first})
    scene = file.scene.model_copy(update={"loading": loading})
    path = tuple(Step().model_copy(update={prescribed: load}) for load in others)
    return file.model_copy(update={"scene": scene, "path": path})


def solve_curve(curve: LoadCurve, tell: Tell = lambda more: None) -> Iterator[xr.Dataset]:
    """Solve one load after another, realisation by realisation: the recorded scalars of each, in SI units.

    Each load is approached over a short step, but the first of falling ones left over one. `contact_stiffness` is the
    rise of the mean pressure over the fall of the mean gap in this step. The attribute `validity` says, a sentence a
    line, what speaks against the result. `tell` is called with the loads, or parts of one, done since the last call.
    """
    file = curve.given.file
    at_first = file if curve.prescribed in _TITLES else _with_path(file, curve.prescribed, curve.loads)
    numbers = implausible(at_first.scene)
    with shared_by(file.numerics.threads):
        for i in range(curve.realisations):
            given = _realisation(curve, i)
            whole, _ = given.reduced
            of_all_loads = len(input_warnings(given))
            steps = (step_dataset(given, *each) for each in _solved(curve, given, tell))
            if curve.prescribed == _TIME:
                next(steps)  # the load itself, before any time has passed
            for n, step in enumerate(steps):
                short, step = (None, step) if curve.prescribed in _TITLES else (step, next(steps))
                if n == 0 and short is not None and curve.falls:
                    short, step = step, short
                scalars = step[[name for name in OBSERVABLES if name in step]]
                if short is not None:
                    for name in ("n_iterations", "wall_time"):
                        scalars[name] = (scalars[name] + short[name]).assign_attrs(scalars[name].attrs)
                    scalars["contact_stiffness"] = _stiffness(short, step)
                warnings = path_warnings(given, whole, step).splitlines()
                scalars["warned"] = len(warnings) > of_all_loads
                validity = "\n".join((*numbers, *warnings))
                yield scalars.assign_attrs(solver=whole.numerics.solver, validity=validity)


def _solved(curve: LoadCurve, given: ContactInput, tell: Tell) -> Iterator[tuple[Problem, Contact]]:
    """The problem and the contact at each step of the path of a realisation."""
    whole, realisation = given.task
    share = len(curve.loads) / whole.n_loads  # loads of the curve in a step of the path
    contacts = solve_path(whole, realisation, lambda steps: tell(share * steps))
    return zip(whole.at_each_load, contacts, strict=True)


def _realisation(curve: LoadCurve, i: int) -> ContactInput:
    """What the file gives for one of the realisations, with the path that is followed."""
    given, file = curve.given, curve.given.file
    if i > 0:
        given = read_contact(file.model_copy(update={"realisation": file.realisation + i}), curve.document)
    if curve.prescribed == _SPEED:
        return given
    if curve.prescribed == _TIME:
        times = file.scene.loading.duration or 0.0, *curve.loads
        dwells = tuple(Step(duration=end - start) for start, end in pairwise(times))
        return replace(given, file=given.file.model_copy(update={"path": dwells}))
    return replace(given, file=_with_path(given.file, curve.prescribed, _approached(curve)))


def _approached(curve: LoadCurve) -> tuple[float, ...]:
    """Each load behind one a little before it on the path; the first of falling ones, the largest, before one below."""
    loads = np.array(curve.loads)
    size = loads if curve.prescribed != "displacement" else np.full(len(loads), np.ptp(loads) or abs(loads[0]))
    short = _SHORT * size
    for beside in (short[1:], short[:-1]):
        np.minimum(beside, 0.5 * abs(np.diff(loads)), out=beside)
    path = np.column_stack([loads + short if curve.falls else loads - short, loads])
    if curve.falls:
        path[0] = loads[0], loads[0] - short[0]
    return tuple(path.ravel().tolist())


def _stiffness(before: xr.Dataset, step: xr.Dataset) -> float:
    """Rise of the mean pressure over how much nearer the surfaces come, infinite where the gap is closed already."""
    with np.errstate(divide="ignore", invalid="ignore"):
        rise = step["mean_pressure"].values - before["mean_pressure"].values
        return float(rise / (nearness(step) - nearness(before)).values)


def by_realisation(curve: LoadCurve, solved: list[xr.Dataset]) -> xr.Dataset:
    """Scalars over (realisation, prescribed_load); an interrupted path counts only where no other is whole."""
    whole, loads = divmod(len(solved), len(curve.loads))
    rows, columns = (whole, len(curve.loads)) if whole else (1, loads)
    counted = solved[: rows * columns]
    values: dict[str, Any] = {}
    for name, variable in counted[0].data_vars.items():
        numbers = np.array([float(step[name]) for step in counted]).reshape(rows, columns)
        values[str(name)] = (("realisation", "prescribed_load"), numbers, variable.attrs)
    # under one load the softest body strains most
    most = "contact_area_fraction" if curve.prescribed in _TITLES else "peak_pressure"
    hardest = sorted(range(len(counted)), key=lambda i: -float(counted[i][most]))
    attributes = counted[hardest[0]].attrs
    validities = [(curve.loads[i % columns], counted[i].attrs.get("validity", "")) for i in hardest]
    if said := _of_all(validities, _load_attributes(curve)["units"].removeprefix("1")):
        attributes = attributes | {"validity": said}
    return xr.Dataset(values, coords={"prescribed_load": list(curve.loads[:columns])}, attrs=attributes)


def _of_all(validities: Sequence[tuple[float, str]], unit: str) -> str:
    """Return the sentences of several contacts and their loads, the hardest first, a line each.

    Of those that differ in their numbers alone it is the first, and of contacts of too few nodes the last, with its
    load. What not all say stands behind the loads of those that do.
    """
    every = {load for load, _ in validities}
    said: dict[str, list[tuple[float, str]]] = {}
    for load, line in ((load, line) for load, validity in validities for line in validity.splitlines()):
        wording = re.sub(r"[-+.\de]*\d\S*( \S+)?", "", line)  # without its numbers and their units
        said.setdefault(wording, []).append((load, line))
    return "\n".join(_at_loads(lines, every, unit) for lines in said.values())


def _at_loads(lines: list[tuple[float, str]], every: set[float], unit: str) -> str:
    """Return one of the lines that differ in numbers alone, with the loads that say so, unless all say the same."""
    loads, different = {load for load, _ in lines}, {line for _, line in lines}
    load, line = lines[-1 if lines[0][1].startswith((FEW_NODES, NARROW_CONTACTS)) else 0]
    if (len(different) == 1 and loads == every) or re.match(r"at \d", line):  # it says itself where it holds
        return line
    ends = dict.fromkeys(with_prefix(end, unit, 3).strip() for end in (min(loads), max(loads)))
    numbers = f" (numbers at {with_prefix(load, unit, 3).strip()})" if len(different) > 1 and len(ends) > 1 else ""
    return f"at {' to '.join(ends)}{numbers}: {line}"


def curve_of(file: SceneFile, document: Document, given: Mapping[Over, object], realisations: object) -> xr.Dataset:
    """Observables over `prescribed_load`, `time` or `speed` in SI units; raises InputError as `read_curve` does.

    One of loads, times and speeds is `given`. The `status` says which runs failed.
    """
    curve = read_curve(file, document, *one_of(given), realisations)
    return curve_dataset(curve, list(solve_curve(curve)))


def one_of(given: Mapping[Over, object]) -> tuple[Over, object]:
    """What a curve is over, loads, times or speeds, and its values; raises InputError unless one of them is given."""
    asked_for = [(name, values) for name, values in given.items() if values is not None]
    if len(asked_for) != 1:
        named = " and ".join(name for name, _ in asked_for) or "none"
        raise InputError.of("loads, times, speeds", named, "one of them")
    return asked_for[0]


def curve_dataset(curve: LoadCurve, solved: list[xr.Dataset]) -> xr.Dataset:
    """One row a load of what was solved, all or the beginning of it: columns `[prescribed_load]` in SI units.

    Several realisations give means and standard errors over those that are ok at a load, which `n_realisations` counts.
    """
    found = by_realisation(curve, solved)
    _add_derived(curve, found)
    ok = found["status"] == 0
    dataset = xr.Dataset(coords={"prescribed_load": found["prescribed_load"]})
    count = ok.sum("realisation")
    for name in (name for name in SHOWN if name in found):
        values = found[name].where(ok)
        dataset[name] = values.mean("realisation").assign_attrs(found[name].attrs)
        if curve.realisations > 1 and not (curve.prescribed != "displacement" and name in _PRESSURES):
            attributes = cf_attributes(f"standard error of {name} over realisations", found[name].units)
            dataset[f"{name}_standard_error"] = _standard_error(values).assign_attrs(attributes)
    dataset["n_realisations"] = count.assign_attrs(cf_attributes("realisations that are ok at this load"))
    warned = found["warned"].where(ok).sum("realisation").astype(int)
    dataset["n_warned"] = warned.assign_attrs(cf_attributes("realisations with a warning about this load"))
    worst = found["status"].max("realisation").astype(np.int8)
    dataset["status"] = worst.assign_attrs(
        cf_attributes("how the runs at this load ended, the worst of them") | status.flag_attributes(status.SENTENCES)
    )
    dataset["residual"] = found["residual"].max("realisation").assign_attrs(found["residual"].attrs)
    for name in ("n_iterations", "wall_time"):
        dataset[name] = found[name].sum("realisation").assign_attrs(found[name].attrs)
    dataset["prescribed_load"].attrs = _load_attributes(curve)
    dataset.attrs = {
        **found.attrs,
        "Conventions": CONVENTIONS,
        "title": _TITLES.get(curve.prescribed, "load curve"),
        **curve.given.record,
        "processing": curve.given.processing,
        "prescribed": curve.prescribed,
    }
    if len(solved) < len(curve.loads) * curve.realisations:
        dataset.attrs["interrupted"] = _finished(curve, found)
    return dataset if curve.prescribed not in _TITLES else dataset.rename(prescribed_load=curve.prescribed)


def _load_attributes(curve: LoadCurve) -> dict[str, str]:
    return load_attributes(curve.given.file.scene)[PRESCRIBED.get(curve.prescribed, curve.prescribed)]


def _standard_error(values: xr.DataArray) -> xr.DataArray:
    """Standard error of the mean over realisations; nan of one value, and of infinite ones."""
    finite = values.where(np.isfinite(values.mean("realisation")))
    error: xr.DataArray = finite.std("realisation", ddof=1) / finite.count("realisation") ** 0.5
    return error


def _add_derived(curve: LoadCurve, found: xr.Dataset) -> None:
    """Add what the path and the size of the period make of the recorded scalars."""
    scene, units = curve.given.file.scene, units_of(curve.given)
    reduced = found["mean_pressure"] / units.worth["pressure"]
    found["reduced_pressure"] = reduced.assign_attrs(cf_attributes(REDUCED_PRESSURE))
    acts_on_period = curve.prescribed in ("force", "line_load")
    fields = 1 if acts_on_period else scene.fields_in_period
    whole = "the measured field" if fields > 1 else "one period" if scene.periodic is True else "the window"
    if scene.length is not None:
        name, unit = {1: ("contact_length", "m"), 2: ("contact_area", "m2")}[scene.dimension]
        attributes = cf_attributes(f"real {name.replace('_', ' ')} over {whole}", unit)
        area = scene.length**scene.dimension / fields
        found[name] = (found["contact_area_fraction"] * area).assign_attrs(attributes)
    contacts = found["n_segments"].attrs | {"long_name": f"{found['n_segments'].attrs['long_name']}, in {whole}"}
    found["n_segments"] = (found["n_segments"] / fields).assign_attrs(contacts)
    if "contact_stiffness" in found:
        per = [units.names["pressure"]] if units.names["pressure"] != "1" else []
        per += [f"{units.names['height']}-1"] if units.names["height"] != "1" else []
        long_name = "contact stiffness beyond uniform compression, -d(mean_pressure)/d(mean_gap)"
        if any(scene.ends):
            long_name = "contact stiffness, d(mean_pressure)/d(approach)"
        elif scene.interface.hardness is not None:
            long_name = (
                "contact stiffness beyond uniform compression, d(mean_pressure)/d(mean_plastic_depth - mean_gap)"
            )
        attributes = cf_attributes(long_name, " ".join(per) or "1")
        found["contact_stiffness"].attrs = attributes | {"comment": _METHOD}


def _finished(curve: LoadCurve, found: xr.Dataset) -> str:
    loads, realisations = found.sizes["prescribed_load"], found.sizes["realisation"]
    if curve.realisations == 1:
        return f"after {loads} of {len(curve.loads)} loads"
    if loads < len(curve.loads):
        return f"after {loads} of {len(curve.loads)} loads of the first of {curve.realisations} realisations"
    return f"after {realisations} of {curve.realisations} realisations"
