"""What all records share: their configuration, the quantities that return and the error of a broken rule."""

from collections.abc import Callable
from inspect import signature
from math import inf
from typing import Annotated, Any, Literal, cast

from pydantic import (
    AfterValidator,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    PlainValidator,
    ValidationInfo,
    WithJsonSchema,
)
from pydantic_core import PydanticCustomError

from gfmd_numba.scene.units import (
    ENERGY_PER_AREA,
    FORCE,
    FORCE_PER_LENGTH,
    LENGTH,
    PRESSURE,
    SPEED,
    TIME,
    WEAR_RATE,
    given_with_units,
)

RECORD = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False, ser_json_inf_nan="constants")

SMALLEST, LARGEST = 1e-30, 1e30  # whatever a user gives: all products of a scene, and their squares, stay finite
Size = Annotated[float, Field(ge=SMALLEST, le=LARGEST)]
Signed = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
Length = Annotated[Size, LENGTH, Field(description="Length in m, or in L_x without a length")]
SignedLength = Annotated[Signed, LENGTH]
Pressure = Annotated[Size, PRESSURE]
NonnegativePressure = Annotated[float, Field(ge=0, le=LARGEST), PRESSURE]
_WORK = Field(description="Energy per area in J/m^2 (E* L_x without moduli and length)")
WorkOfAdhesion = Annotated[Size, ENERGY_PER_AREA, _WORK]
SignedWorkOfAdhesion = Annotated[Signed, ENERGY_PER_AREA, _WORK]
LineLoad = Annotated[Size, FORCE_PER_LENGTH]
Force = Annotated[Size, FORCE]
Duration = Annotated[Size, TIME]
Speed = Annotated[Size, SPEED]
WearRate = Annotated[Size, WEAR_RATE]
REDUCED_PRESSURE = (
    "Mean pressure p/(g E*) (dimensionless); g is the rms gradient asked for, or that of measured heights, "
    "and the squares of several surfaces add up"
)
RMS_GRADIENT_TARGET = "rms gradient g asked for, in which reduced_pressure counts"
PUNCH_DISPLACEMENT = "displacement of the punch beyond first touch"
MEAN_PRESSURE = "Mean pressure in Pa; needs moduli"
LINE_LOAD = "Force per length in N/m on one period of a profile; needs moduli and a length"
FORCE_ON_A_MAP = "Force in N on one period of a map; needs moduli and a length"
FILES = (".npy", ".csv")
SEED = "a whole number at least 0 and below 4294967296"


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

FileOfNodes = Annotated[
    str,
    Field(
        pattern="|".join(rf"\{suffix}$" for suffix in FILES),
        json_schema_extra={"allowed": "the name of a .npy or .csv file with one value for each node"},
    ),
]
_FUNCTION = "in Python a function of three arrays: gaps, pressures and slip rates; in a file a limit or slip_rates"


def _function(given: object, info: ValidationInfo) -> object:
    if isinstance(given, str) and info.mode == "json":  # its name, where a scene was recorded
        return given
    try:
        signature(cast(Any, given)).bind(0.0, 0.0, 0.0)
    except TypeError:  # no function, or one of other arguments
        raise ValueError(_FUNCTION) from None
    except ValueError:  # it does not say what it takes
        pass
    return given


FunctionOfNodes = Annotated[
    Callable[..., Any],
    PlainValidator(_function),
    PlainSerializer(lambda function: getattr(function, "__qualname__", type(function).__name__), when_used="json"),
    WithJsonSchema({"allowed": _FUNCTION}),
]
Points = Annotated[int, Field(ge=4, le=2**40)]
Seed = Annotated[int, Field(ge=0, lt=2**32, description="Seed of the random surfaces")]


def broken_rule(location: tuple[str | int, ...], allowed: str) -> PydanticCustomError:
    """Error of a rule between several fields, located relative to the record that states the rule."""
    return PydanticCustomError("rule", "gfmd allows {allowed}", {"location": location, "allowed": allowed})


def check_seed(seed: int, realisation: int, is_random: bool) -> None:
    """Raise a located error for a seed, or a realisation, that chooses nothing: 0 stands for none."""
    for name, given in (("seed", seed), ("realisation", realisation)):
        if given != 0 and not is_random:
            raise broken_rule((name,), "nothing, as no surface of this file is random")


def check_scales(record: object, length: float | None, has_moduli: bool, at: tuple[str | int, ...] = ()) -> None:
    """Raise a located error for a number with a unit that has no length, or no moduli, to be compared with."""
    for place, value in given_with_units(record, at):
        missing = ["length"] if value.quantity.length and length is None else []
        missing += ["youngs_modulus"] if value.quantity.modulus and not has_moduli else []
        if missing:
            allowed = f"a number without a unit, as there is no {' and no '.join(missing)}"
            raise broken_rule(place, f"{allowed}; to use units, give {' and '.join(missing)}")
