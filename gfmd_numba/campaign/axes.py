"""The one table of axes: what a campaign's grid may vary, where it stands in a scene, and what it is called.

To add an axis, add its row. This is pure data and records: importing it compiles nothing.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from operator import attrgetter
from typing import Any

from pydantic import BaseModel

from gfmd_numba.scene import Discretisation, Scene
from gfmd_numba.scene.form_record import FormSlope
from gfmd_numba.scene.measured_record import FileName
from gfmd_numba.scene.quantities import (
    FORCE_ON_A_MAP,
    LINE_LOAD,
    MEAN_PRESSURE,
    PUNCH_DISPLACEMENT,
    REDUCED_PRESSURE,
    RMS_GRADIENT_TARGET,
    Anisotropy,
    AspectRatio,
    EpsC,
    EpsF,
    EpsT,
    Force,
    FrictionCoefficient,
    Hurst,
    Length,
    LineLoad,
    Points,
    PoissonsRatio,
    Pressure,
    ReducedPressure,
    RmsGradient,
    SignedLength,
    SignedWorkOfAdhesion,
    Speed,
)
from gfmd_numba.scene.surfaces import PositiveHurst

Place = tuple[str, ...]  # names of the fields that lead from a scene to a value
_COORDINATES = {
    "pressure": "prescribed_pressure",
    "displacement": "punch_displacement",
    "rms_gradient": "rms_gradient_target",
}


@dataclass(frozen=True)
class Axis:
    """A parameter of a grid: its name, the type of its values, and the record of the scene that has it.

    `record` is a dotted path in the scene, and `key` the name of the field there if it is another. A discretisation
    stands next to the scene and has no record; `limit` then names the limit in which it goes to 0. `symbol` heads a
    column on the terminal, and `label` is its TeX. `unit` is a kind of unit, as the units of a scene are named.
    """

    name: str
    type: Any
    record: str
    symbol: str
    label: str
    long_name: str
    unit: str = "1"
    limit: str = ""
    key: str = ""

    @cached_property
    def place(self) -> Place:
        """Names of the fields that lead from the scene to the value; none of a discretisation."""
        return (*self.record.split("."), self.key or self.name) if self.record else ()

    @property
    def forms_groups(self) -> bool:
        """Whether cases that differ in it are different physics, and never enter one fit."""
        return not self.limit

    @property
    def coordinate(self) -> str:
        """Name of its coordinate in the dataset, where what is asked for is not what is measured."""
        return _COORDINATES.get(self.name, self.name)

    @property
    def has_names(self) -> bool:
        """Whether its values are names, which the dataset numbers as well."""
        return self.type is FileName

    @property
    def of_surface(self) -> bool:
        """Whether it varies the rough surface."""
        return self.place[:1] == ("roughness",)

    @cached_property
    def _found(self) -> Callable[[Any], Any]:
        return attrgetter(".".join(self.place or (self.name,)))

    def value(self, scene: Scene, discretisation: Discretisation | None) -> float | str | None:
        """Value of a case; None if it has no such parameter, as layers have ratios and heights of their own."""
        if len(self.place) == 2 and self.place[0] in ("body", "counter_body"):
            body = getattr(scene, self.place[0])
            if body is not None and body.layers is not None:
                return None
        try:
            found: float | str | None = self._found(scene if self.record else discretisation)
        except AttributeError:
            return None
        return found


def _of_rough_body(body: str) -> Iterator[Axis]:
    """Axes of the roughness of one of the two bodies."""
    number, whose = ("1", "body") if body == "body" else ("2", "counter body")
    for key, kind, symbol, label, long_name, unit in (
        ("hurst", Hurst, "H", "H", "Hurst exponent", "1"),
        ("rms_gradient", RmsGradient, "g", r"\bar{g}", "rms gradient asked for", "1"),
        ("rms_height", Length, "h", r"\bar{h}", "rms height asked for", "height"),
    ):
        told = f"{symbol}_{number}", f"${label}_{number}$", f"{long_name}, of the surface of the {whose}"
        yield Axis(f"{body}_{key}", kind, f"{body}.roughness", *told, unit, key=key)


AXES = (
    Axis("file", FileName, "roughness", "file", "file", "file of the measured surface"),
    Axis("hurst", Hurst, "roughness", "H", "$H$", "Hurst exponent"),
    Axis("poissons_ratio", PoissonsRatio, "body", "nu", r"$\nu$", "Poisson's ratio of the body"),
    Axis("aspect_ratio", AspectRatio, "body", "a", "$a$", "thickness of the body over the period"),
    Axis("reduced_pressure", ReducedPressure, "loading", "p*", r"$\bar{p}^*$", REDUCED_PRESSURE),
    Axis("pressure", Pressure, "loading", "p", r"$\bar{p}$", MEAN_PRESSURE, "pressure"),
    Axis("line_load", LineLoad, "loading", "F/l", r"$F/\ell$", LINE_LOAD, "force per length"),
    Axis("force", Force, "loading", "F", "$F$", FORCE_ON_A_MAP, "force"),
    Axis("rms_gradient", RmsGradient, "roughness", "g", r"$\bar{g}$", RMS_GRADIENT_TARGET),
    Axis("anisotropy", Anisotropy, "roughness", "gamma", r"$\gamma$", "correlation length of a map, y over x"),
    Axis("hurst_x", PositiveHurst, "roughness", "H_x", "$H_x$", "Hurst exponent along x"),
    Axis("hurst_y", PositiveHurst, "roughness", "H_y", "$H_y$", "Hurst exponent along y"),
    Axis("rms_height", Length, "roughness", "h", r"$\bar{h}$", "rms height asked for", "height"),
    Axis("roll_off", Length, "roughness", "lambda_l", r"$\lambda_l$", "longest wavelength of the power law", "height"),
    Axis("cut_on", Length, "roughness", "lambda_s", r"$\lambda_s$", "shortest wavelength", "height"),
    Axis("cutoff", Length, "roughness", "lambda_c", r"$\lambda_c$", "shortest wavelength kept", "height"),
    Axis("points", Points, "roughness", "points", "$n_x$", "grid points of the surface over the period"),
    Axis("correlation_length", Length, "roughness", "xi", r"$\xi$", "correlation length", "height"),
    Axis("correlation_length_x", Length, "roughness", "xi_x", r"$\xi_x$", "correlation length along x", "height"),
    Axis("correlation_length_y", Length, "roughness", "xi_y", r"$\xi_y$", "correlation length along y", "height"),
    Axis("mound_separation", Length, "roughness", "lambda_m", r"$\lambda_m$", "mean distance of mounds", "height"),
    Axis("radius", Length, "form", "R", "$R$", "radius of the form, a ball or a cylinder", "height"),
    Axis("radius_y", Length, "form", "R_y", "$R_y$", "radius of the form along y", "height"),
    Axis("slope", FormSlope, "form", "slope", r"$\tan\beta$", "slope of the flanks of the form, a wedge or a cone"),
    Axis("width", Length, "form", "W", "$W$", "width of the form, a flat punch, between its edges", "height"),
    Axis("edge_radius", Length, "form", "R_e", "$R_e$", "radius of the edges of the form", "height"),
    Axis("speed", Speed, "loading", "v", "$v$", "sliding speed of the punch along x", "speed"),
    Axis("displacement", SignedLength, "loading", "d", "$d$", PUNCH_DISPLACEMENT, "height"),
    Axis(
        "friction_coefficient",
        FrictionCoefficient,
        "interface.friction",
        "mu",
        r"$\mu$",
        "tangential over normal traction at which a node slides",
        key="coefficient",
    ),
    Axis(
        "hardness",
        Pressure,
        "interface.hard_wall",
        "p_H",
        "$p_H$",
        "contact pressure at which the hard wall gives way",
        "pressure",
    ),
    Axis("yield_stress", Pressure, "body.plasticity", "Y", "$Y$", "uniaxial yield stress of the body", "pressure"),
    Axis(
        "hardening",
        Pressure,
        "body.plasticity",
        "H_p",
        "$H_p$",
        "slope of the yield stress of the body over the plastic strain",
        "pressure",
    ),
    Axis(
        "work_of_adhesion",
        SignedWorkOfAdhesion,
        "interface.exponential",
        "w",
        r"$\Delta\gamma$",
        "energy per area of the exponential law at zero gap, above 0 attractive",
        "energy",
    ),
    Axis(
        "interaction_range",
        Length,
        "interface.exponential",
        "z_r",
        "$z_r$",
        "range of the exponential law",
        "height",
        key="range",
    ),
    *(axis for body in ("body", "counter_body") for axis in _of_rough_body(body)),
    Axis(
        "counter_body_youngs_modulus",
        Pressure,
        "counter_body",
        "E_2",
        "$E_2$",
        "Young's modulus of the counter body",
        "pressure",
        key="youngs_modulus",
    ),
    Axis(
        "counter_body_poissons_ratio",
        PoissonsRatio,
        "counter_body",
        "nu_2",
        r"$\nu_2$",
        "Poisson's ratio of the counter body",
        key="poissons_ratio",
    ),
    Axis(
        "counter_body_aspect_ratio",
        AspectRatio,
        "counter_body",
        "a_2",
        "$a_2$",
        "thickness of the counter body over the period",
        key="aspect_ratio",
    ),
    Axis("eps_c", EpsC, "", "eps_c", r"$\varepsilon_c$", "continuum discretisation 2 k_s/nx", limit="continuum"),
    Axis("eps_f", EpsF, "", "eps_f", r"$\varepsilon_f$", "fractal discretisation k_l/k_s", limit="fractal"),
    Axis("eps_t", EpsT, "", "eps_t", r"$\varepsilon_t$", "thermodynamic discretisation 1/k_l", limit="thermodynamic"),
)
OF_THE_SCENE = tuple(axis for axis in AXES if axis.record)
DISCRETISATIONS = tuple(axis.name for axis in AXES if not axis.record)


def present(scene: Scene, discretisation: Discretisation | None) -> tuple[Axis, ...]:
    """Return the axes on which a case has a value; all cases of a campaign have values on the same ones."""
    return tuple(axis for axis in AXES if axis.value(scene, discretisation) is not None)


def with_values(scene: Scene, values: Mapping[Place, Any]) -> Scene:
    """Return the scene with other values in some places, whose records it has."""
    return scene.model_copy(update=_updates(scene, values))


def _updates(record: BaseModel, values: Mapping[Place, Any]) -> dict[str, Any]:
    inner: dict[str, list[tuple[Place, Any]]] = {}
    update: dict[str, Any] = {}
    for (name, *rest), value in values.items():
        if rest:
            inner.setdefault(name, []).append((tuple(rest), value))
        else:
            update[name] = value
    return update | {name: _part(getattr(record, name), tuple(given)) for name, given in inner.items()}


@lru_cache(maxsize=4096)
def _part(part: BaseModel, values: tuple[tuple[Place, Any], ...]) -> BaseModel:
    """Return a part of a scene with other values; equal parts of many cases are one record."""
    return part.model_copy(update=_updates(part, dict(values)))
