"""The one table of axes: what a campaign's grid may vary, where it stands in a scene, and what it is called.

To add an axis, add its row. This is pure data and records: importing it compiles nothing.
"""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from pydantic import BaseModel

from gfmd_numba.campaign.axis import Axis, Place
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


def _of_rough_body(whose: str) -> tuple[Axis, ...]:
    """Axes of the roughness of one of the two bodies."""
    number, name = ("1", "body") if whose == "body" else ("2", "counter body")
    of_all = (
        ("hurst", Hurst, "H", "H", "Hurst exponent", "1"),
        ("rms_gradient", RmsGradient, "g", r"\bar{g}", "rms gradient asked for", "1"),
        ("rms_height", Length, "h", r"\bar{h}", "rms height asked for", "height"),
    )
    return tuple(
        Axis(
            f"{whose}_{key}",
            kind,
            (whose, "roughness", key),
            f"{symbol}_{number}",
            f"${label}_{number}$",
            f"{long_name}, of the surface of the {name}",
            unit,
        )
        for key, kind, symbol, label, long_name, unit in of_all
    )


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
    *(axis for whose in ("body", "counter_body") for axis in _of_rough_body(whose)),
    Axis(
        "counter_body_youngs_modulus",
        Pressure,
        ("counter_body", "youngs_modulus"),
        "E_2",
        "$E_2$",
        "Young's modulus of the counter body",
        unit="pressure",
    ),
    Axis(
        "counter_body_poissons_ratio",
        PoissonsRatio,
        ("counter_body", "poissons_ratio"),
        "nu_2",
        r"$\nu_2$",
        "Poisson's ratio of the counter body",
    ),
    Axis(
        "counter_body_aspect_ratio",
        AspectRatio,
        ("counter_body", "aspect_ratio"),
        "a_2",
        "$a_2$",
        "thickness of the counter body over the period",
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
