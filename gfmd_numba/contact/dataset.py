"""What all datasets of results are made of: variables in the units of the file, each with its unit and long_name."""

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from gfmd_numba.contact.evaluation import finite_status
from gfmd_numba.contact.observables import Observable
from gfmd_numba.contact.problem import Effect
from gfmd_numba.contact.scales import scales_of
from gfmd_numba.scene import LoadedBody, Scene
from gfmd_numba.scene.measured_record import AXES
from gfmd_numba.scene.quantities import (
    FORCE_ON_A_MAP,
    LINE_LOAD,
    MEAN_PRESSURE,
    PUNCH_DISPLACEMENT,
    REDUCED_PRESSURE,
)
from gfmd_numba.solvers import status

CONVENTIONS = "CF-1.11"
# attributes of x, which tell a whole period from a part of one, and a window that has no period
POINTS, POINTS_OF_WINDOW = "points_per_period", "points_per_window"
# coordinates of what a loading prescribes; the fields of a contact have the short names
PRESCRIBED = {"displacement": "punch_displacement", "pressure": "prescribed_pressure"}
INDICES = {
    "case": "case, in the order of the campaign",
    "realisation": "realisation: the same random surface in every case",
    "step": "step of the path, from the first loading",
}


Described = tuple[str, str, str, npt.ArrayLike]  # name, kind of unit, long_name and values of a variable


@dataclass(frozen=True)
class Units:
    """What each unit of a dimensionless problem is worth in a file, and what it is called there."""

    worth: Mapping[str, float]
    names: Mapping[str, str]

    @classmethod
    def of(cls, scene: Scene | LoadedBody, rms_gradient: float = 1.0) -> "Units":
        """Units of a scene, of heights in units of a gradient: m and Pa, or L_x and E*, which are called 1."""
        scales = scales_of(scene)
        height, pressure = rms_gradient * scales.length, rms_gradient * scales.modulus
        metre, pascal = "m" if scene.length else "1", "Pa" if scene.has_moduli else "1"
        both = [unit for unit in (pascal, metre) if unit != "1"]
        each = {
            "1": (1.0, "1"),
            "E*/stiffness": (1.0 / scales.stiffness, "1"),
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
        self, dims: Hashable | Sequence[Hashable], kind: str, long_name: str, values: npt.ArrayLike
    ) -> tuple[Hashable | Sequence[Hashable], npt.NDArray[Any], dict[str, Any]]:
        """Variable of a dataset, in the unit of its file."""
        return dims, scaled(np.asarray(values), self.worth[kind]), cf_attributes(long_name, self.names[kind])

    def variables(self, dims: Sequence[Hashable], described: Iterable[Described]) -> dict[str, Any]:
        """Variables of the same dims by name."""
        return {name: self.variable(dims, kind, told, values) for name, kind, told, values in described}

    def measure(self, name: str, row: Observable, value: npt.ArrayLike) -> tuple[Any, npt.NDArray[Any], dict[str, Any]]:
        """Variable without dims of an observable."""
        attributes = measure_attributes(name, self.names[row.unit], row.long_name)
        return (), scaled(np.asarray(value), self.worth[row.unit]), attributes

    def positions(
        self, shape: tuple[int, ...], profile: str, length: float | None, ends: tuple[bool, ...] = ()
    ) -> dict[str, Any]:
        """Coordinates of the nodes of a whole period, or window; `profile` says along what those of a profile lie."""
        points = [POINTS_OF_WINDOW if end else POINTS for end in ends or (False,) * len(shape)]
        ways = {1: (profile,), 2: AXES}[len(shape)]
        return {
            dim: (
                dim,
                np.arange(nodes) / nodes * (length or 1.0),
                cf_attributes(f"position along {way}", self.names["height"]) | {name: nodes},
            )
            for dim, way, nodes, name in zip(AXES[-len(shape) :], ways, shape, points, strict=True)
        }


def modulus_attributes(scene: Scene | LoadedBody) -> dict[str, str]:
    """Attributes of a dataset whose E* is that of one layer among others; none of any other."""
    if all(body.layers is None for body in scene.deformable) or not scene.has_moduli:
        return {}
    scales = scales_of(scene)
    whose = "the topmost layer" if len(scene.deformable) == 1 else "both bodies together, of layers the topmost"
    return {"effective_modulus": f"{scales.modulus / scales.stiffness:.17g} Pa: E* is that of {whose}"}


def load_attributes(scene: Scene) -> dict[str, dict[str, Any]]:
    """CF attributes of what a loading prescribes, by the name of its coordinate."""
    height = Units.of(scene).names["height"]
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
    results = {str(name): variable.values for name, variable in dataset.data_vars.items()}
    dataset["status"].values = finite_status(results)


def scaled(values: npt.NDArray[Any], factor: float) -> npt.NDArray[Any]:
    """Values in file units; counts and flags keep their integer type."""
    return values if factor == 1.0 else values * factor


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
