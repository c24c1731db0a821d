"""What all records share: their configuration, the quantities that return and the error of a broken rule."""

from typing import Annotated

from pydantic import ConfigDict, Field
from pydantic_core import PydanticCustomError

SMALLEST, LARGEST = 1e-30, 1e30  # of what a user gives: squares and products of all of it stay numbers
RECORD = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False, ser_json_inf_nan="constants")

PoissonsRatio = Annotated[float, Field(gt=-1, le=0.5, description="Poisson's ratio (dimensionless)")]
AspectRatio = Annotated[
    float,
    Field(
        ge=1e-12,  # far below, stiffnesses grow beyond the range of numbers
        allow_inf_nan=True,
        description="Thickness over period, z_m/L_x (dimensionless); inf: a half-space",
        json_schema_extra={"allowed": "at least 1e-12, or .inf for a half-space"},
    ),
]
Hurst = Annotated[float, Field(ge=0, le=1, description="Hurst exponent (dimensionless)")]
Anisotropy = Annotated[float, Field(ge=1, description="Correlation length of a map, y over x (dimensionless)")]
RmsGradient = Annotated[float, Field(gt=0, description="Root-mean-square gradient (dimensionless)")]
REDUCED_PRESSURE = (
    "Mean pressure p/(g E*) (dimensionless), g the rms gradient asked for; that of measured heights is their own, "
    "and independent surfaces add up in squares"
)
ReducedPressure = Annotated[float, Field(gt=0, description=REDUCED_PRESSURE)]
EpsC = Annotated[float, Field(gt=0, le=1, description="Continuum discretisation 2 k_s/nx (dimensionless)")]
EpsF = Annotated[float, Field(gt=0, le=1, description="Fractal discretisation k_l/k_s (dimensionless)")]
EpsT = Annotated[float, Field(gt=0, le=1, description="Thermodynamic discretisation 1/k_l (dimensionless)")]
Seed = Annotated[int, Field(ge=0, lt=2**32, description="Seed of the random surfaces")]


def broken_rule(location: tuple[str | int, ...], allowed: str) -> PydanticCustomError:
    """Error of a rule between several fields, located relative to the record that states the rule."""
    return PydanticCustomError("rule", "allowed: {allowed}", {"location": location, "allowed": allowed})
