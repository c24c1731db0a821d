"""What is told of results, for the terminal and for reports: numbers in the unit that suits them, tables and lines."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from math import floor, inf, isnan, log10, nan, sqrt
from typing import TYPE_CHECKING, Any

from gfmd_numba.cli.arguments import LIMITS, OF_PATHS, Fixed
from gfmd_numba.cli.terminal import Line, Table, Told
from gfmd_numba.text.numbers import counted, si_prefix, typical, with_error, with_prefix
from gfmd_numba.text.recorded_scene import is_elastic_contact, is_form_alone, is_measured_profile

if TYPE_CHECKING:
    import xarray as xr

    from gfmd_numba.campaign.axes import Grid
    from gfmd_numba.scene import Scene


_WORDS = {  # of variables whose names are no words
    "reduced_pressure": "p*",
    "prescribed_pressure": "pressure",
    "sliding_y": "sliding along y",
    "contact_stiffness": "stiffness",
    "n_segments": "contacts",
    "mean_tangential_traction_y": "mean tangential traction along y",
    "tangential_force_y": "tangential force along y",
    "stick_fraction": "sticking share",
    "time_error": "error of time",
    "hysteretic_friction": "friction",
    "hysteretic_friction_error": "error of friction",
    "pull_off_pressure": "pull-off pressure",
    "pull_off_force": "pull-off force",
}
_FORCES = {  # what they are of a form alone in a window, whose size has no meaning: N, or N/m of a profile
    "pull_off_pressure": "pull_off_force",
    "mean_tangential_traction": "tangential_force",
    "mean_tangential_traction_y": "tangential_force_y",
}
_SECANT = "secant_stiffness"  # since the step before
_SYMBOLS = {  # in the meanings of words
    "a_r": "share of the surface in contact",
    "g": "rms gradient of the heights",
    "p": "mean pressure",
    "E*": "contact modulus: E / (1 - nu^2) of an elastic body below a rigid punch",
    "L_x": "period of the surface, or length of the window",
}
_MEANINGS = {  # of words that name no variable of a file, or another one there
    "±": "before the standard error: in two of three cases the truth lies within",
    "step": "number of the loading in the path, 0 for the first",
    "pressure": "mean pressure that the loading prescribes",
    "limit": "value of infinitely large and infinitely fine surfaces and grids, to which all levels extrapolate",
    "continuum": "part of the reference that vanishes on fine grids: eps_c, two node spacings over the shortest wave",
    "fractal": "part that vanishes with ever shorter waves: eps_f, the shortest wave over the longest one",
    "thermodynamic": "part that vanishes on large surfaces: eps_t, the longest wave over the period",
    "together": "interaction: by how much the parts that act at once differ from their sum",
    "reference": "mean of the surfaces solved at the discretisation around which the levels vary",
    "error": "parts of the standard error: the scatter of surfaces (sampling), and what is unknown of each limit",
    "misfit": "how far the levels lie from the fitted laws, in standard errors",
    "round": "a run to a target solves more surfaces and finer levels, round after round; the first is the pilot",
    "stiffness": "change of the mean pressure over how much nearer the surfaces come",
    "secant stiffness": "change of the mean pressure over how much nearer the surfaces come, since the step before",
    "surfaces": "number of random surfaces whose mean a row is",
    "status": "how the run ended",
}
_LENGTHS = ("punch_displacement", "sliding", "sliding_y")
_UNUSED_BY_KAPPA = ("rms_gradient_target", "rms_height")  # shown only if they vary
_IN_UNIT_OF_VARIABLE = [f"{name}{end}" for name in ("reference", "correction", "interaction") for end in ("", "_error")]
MOST_ROWS = 200
_MAY_YIELD = 100e6  # Pa: few solids are softer that are no rubber
_OF_RIDGES = (  # kappa of maps over kappa of profiles, in the limit: 0.54, 0.58 and 0.64 for H = 0.3, 0.5 and 0.8
    "a profile stands for ridges without end along y; a surface that is as rough along y touches, at light loads, on "
    "half to two thirds of this area: measure a map"
)
_MOST_EXPONENTS = 6
_MOST_GROUPS = 3  # that a note names
_NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?")
_KNOWN = 0.9  # of the standard deviation of a range, above which data say nothing of an exponent in it
_LONGEST_NAME = 40
_SHOWN_OF_PATHS = (
    *(
        "pull_off_pressure",
        "pull_off_force",
        "hysteresis",
        "mean_tangential_traction",
        "mean_tangential_traction_y",
        "stick_fraction",
    ),
    *("contact_area_fraction", "mean_plastic_depth", "mean_worn_depth"),
)
_WIDE, _DIGITS = 24, 6
_SHOWN = (  # as far as a dataset has them: a loaded body has but the last
    "force",
    "line_load",
    "mean_pressure",
    "contact_area_fraction",
    "contact_radius",
    "approach",
    "mean_gap",
    _SECANT,
    "peak_pressure",
    "n_segments",
    "elastic_energy",
    "kappa",
    "plastic_area_fraction",
    "mean_plastic_depth",
    "plastic_volume",
    "largest_plastic_strain",
    "mean_worn_depth",
    "mean_tangential_traction",
    "mean_tangential_traction_y",
    "tangential_force",
    "tangential_force_y",
    "stick_fraction",
    "energy_lost",
    "hysteretic_friction",
    "hysteretic_friction_error",
    "time_error",
)
_MEASURES = {  # of a solved contact: words, and the unit of a contact without units
    "contact_area_fraction": ("contact area fraction", ""),
    "contact_area_fraction_persson": ("Persson's estimate of it", ""),
    "mean_gap": ("mean gap over rms height", ""),
    "perimeter": ("perimeter", "L_x"),
    "gap_connects": ("channel", ""),
    "contact_connects": ("contact bridges", ""),
    "critical_gap": ("critical gap", "L_x"),
    "largest_gap_fraction": ("largest connected gap", ""),
    "largest_contact_fraction": ("largest contact cluster", ""),
    "n_gaps": ("separate gaps", ""),
    "hydraulic_gap": ("hydraulic gap", "L_x"),
    "flow_factor": ("flow factor", ""),
    "viscosity": ("viscosity", ""),
    "pressure_drop": ("pressure drop", ""),
    "seal_length": ("seal length", ""),
    "seal_width": ("seal width", ""),
    "flow": ("flow", ""),
    "conductance": ("conductance", "1/L_x"),
    "resistance": ("resistance", ""),
    "resistance_times_area": ("resistance times area", ""),
}
_PRESCRIBED = (
    *("reduced_pressure", "prescribed_pressure", "line_load", "force", "punch_displacement"),
    *("sliding", "sliding_y", "speed", "time"),
)


def words(name: str) -> str:
    """Return the name of a variable in words."""
    return _WORDS.get(name, name.replace("_", " "))


def meanings(told: list[Table | Line], *datasets: xr.Dataset | None) -> list[tuple[str, str]]:
    """Return the words that are told of datasets, each with its meaning, and the symbols in these."""
    known: dict[str, str] = {}
    for variable in (each for dataset in datasets if dataset is not None for each in dataset.variables.items()):
        name, attributes = str(variable[0]), variable[1].attrs
        for word in (words(name), attributes.get("symbol", name)):
            known.setdefault(word, str(attributes.get("long_name", "")))
    known |= _MEANINGS
    tables = [each for each in told if isinstance(each, Table)]
    said: list[str] = []
    for each in tables:
        without_units = (re.sub(r" \([^()]*\)$", "", heading) for heading in (*each.parameters, *each.values))
        said += [each.title.partition(" ")[0], *without_units]
    said += [each.label for each in told if isinstance(each, Line)]
    said += ["±"] * any("±" in cell for table in tables for cells in table.values.values() for cell in cells)
    found = {word: known[word] for word in dict.fromkeys(said) if known.get(word, word) != word}
    parts = set(re.findall(r"[\w*]+", " ".join(found.values())))
    return [*found.items(), *(symbol for symbol in _SYMBOLS.items() if symbol[0] in parts)]


def unit(dataset: xr.Dataset, name: str) -> str:
    """Return the unit of a variable in its file, in which E* and L_x stand for what the scene leaves open."""
    from gfmd_numba.contact.observables import OBSERVABLES, PATH_OBSERVABLES

    pressure, length = unit_of(dataset, "mean_pressure", "E*"), unit_of(dataset, "mean_gap", "L_x")
    row = (OBSERVABLES | PATH_OBSERVABLES).get(name)
    kind = name if row is None else row.unit
    in_si = (pressure, length) == ("Pa", "m")
    stiffness = "Pa m-1" if in_si else f"{pressure}/{length}"
    found = {
        "contact_stiffness": stiffness,
        _SECANT: stiffness,
        "energy": "J m-2" if in_si else f"{pressure} {length}",
        "speed": "m s-1" if length == "m" else f"{length}/s",
        "pressure": pressure,
        "height": length,
        "length": length,
    }
    return found[kind] if kind in found else unit_of(dataset, name, "L_x" if name in _LENGTHS else "")


def unit_of(dataset: xr.Dataset, name: str, free: str) -> str:
    """Return the unit of a variable; `free` stands for 1, and for that of a variable which is not there."""
    found = dataset[name].attrs.get("units", "1") if name in dataset.variables else "1"
    return free if found == "1" else str(found)


def column(dataset: xr.Dataset, name: str) -> tuple[str, list[str]]:
    """Return heading, with the unit, and cells of a variable: numbers, with their standard error where it is known."""
    factor, shown = _suited(dataset, name)
    errors = dataset.get(f"{name}_standard_error")
    values = dataset[name].values.ravel().tolist()
    deviations = [nan] * len(values) if errors is None else errors.values.ravel().tolist()
    cells = [with_error(factor * v, factor * e) for v, e in zip(values, deviations, strict=True)]
    return f"{words(name)} ({shown})" if shown else words(name), cells


def line(dataset: xr.Dataset, name: str) -> Line:
    """Return the line of a variable that is one number: words, number and unit."""
    factor, shown = _suited(dataset, name)
    return Line(words(name), f"{with_error(factor * float(dataset[name]), nan, 6):<14}{shown}".rstrip(), _WIDE)


def _suited(dataset: xr.Dataset, name: str) -> tuple[float, str]:
    return si_prefix(typical(dataset[name].values.ravel().tolist()), unit(dataset, name))


def dimensions(scene: Scene, varied: Grid | None = None) -> str:
    """Return the lengths, moduli and loads of a scene with units, except those that a grid varies."""
    from gfmd_numba.scene.units import quantities

    told = []
    for record, names in ((scene, ("length",)), (scene.body, ("youngs_modulus",)), (scene.loading, None)):
        for name, quantity in quantities(type(record)).items():
            value = getattr(record, name)
            in_si = scene.length is not None or not quantity.length
            replaced = getattr(varied, name, None) is not None
            if value is not None and in_si and not replaced and (names is None or name in names):
                told.append(f"{name} {with_prefix(value, quantity.si, _DIGITS)}")
    return ", ".join(told)


def of_fit(fitted: xr.Dataset) -> Told:
    """Yield the variable in the limit, what separates it from the reference, and its mean there."""
    import numpy as np

    from gfmd_numba.analysis.fit_dataset import in_the_limit
    from gfmd_numba.contact.observables import OBSERVABLES, PATH_OBSERVABLES

    factor, unit = _readable_unit(fitted["reference"])
    row = (OBSERVABLES | PATH_OBSERVABLES).get(fitted.attrs["variable"])
    if row is not None and row.unit == "energy" and unit.endswith("Pa"):  # of a scene without a length
        unit += " L_x"
    of_unit = f" ({unit})" if unit else ""
    varied = [limit for limit in LIMITS if fitted["alpha"].sel(limit=limit).notnull().any()]
    towards = f" and its limit {', '.join(varied)} -> 0" if varied else ""
    title = f"{fitted.attrs['variable']}{of_unit}{towards} (one standard error)"
    shown = fitted[_IN_UNIT_OF_VARIABLE] * factor
    limits, errors = (factor * each for each in in_the_limit(fitted))
    values = {"limit": _with_errors(limits, errors)}
    for limit in varied:
        correction = [shown[name].sel(limit=limit) for name in ("correction", "correction_error")]
        values[LIMITS[limit]] = _with_errors(*correction)
    if fitted["interaction"].notnull().any():
        together = shown["interaction"].fillna(0.0).sum("pair")
        values["together"] = _with_errors(together, np.sqrt((shown["interaction_error"] ** 2).sum("pair")))
    values["reference"] = _with_errors(shown["reference"], shown["reference_error"])
    yield Table(title, _cells(fitted, _shown_parameters(fitted)), values)
    for limit in varied:
        laws = " or ".join(name for name in np.unique(fitted["law"].sel(limit=limit)).tolist() if name)
        found = f"{laws}, exponent {_exponent_found(fitted, limit)}, extrapolated {_distance(fitted, limit)}"
        yield Line(LIMITS[limit], f"{limit}: {found}", width=14)
    if "eps_t" in varied and ("aspect_ratio" not in fitted or (fitted["aspect_ratio"] < inf).any()):
        is_slab = "aspect_ratio" in fitted  # and else layered
        becomes = "a slab becomes infinitely thick" if is_slab else "layers become infinitely thick"
        limit = "so that this limit is that of a half-space" + ("" if is_slab else " of the uppermost one")
        advice = "leave eps_t out, with levels of your own, for a finite height"
        yield Line("note", f"as eps_t -> 0 {becomes}, {limit}: {advice}")
    if (fitted["freedom"] > 0).any():
        worst = float((fitted["chi2"] / fitted["freedom"].where(fitted["freedom"] > 0)).max())
        yield Line("misfit", f"chi^2 is up to {worst:.2g} per degree of freedom, where about 1 is expected")
    if (fitted["error_budget"] > 0).any():
        most = factor * fitted["error_budget"].max("group")  # of each source, in any group
        parts = (
            f"{name} {part:.2g}" for name, part in zip(most["source"].values, most.values, strict=True) if part > 0
        )
        seconds = fitted.attrs.get("cpu_seconds", 0.0)
        spent = f"; {duration(seconds)} of processor time for the contacts" if seconds else ""
        in_unit = f" in {unit}" if unit else ""
        yield Line("error", f"largest parts{in_unit}, added in quadrature: {', '.join(parts)}{spent}")
    yield from _notes(fitted)


def of_paths(dataset: xr.Dataset) -> Told:
    """Yield the means of every case: hysteresis and pull-off of its path, and the contact after the last step.

    For a campaign with limits only the references are shown.
    """
    from gfmd_numba.analysis import ensemble_mean

    if LIMITS.keys() & set(dataset["limit"].values):
        dataset = dataset.isel(case=dataset["is_reference"].values)
    shown = dataset.isel(case=slice(MOST_ROWS), step=-1)
    names = [name for name in _SHOWN_OF_PATHS if name in dataset]
    means = shown.drop_vars(names)
    for name in names:
        mean, error = ensemble_mean(shown, name)
        means[name], means[f"{name}_standard_error"] = ("case", mean, dataset[name].attrs), ("case", error)
    steps = dataset.sizes["step"] - 1
    yield from _of_means(
        f"end of the path of {counted(steps, 'step')}", shown, dataset, dict(column(means, name) for name in names)
    )


def of_goal(dataset: xr.Dataset, fitted: xr.Dataset) -> Told:
    """Yield how near a campaign came to its target, round by round if it ran in rounds; nothing without a target."""
    from gfmd_numba.analysis.arguments import targets_of

    targets = targets_of(dataset)
    if "round" in dataset.dims:
        yield from _of_rounds(dataset, fitted, targets)
    elif fitted.attrs["variable"] in targets:
        yield from of_target(fitted, targets[fitted.attrs["variable"]])
    if others := [name for name in targets if name != fitted.attrs["variable"]]:
        yield Line("note", f"`gfmd fit --variable NAME` shows the limit of {' or '.join(others)}")


def _of_rounds(dataset: xr.Dataset, fitted: xr.Dataset, targets: dict[str, float]) -> Told:
    from gfmd_numba.analysis.fit_dataset import UNKNOWN, in_the_limit

    known = {name: dataset.sel(target=name) if "target" in dataset.dims else dataset for name in targets}
    for number in dataset["round"].values.tolist():
        errors, asked = [], "finer levels" if number else "the pilot"
        for name, of_target in known.items():
            one = of_target.sel(round=number)
            found = said_of_error(float(one["round_error"]), float(one["round_error_factor"]))
            errors.append(f"{name} {found}" if len(targets) > 1 else found)
            if not isnan(expected := float(one["round_predicted_error"])):
                asked = f"{expected:.2%}{f' of {name}' if len(targets) > 1 else ''} expected"
        seconds = float(dataset["round_cpu_seconds"].sel(round=number))
        spent = "not finished" if isnan(seconds) else f"{duration(seconds)} of processor time for the contacts so far"
        yield Line("round", f"{number}: {', '.join(errors)}, {asked}; {spent}")
    reached = dataset.attrs.get("reached", "").split(", ")
    for name, target in targets.items():
        yield Line("until", f"{name} to {target:.2%}: {'reached' if name in reached else dataset.attrs['ended']}")
    of_fitted = known.get(fitted.attrs["variable"])
    error = nan if of_fitted is None else float(of_fitted["round_error"][-1])
    digit = error / 10
    if isnan(error) or isnan(seconds) or error > UNKNOWN or f"{digit:.2%}" == "0.00%":
        return
    # the largest relative error of a limit that its levels leave, however many surfaces there are
    parts = fitted["error_budget"].sel(source=["extrapolation", "rivals"]).fillna(0.0)
    left = float(((parts**2).sum("source") ** 0.5 / abs(in_the_limit(fitted)[0])).max())
    if left < digit:  # the rest of the error falls with the square root of time
        price = f"takes about {duration(100 * seconds)} of processor time for the contacts"
    else:
        price = f"needs finer levels: these leave {100 * left:.2g} % open, however many surfaces there are"
    yield Line("price", f"a tenth of this error, {digit:.2%}, {price}")


def of_target(fitted: xr.Dataset, target: float) -> Told:
    """Yield the error each group was meant to have, and the one it has."""
    from gfmd_numba.analysis.fit_dataset import in_the_limit

    limit, error = in_the_limit(fitted)
    reached = (error / abs(limit)).values
    missed = [f"{error:.2%}" for error in reached if not error <= target]
    verdict = f"missed by {len(missed)} of {len(reached)} groups" if missed else "reached by all groups"
    yield Line("target", f"{target:.2%}: {', '.join(f'{error:.2%}' for error in reached)}; {verdict}")
    if missed:
        further = "goes on with more realisations, or finer levels, until all groups reach it"
        yield Line("note", f"`gfmd run --until` {further}")


def said_of_error(error: float, factor: float) -> str:
    """Return the error after a round and its bound with 90 % probability; an error of nan is unknown."""
    if isnan(error):
        return "without an error"
    at_most = f"{error * factor:.2%}"
    return f"error {error:.2%}" + (f" (with 90 % probability below {at_most})" if at_most != f"{error:.2%}" else "")


def _distance(fitted: xr.Dataset, limit: str) -> str:
    """Return from which level a limit was extrapolated, and how far, in the group where it is furthest."""
    import numpy as np

    from gfmd_numba.analysis.fit_dataset import in_the_limit
    from gfmd_numba.analysis.selection import fractions

    of_limit = fitted.sel(limit=limit)
    share = abs(of_limit["extrapolated"] / in_the_limit(fitted)[0]).fillna(0.0)
    worst = int(share.values.argmax())
    finest = fractions(np.atleast_1d(of_limit["finest_eps"].values[worst]))
    return f"from {finest}, {100 * float(share[worst]):.2g} % away from the limit"


def _readable_unit(values: xr.DataArray) -> tuple[float, str]:
    """Return the factor on values, 1 for those from 0.1 to 1e4 without a prefix, and the unit that they then have."""
    largest = float(abs(values).max())
    factor, unit = si_prefix(largest, values.attrs.get("units", "1"))
    largest *= factor
    exponent = floor(log10(largest)) if 0.0 < largest < inf else 0
    power = "" if -1 <= exponent <= 3 else f"1e{exponent:+03d}"
    return factor / float(power or 1.0), " ".join(filter(None, (power, unit.removeprefix("1"))))


def _of_means(what: str, shown: xr.Dataset, dataset: xr.Dataset, means: dict[str, list[str]]) -> Told:
    """Yield the means of the cases that are shown, by heading, and how many more the dataset has."""
    title = f"{what}, mean of the realisations (one standard error)"
    yield Table(title, cells_of_parameters(shown, dataset), means)
    if dataset.sizes["case"] > MOST_ROWS:
        yield Line("note", f"{dataset.sizes['case'] - MOST_ROWS} more cases are in the file")


def cells_of_parameters(shown: xr.Dataset, dataset: xr.Dataset) -> dict[str, list[str]]:
    """Return the parameters of the cases that are shown, by heading; the dataset tells which are."""
    return _cells(shown, _shown_parameters(dataset) | {limit: limit for limit in LIMITS if limit in dataset.coords})


def states(status: xr.DataArray) -> dict[int, str]:
    """Return the names of the ways in which runs may have ended, by their numbers."""
    return dict(zip(map(int, status.attrs["flag_values"]), status.attrs["flag_meanings"].split(), strict=True))


def endings(status: xr.DataArray) -> list[tuple[str, xr.DataArray, str]]:
    """Return each way in which runs ended that are not ok: its name, which runs did, and its sentence."""
    told = dict(line.split(": ", 1) for line in status.attrs["flag_sentences"].splitlines())
    found = ((name, status == number, told[name]) for number, name in states(status).items() if number)
    return [each for each in found if each[1].any()]


def duration(seconds: float) -> str:
    """Return a time span as people say it."""
    for unit, length in (("days", 86400.0), ("h", 3600.0), ("min", 60.0)):
        if seconds >= 2 * length:
            return f"{seconds / length:.1f} {unit}"
    return f"{seconds:.2g} s" if seconds < 10 else f"{seconds:.0f} s"


def _cells(dataset: xr.Dataset, names: dict[str, str]) -> dict[str, list[str]]:
    return {heading: _values(dataset[name]) for heading, name in names.items()}


def _values(parameter: xr.DataArray) -> list[str]:
    """Return the values of a parameter as cells; of long names only the ends, if these differ."""
    from gfmd_numba.analysis.selection import has_names, values_as_text

    if not has_names(parameter):
        return ["-" if isnan(value) else f"{value:g}" for value in map(float, parameter.values)]
    names = values_as_text(parameter, parameter.values)
    short = [name if len(name) <= _LONGEST_NAME else f"...{name[3 - _LONGEST_NAME :]}" for name in names]
    return short if len(set(short)) == len(set(names)) else names


def _parameters(dataset: xr.Dataset) -> dict[str, str]:
    """Return heading and name of each coordinate that is physics."""
    from gfmd_numba.analysis.selection import axes

    named = {name: (dataset[name].attrs["symbol"], dataset[name].attrs["units"]) for name in axes(dataset)}
    return {symbol if unit == "1" else f"{symbol} ({unit})": name for name, (symbol, unit) in named.items()}


def _shown_parameters(dataset: xr.Dataset) -> dict[str, str]:
    """Return heading and name of each parameter; the scale of roughness, on which kappa does not depend, if varied."""
    return {
        heading: name
        for heading, name in _parameters(dataset).items()
        if name not in _UNUSED_BY_KAPPA or len(set(dataset[name].values.tolist())) > 1
    }


def _notes(fitted: xr.Dataset) -> Iterator[Line]:
    """Yield the messages of groups; of a sentence that many groups have with other numbers, the one of the largest."""
    kinds: dict[str, dict[str, list[int]]] = {}
    for group, message in enumerate(fitted["message"].values):
        for line in str(message).splitlines():
            kinds.setdefault(_NUMBER.sub("", line), {}).setdefault(line, []).append(group)
    for lines in kinds.values():
        having = sorted({group for groups in lines.values() for group in groups})
        if len(having) > _MOST_GROUPS and len(lines) > 1:
            line = max(lines, key=lambda line: float(_NUMBER.findall(line)[0]))
            yield Line("note", f"{len(having)} groups, such as {_whose(fitted, lines[line][:1])}{line}")
            continue
        for line, groups in lines.items():
            whose = "" if len(groups) == fitted.sizes["group"] else _whose(fitted, groups)
            yield Line("note", f"{whose}{line}")


def _whose(fitted: xr.Dataset, having: list[int]) -> str:
    """Return which of several groups a note is about."""
    if len(having) > _MOST_GROUPS:
        return f"{len(having)} of {fitted.sizes['group']} groups: "
    varied = {h: name for h, name in _parameters(fitted).items() if len(set(_values(fitted[name]))) > 1}
    groups = [", ".join(f"{heading} = {_values(fitted[name])[i]}" for heading, name in varied.items()) for i in having]
    return " and ".join(groups) + ": "


def _exponent_found(fitted: xr.Dataset, limit: str) -> str:
    """Return the exponent of a limit. If groups have different ones, return them in order, or the range of many."""
    import numpy as np

    values, errors = (fitted[name].sel(limit=limit).values for name in ("alpha", "alpha_error"))
    low, high = (fitted[name].sel(limit=limit).values[0] for name in ("alpha_low", "alpha_high"))
    if low < high and (errors[values == values] > _KNOWN * (high - low) / sqrt(12.0)).all():  # those that are numbers
        return f"anywhere from {low:g} to {high:g}, as assumed"
    found = [with_error(*each) for each in zip(values, errors, strict=True)]
    if len(set(found)) == 1:
        return found[0]
    return ", ".join(found) if len(found) <= _MOST_EXPONENTS else f"{np.nanmin(values):.4g} to {np.nanmax(values):.4g}"


def _with_errors(values: Any, errors: Any) -> list[str]:
    return [with_error(float(value), float(error)) for value, error in zip(values, errors, strict=True)]


def of_results(dataset: xr.Dataset, fitted: xr.Dataset | None) -> Told:
    """Yield what came out: of a campaign with its fit if it has limits; of what is no contact all single numbers."""
    if "case" in dataset.dims:
        yield from of_campaign(dataset, fitted)
    elif "prescribed" in dataset.attrs:
        yield from of_curve(dataset)
    elif "fit_status" in dataset:
        yield from of_fit(dataset)
    elif "step" in dataset.dims and "residual" in dataset:
        yield from of_steps(dataset)
    elif "residual" in dataset:
        yield from of_contact(dataset)
    elif any(name in dataset for name in _MEASURES):
        yield from of_measures(dataset)
    else:
        for name, variable in dataset.data_vars.items():
            if not variable.dims and variable.dtype.kind in "fiu":
                free = {"rms_height": "L_x", "rms_curvature": "1/L_x"}.get(str(name), "")
                told = with_prefix(float(variable), unit_of(dataset, str(name), free), _DIGITS)
                yield Line(str(name), told, _WIDE)
    if "peak_pressure" in dataset and dataset["peak_pressure"].attrs.get("units") == "Pa":
        peak = float(dataset["peak_pressure"].max())
        if peak > _MAY_YIELD and is_elastic_contact(dataset.attrs.get("scene", "{}")):
            told = f"bodies are elastic here: if their hardness is below {with_prefix(peak, 'Pa', 3)}, the largest"
            yield Line("note", f"{told} pressure, give it as interface: {{hard_wall: {{hardness: ...}}}}")
    of_ridges = is_measured_profile(dataset.attrs.get("scene", "{}"))
    if "case" in dataset.dims and "processing" in dataset.attrs:  # a campaign of measured surfaces
        has_form = bool({"radius", "slope", "width"} & set(map(str, dataset.coords)))
        of_ridges |= not has_form and bool((dataset["dimension"] == 1).all())
    if "contact_area_fraction" in dataset and of_ridges:
        yield Line("note", _OF_RIDGES)


def of_campaign(dataset: xr.Dataset, fitted: xr.Dataset | None) -> Told:
    """Yield limits and how near they are to their target; the means of paths, or of all cases, where there are none."""
    from gfmd_numba.analysis import ensemble_mean, fit_tfc

    options = fit_options(dataset)
    if "step" in dataset.dims:
        yield from of_paths(dataset)
    elif fitted is None:
        variable, shown = options.get("variable", "kappa"), dataset.isel(case=slice(MOST_ROWS))
        yield from _of_means(variable, shown, dataset, {variable: _with_errors(*ensemble_mean(shown, variable))})
    if fitted is None:
        return
    shown = fitted
    if "step" in dataset.dims:
        whole = {name: value for name, value in options.items() if name != "step"}
        for variable in (name for name in OF_PATHS if name in dataset and name != fitted.attrs["variable"]):
            yield from of_fit(fit_tfc(dataset, **whole | {"variable": variable}))
        if not (fitted["fit_status"] == "ok").any() and fitted.attrs["variable"] not in OF_PATHS:  # kappa under tension
            shown = fit_tfc(dataset, **options | {"variable": "contact_area_fraction"})
    yield from of_fit(shown)
    yield from of_goal(dataset, fitted)


def has_limits(dataset: xr.Dataset) -> bool:
    """Return whether a campaign varies discretisations, so that a limit can be fitted."""
    return "limit" in dataset and bool(LIMITS.keys() & set(dataset["limit"].values))


def _with_meaning(dataset: xr.Dataset) -> tuple[xr.Dataset, set[str]]:
    """Return the dataset with the force on a form without roughness in a window, and the variables without meaning.

    A form without roughness has no gradient, and under a law that keeps the surfaces apart nothing touches.
    """
    from gfmd_numba.contact.observables import OF_TOUCHING
    from gfmd_numba.scene import Interface

    scene = json.loads(dataset.attrs["scene"]).get("scene", {})
    touches = Interface.model_validate(scene["interface"]).touches if "interface" in scene else True
    nothing = set() if touches else OF_TOUCHING
    if not is_form_alone(dataset.attrs["scene"]):
        return dataset, nothing
    nothing = nothing | {"reduced_pressure", "kappa", "kappa_r"}
    if scene["periodic"] is not False:
        return dataset, nothing
    name, si, area = {1: ("line_load", "N m-1", "L_x"), 2: ("force", "N", "L_x2")}[scene["dimension"]]
    forces, length = {"mean_pressure": name} | _FORCES, scene["length"]
    for force, pressure in ((force, dataset[of]) for of, force in forces.items() if of in dataset):
        if force not in dataset.variables:
            is_si = pressure.attrs["units"] == "Pa"
            unit = si if is_si and length else f"{'Pa' if is_si else 'E*'} {area}"
            whole = pressure * (length or 1.0) ** scene["dimension"]
            dataset = dataset.assign({force: whole.assign_attrs(units=unit)})
    return dataset, nothing | forces.keys()


def of_contact(dataset: xr.Dataset) -> Told:
    """Yield what came of one loading, a line each."""
    dataset, nothing = _with_meaning(dataset)
    prescribed = [name for name in _PRESCRIBED if name in dataset.coords and name not in nothing]
    for name in (*prescribed, *(name for name in _SHOWN if name in dataset.data_vars and name not in nothing)):
        yield line(dataset, name)
    yield Line("residual", f"{float(dataset['residual']):.1e}", _WIDE)


def of_steps(dataset: xr.Dataset) -> Told:
    """Yield the steps of a path: what was prescribed, and what came of it."""
    import numpy as np

    from gfmd_numba.analysis import secant_stiffness

    view, nothing = _with_meaning(dataset)
    laws = json.loads(dataset.attrs["scene"])["scene"]["interface"]
    only_wall = [name for name, law in laws.items() if law is not None] == ["hard_wall"]
    if only_wall and dataset.sizes["step"] > 1:  # stiffness since the step before, where the load changed
        between = secant_stiffness(dataset)["stiffness"].values
        view = view.assign({_SECANT: ("step", np.append(nan, np.where(np.isfinite(between), between, nan)))})
    prescribed = [name for name in _PRESCRIBED if name in view.coords and view[name].any() and name not in nothing]
    steps = {"step": [str(step) for step in range(dataset.sizes["step"])]}
    found = dict(column(view, name) for name in _SHOWN if name in view.data_vars and name not in nothing)
    found["residual"] = [f"{float(residual):.1e}" for residual in dataset["residual"]]
    yield Table("steps of the path", steps | dict(column(dataset, name) for name in prescribed), found)
    whole = [name for name in _SHOWN_OF_PATHS if name in view and name not in nothing and not view[name].ndim]
    for name in (each for each in whole if not isnan(float(view[each]))):
        yield line(view, name)


def of_curve(dataset: xr.Dataset) -> Told:
    """Yield the curve, one line a load, time or speed."""
    from gfmd_numba.simulate.curve import SHOWN

    load, view = named(dataset)
    view, nothing = _with_meaning(view)
    same = nothing | ({load, "mean_pressure"} if load == "prescribed_pressure" else {load})
    shown = [name for name in ("force", "line_load", *SHOWN) if name in view and name not in same]
    values = dict(column(view, name) for name in shown)
    if dataset["status"].any():
        values["status"] = [states(dataset["status"])[int(status)] for status in dataset["status"]]
    if int(dataset["n_realisations"].max()) > 1:
        values["surfaces"] = [str(int(count)) for count in dataset["n_realisations"]]
    heading, loads = column(view, load)
    yield Table(dataset.attrs["title"], {heading: loads}, values)


def named(dataset: xr.Dataset) -> tuple[str, xr.Dataset]:
    """Return the name of what the loading of a curve prescribes, and the dataset in which the load has it."""
    from gfmd_numba.contact.observables import PRESCRIBED

    given = str(dataset.attrs["prescribed"])
    name = PRESCRIBED.get(given, given)
    return name, dataset.assign({name: dataset[over(dataset)]})


def over(dataset: xr.Dataset) -> str:
    """Return the dim of a curve."""
    return next((name for name in ("time", "speed") if name in dataset.dims), "prescribed_load")


def of_measures(dataset: xr.Dataset) -> Told:
    """Yield what was measured of a solved contact as a whole, or of each step of a path."""
    from gfmd_numba.contact.observables import OF_TOUCHING

    area = dataset.get("contact_area_fraction")
    nothing = OF_TOUCHING if area is not None and not area.any() else set()
    shown = (name for name in _MEASURES if name in dataset and name not in nothing)
    cells = {words: values for name in shown for words, values in _measured(dataset, name)}
    if "step" in dataset.dims:
        steps = {"step": [str(step) for step in range(dataset.sizes["step"])]}
        yield Table("steps of the path", steps | dict(column(dataset, name) for name in _loads(dataset)), cells)
        return
    for words, (value,) in cells.items():
        yield Line(words, value, _WIDE + 4)


def columns_of_measures(dataset: xr.Dataset) -> dict[str, list[object]]:
    """Return what was prescribed at each step of a path and measured of it, by name, direction and unit."""
    names = (*_loads(dataset), *(name for name in _MEASURES if name in dataset))
    parts = {f"{name}_{way}" if way else name: part for name in names for way, part in _ways(dataset[name])}
    return {f"{name} ({part.attrs.get('units', '1')})": part.values.tolist() for name, part in parts.items()}


def _ways(variable: xr.DataArray) -> list[tuple[str, xr.DataArray]]:
    """Return a variable for each direction if it has them, or as it is for none."""
    along = variable.get_index("direction") if "direction" in variable.dims else ()
    return [(str(each), variable.sel(direction=each)) for each in along] or [("", variable)]


def _loads(dataset: xr.Dataset) -> list[str]:
    """Return the names of what the steps of a path prescribe."""
    return [name for name in _PRESCRIBED if name in dataset.coords and dataset[name].dims and dataset[name].any()]


def _measured(dataset: xr.Dataset, name: str) -> Iterator[tuple[str, list[str]]]:
    """Yield words and cells of a variable, for each direction if it has them."""
    words, free = _MEASURES[name]
    variable = dataset[name]
    unit = variable.attrs["units"].replace("m-1", "1/m") if variable.attrs["units"] != "1" else free
    flag = name.endswith("_connects")
    for way, part in _ways(variable):
        values = part.values.ravel().tolist()
        cells = [("no", "yes")[value] if flag else with_prefix(value, unit, 5) for value in values]
        if name == "flow":
            cells = [f"{value:.3g} m^3/s = {3.6e6 * value:.3g} L/h" for value in values]
        yield f"{words} along {way}" if way else words, cells


def fit_options(
    dataset: xr.Dataset, fixed: tuple[Fixed, ...] = (), variable: str | None = None, exponents: str | None = None
) -> dict[str, Any]:
    """Return the options of the fit: those of the campaign, overridden by those of the command line."""
    options: dict[str, Any] = json.loads(dataset.attrs.get("fit", "{}"))
    if variable is not None:
        options["variable"] = variable
        if variable in OF_PATHS:
            options.pop("step", None)  # which the path as a whole has not
        options = json.loads(dataset.attrs.get("fits_of_targets", "{}")).get(variable, options)
    options["fixed"] = options.get("fixed", {}) | dict(fixed)
    if exponents is not None:
        options["exponents"] = exponents
    return options
