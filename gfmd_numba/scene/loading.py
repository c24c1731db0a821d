"""Records of the loading: what is prescribed, at first and after each step of a path."""

from typing import Any, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationInfo, field_validator, model_validator
from pydantic_core import PydanticCustomError

from gfmd_numba.scene.quantities import (
    FORCE_ON_A_MAP,
    LINE_LOAD,
    MEAN_PRESSURE,
    RECORD,
    REDUCED_PRESSURE,
    Duration,
    Force,
    LineLoad,
    Pressure,
    ReducedPressure,
    SignedLength,
    Speed,
    broken_rule,
)
from gfmd_numba.scene.units import quantities, respelt

LOADS = ("reduced_pressure", "pressure", "line_load", "force")
CONTROLS = (*LOADS, "displacement")
ONE_LOAD = f"exactly one of {', '.join(CONTROLS[:-1])} and {CONTROLS[-1]}"
_NEEDED = {"pressure": ("youngs_modulus",)} | dict.fromkeys(("line_load", "force"), ("youngs_modulus", "length"))


class Controls(BaseModel):
    """What may be prescribed: a load in one of four ways, or the displacement of the punch."""

    model_config = RECORD
    reduced_pressure: ReducedPressure | None = Field(None, description=REDUCED_PRESSURE)
    pressure: Pressure | None = Field(None, description=MEAN_PRESSURE)
    line_load: LineLoad | None = Field(None, description=LINE_LOAD)
    force: Force | None = Field(None, description=FORCE_ON_A_MAP)
    displacement: SignedLength | None = Field(
        None, description="Punch displacement beyond first touch, in m if the scene has a length, else in L_x"
    )
    duration: Duration | None = Field(
        None, description="Time in s over which the load changes evenly, from no load at first; None: at once"
    )
    speed: Speed | None = Field(
        None,
        description="Speed of the punch along x in m/s (L_x/s without a length), at which it has slid over a "
        "viscoelastic body for ever; None: it does not slide",
    )

    @field_validator(*LOADS, mode="before")
    @classmethod
    def _presses(cls, given: Any, info: ValidationInfo) -> Any:
        quantity = quantities(cls).get(info.field_name or "")
        value = given if quantity is None else quantity.read(given)
        if isinstance(value, (int, float)) and not isinstance(value, bool) and value <= 0.0:
            raise broken_rule((), "a load above 0; for no load, or a pull, prescribe a displacement")
        return given


class Loading(Controls):
    """One of four loads, or the displacement of the punch; none without a punch."""

    model_config = ConfigDict(
        **RECORD, json_schema_extra={"allowed": "a mapping like {pressure: 10 MPa}, of the first load if others follow"}
    )

    @property
    def control(self) -> str:
        """Name of what is prescribed, nothing without a punch."""
        return next((name for name in CONTROLS if getattr(self, name) is not None), "")

    @model_validator(mode="after")
    def _one_control(self) -> Self:
        if sum(getattr(self, name) is not None for name in CONTROLS) > 1:
            raise broken_rule((), ONE_LOAD)
        return self


def control_of(load: str) -> tuple[str, str]:
    """Name of the load that a number with a unit is, as `50 MPa` is a pressure; else nothing, and what may be meant."""
    meant = respelt(load)
    for name, quantity in quantities(Loading).items():
        try:
            if name in CONTROLS and quantity.si_value(load) is not None:
                return name, ""
        except PydanticCustomError as error:  # a unit of another quantity
            meant = meant or str((error.context or {})["suggestion"])
    return "", meant


class Step(Controls):
    """A change of the loading; what is left out stays as it is, and a step without duration happens at once."""

    sliding: SignedLength | None = Field(
        None,
        description="Tangential displacement of the punch since first touch, in m, or in L_x without a length; along x",
    )
    sliding_y: SignedLength | None = Field(None, description="The same along y, of maps")

    def check(self, loading: Loading, i: int) -> None:
        """Raise a located error if this step `i` of a path changes what the loading does not prescribe."""
        for name in CONTROLS:
            if name != loading.control and getattr(self, name) is not None:
                raise broken_rule(("path", i, name), f"what the loading prescribes, which is {loading.control}")
        if self.speed is not None and loading.speed is None:
            raise broken_rule(("path", i, "speed"), "a speed where the loading has one")


def check_loading(loading: Loading, length: float | None, has_moduli: bool, is_rough: bool) -> None:
    """Raise an error, located in the scene, for a load in N or Pa without moduli, or without a length it needs."""
    control = loading.control
    there = {"youngs_modulus": has_moduli, "length": length is not None}
    missing = [name for name in _NEEDED.get(control, ()) if not there[name]]
    if missing:
        words = {"youngs_modulus": "a youngs_modulus of every elastic body", "length": "the length of the period"}
        needed = " and ".join(words[name] for name in missing)
        other = ", or a reduced_pressure" if is_rough else ""  # which counts in the rms gradient of a roughness
        raise broken_rule(("loading", control), f"{control} with {needed}{other}")
