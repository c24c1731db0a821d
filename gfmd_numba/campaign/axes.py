"""The one table of axes: what a campaign's grid may vary, where it stands in a scene, and what it is called.

To add an axis, add its row. This is pure data and records: importing it compiles nothing.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from operator import attrgetter
from typing import Any

from pydantic import BaseModel

from gfmd_numba.scene import Discretisation, Scene
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
)
from gfmd_numba.scene.surfaces import PositiveHurst

Place = tuple[str, ...]  # names of the fields that lead from a scene to a value


@dataclass(frozen=True)
class Axis:
    """A parameter of a grid: its key, the type of its values, and the place in the scene that they are put in.

    `place` is empty for a discretisation, which stands beside the scene. `symbol` heads a column on the terminal,
    `label` is its TeX. `unit` is a kind of unit, as a scene's units are named by. Cases that differ in an axis that
    `forms_groups` are different physics, and never enter one fit. `coordinate_name` is its name in the dataset where
    that is not its key. `limit` is the name of the limit in which a discretisation goes to 0.
    """

    name: str
    type: Any
    place: Place
    symbol: str
    label: str
    long_name: str
    unit: str = "1"
    forms_groups: bool = True
    coordinate_name: str = ""
    limit: str = ""

    @property
    def coordinate(self) -> str:
        """Name of its coordinate in the dataset."""
        return self.coordinate_name or self.name

    @property
    def has_names(self) -> bool:
        """Whether its values are names, which the dataset counts beside them."""
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
        if self.place[:1] == ("body",) and scene.body.layers is not None:
            return None
        try:
            found: float | str | None = self._found(scene if self.place else discretisation)
        except AttributeError:
            return None
        return found


AXES = (
    Axis("file", FileName, ("roughness", "file"), "file", "file", "file of the measured surface"),
    Axis("hurst", Hurst, ("roughness", "hurst"), "H", "$H$", "Hurst exponent"),
    Axis("poissons_ratio", PoissonsRatio, ("body", "poissons_ratio"), "nu", r"$\nu$", "Poisson's ratio of the body"),
    Axis("aspect_ratio", AspectRatio, ("body", "aspect_ratio"), "a", "$a$", "thickness of the body over the period"),
    Axis(
        "reduced_pressure",
        ReducedPressure,
        ("loading", "reduced_pressure"),
        "p*",
        r"$\bar{p}^*$",
        REDUCED_PRESSURE,
    ),
    Axis(
        "pressure",
        Pressure,
        ("loading", "pressure"),
        "p",
        r"$\bar{p}$",
        MEAN_PRESSURE,
        unit="pressure",
        coordinate_name="prescribed_pressure",
    ),
    Axis("line_load", LineLoad, ("loading", "line_load"), "F/l", r"$F/\ell$", LINE_LOAD, unit="force per length"),
    Axis("force", Force, ("loading", "force"), "F", "$F$", FORCE_ON_A_MAP, unit="force"),
    Axis(
        "rms_gradient",
        RmsGradient,
        ("roughness", "rms_gradient"),
        "g",
        r"$\bar{g}$",
        RMS_GRADIENT_TARGET,
        coordinate_name="rms_gradient_target",
    ),
    Axis(
        "anisotropy",
        Anisotropy,
        ("roughness", "anisotropy"),
        "gamma",
        r"$\gamma$",
        "correlation length of a map, y over x",
    ),
    Axis("hurst_x", PositiveHurst, ("roughness", "hurst_x"), "H_x", "$H_x$", "Hurst exponent along x"),
    Axis("hurst_y", PositiveHurst, ("roughness", "hurst_y"), "H_y", "$H_y$", "Hurst exponent along y"),
    Axis("rms_height", Length, ("roughness", "rms_height"), "h", r"$\bar{h}$", "rms height asked for", "height"),
    Axis(
        "roll_off",
        Length,
        ("roughness", "roll_off"),
        "lambda_l",
        r"$\lambda_l$",
        "longest wavelength of the power law",
        "height",
    ),
    Axis("cut_on", Length, ("roughness", "cut_on"), "lambda_s", r"$\lambda_s$", "shortest wavelength", "height"),
    Axis("cutoff", Length, ("roughness", "cutoff"), "lambda_c", r"$\lambda_c$", "shortest wavelength kept", "height"),
    Axis("points", Points, ("roughness", "points"), "points", "$n_x$", "grid points of the surface over the period"),
    Axis(
        "correlation_length",
        Length,
        ("roughness", "correlation_length"),
        "xi",
        r"$\xi$",
        "correlation length",
        "height",
    ),
    Axis(
        "correlation_length_x",
        Length,
        ("roughness", "correlation_length_x"),
        "xi_x",
        r"$\xi_x$",
        "correlation length along x",
        "height",
    ),
    Axis(
        "correlation_length_y",
        Length,
        ("roughness", "correlation_length_y"),
        "xi_y",
        r"$\xi_y$",
        "correlation length along y",
        "height",
    ),
    Axis(
        "mound_separation",
        Length,
        ("roughness", "mound_separation"),
        "lambda_m",
        r"$\lambda_m$",
        "mean distance of mounds",
        "height",
    ),
    Axis(
        "displacement",
        SignedLength,
        ("loading", "displacement"),
        "d",
        "$d$",
        PUNCH_DISPLACEMENT,
        unit="height",
        coordinate_name="punch_displacement",
    ),
    Axis(
        "friction_coefficient",
        FrictionCoefficient,
        ("interface", "friction", "coefficient"),
        "mu",
        r"$\mu$",
        "tangential over normal traction at which a node slides",
    ),
    Axis(
        "hardness",
        Pressure,
        ("interface", "hard_wall", "hardness"),
        "p_H",
        "$p_H$",
        "contact pressure at which the hard wall gives way",
        "pressure",
    ),
    Axis(
        "work_of_adhesion",
        SignedWorkOfAdhesion,
        ("interface", "exponential", "work_of_adhesion"),
        "w",
        r"$\Delta\gamma$",
        "energy per area of the exponential law at zero gap, above 0 attractive",
        unit="energy",
    ),
    Axis(
        "interaction_range",
        Length,
        ("interface", "exponential", "range"),
        "z_r",
        "$z_r$",
        "range of the exponential law",
        unit="height",
    ),
    Axis(
        "eps_c",
        EpsC,
        (),
        "eps_c",
        r"$\varepsilon_c$",
        "continuum discretisation 2 k_s/nx",
        forms_groups=False,
        limit="continuum",
    ),
    Axis(
        "eps_f",
        EpsF,
        (),
        "eps_f",
        r"$\varepsilon_f$",
        "fractal discretisation k_l/k_s",
        forms_groups=False,
        limit="fractal",
    ),
    Axis(
        "eps_t",
        EpsT,
        (),
        "eps_t",
        r"$\varepsilon_t$",
        "thermodynamic discretisation 1/k_l",
        forms_groups=False,
        limit="thermodynamic",
    ),
)
OF_THE_SCENE = tuple(axis for axis in AXES if axis.place)
DISCRETISATIONS = tuple(axis.name for axis in AXES if not axis.place)


def present(scene: Scene, discretisation: Discretisation | None) -> tuple[Axis, ...]:
    """Axes that a case has a value on, as have all cases of its campaign."""
    return tuple(axis for axis in AXES if axis.value(scene, discretisation) is not None)


def with_values(scene: Scene, values: Mapping[Place, Any]) -> Scene:
    """Scene with other values in some places, whose records it has."""
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
    """Part of a scene with other values; equal parts of many cases are one record."""
    return part.model_copy(update=_updates(part, dict(values)))
