"""What all records share: their configuration, the quantities that return and the error of a broken rule."""

from math import inf
from typing import Annotated, Literal

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field
from pydantic_core import PydanticCustomError

RECORD = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False, ser_json_inf_nan="constants")

SMALLEST, LARGEST = 1e-30, 1e30  # whatever a user gives: all products of a scene, and their squares, stay finite
Size = Annotated[float, Field(ge=SMALLEST, le=LARGEST)]
Signed = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]


def _aspect_ratio(given: float) -> float:
    if LARGEST < given < inf:
        raise ValueError("neither that of a slab nor of a half-space")
    return given


def _dimension(given: object) -> object:
    if isinstance(given, bool):  # which equals 1
        raise ValueError("no number")
    return given


PoissonsRatio = Annotated[float, Field(gt=-1, le=0.5, description="Poisson's ratio (dimensionless)")]
AspectRatio = Annotated[
    float,
    Field(
        ge=1e-12,  # far below, stiffnesses grow beyond the range of numbers
        allow_inf_nan=True,
        description="Thickness over period, z_m/L_x (dimensionless); inf: a half-space",
        json_schema_extra={"allowed": "from 1e-12 to 1e30, or .inf for a half-space"},
    ),
    AfterValidator(_aspect_ratio),
]
Dimension = Annotated[Literal[1, 2], BeforeValidator(_dimension)]
Hurst = Annotated[float, Field(ge=0, le=1, description="Hurst exponent (dimensionless)")]
Anisotropy = Annotated[float, Field(ge=1, description="Correlation length of a map, y over x (dimensionless)")]
RmsGradient = Annotated[Size, Field(description="Root-mean-square gradient (dimensionless)")]
REDUCED_PRESSURE = (
    "Mean pressure p/(g E*) (dimensionless), g the rms gradient asked for; that of measured heights is their own, "
    "and independent surfaces add up in squares"
)
RMS_GRADIENT_TARGET = "rms gradient g asked for, in which reduced_pressure counts"
PUNCH_DISPLACEMENT = "displacement of the punch beyond first touch"
ReducedPressure = Annotated[Size, Field(description=REDUCED_PRESSURE)]
EpsC = Annotated[float, Field(gt=0, le=1, description="Continuum discretisation 2 k_s/nx (dimensionless)")]
EpsF = Annotated[float, Field(gt=0, le=1, description="Fractal discretisation k_l/k_s (dimensionless)")]
EpsT = Annotated[float, Field(gt=0, le=1, description="Thermodynamic discretisation 1/k_l (dimensionless)")]
TimeStep = Annotated[
    float,
    Field(
        ge=1e-6,
        le=1,
        json_schema_extra={
            "allowed": "a number from 1e-6 to 1, as more is above the stability limit of the stiffest mode, "
            "as a rule wave nx/2"
        },
    ),
]
Damping = Annotated[float, Field(ge=0, le=100)]
FrictionCoefficient = Annotated[
    float,
    Field(
        gt=0,
        allow_inf_nan=True,
        description="Tangential over normal traction at which a node slides; inf: it sticks where it touches",
        json_schema_extra={"allowed": "a number above 0, or .inf for sticking contact"},
    ),
]
Seed = Annotated[int, Field(ge=0, lt=2**32, description="Seed of the random surfaces")]


def broken_rule(location: tuple[str | int, ...], allowed: str) -> PydanticCustomError:
    """Error of a rule between several fields, located relative to the record that states the rule."""
    return PydanticCustomError("rule", "allowed: {allowed}", {"location": location, "allowed": allowed})
