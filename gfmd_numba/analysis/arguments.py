"""The door of this room: what its public functions are given is checked against the types that they name."""

import inspect
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, wraps
from typing import Annotated, Any, Literal, ParamSpec, TypeVar, cast, get_args, get_type_hints

import numpy as np
import xarray as xr
from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, TypeAdapter, ValidationError

from gfmd_numba.text.input_error import InputError, brief

Given = ParamSpec("Given")
Result = TypeVar("Result")

_STEEPEST = 100  # exponent: beyond, powers of eps underflow

_STRICT = ConfigDict(strict=True, allow_inf_nan=False)


@dataclass(frozen=True, eq=False)
class Kind:
    """What values of an argument are allowed: a strict type, and the same in words."""

    type: Any
    allowed: str

    def checked(self, given: object, argument: str) -> Any:
        """Return a value of this type; InputError for any other."""
        try:
            return TypeAdapter(self.type, config=_STRICT).validate_python(given)
        except ValidationError:
            raise InputError.of(argument, brief(given), self.allowed) from None


def _row(value: object) -> object:
    """Return rows of numbers, NumPy's and xarray's too, as tuples."""
    if isinstance(value, xr.DataArray):
        value = value.values
    if isinstance(value, np.ndarray) and not np.ma.isMaskedArray(value):
        value = value.tolist()
    return tuple(value) if isinstance(value, list) else value


def _rising(ends: tuple[float, float]) -> tuple[float, float]:
    if ends[0] > ends[1]:
        raise ValueError("falls")
    return ends


_Limit = Literal["eps_c", "eps_f", "eps_t"]
_Exponent = Annotated[float, Field(gt=0, le=_STEEPEST)]
_Range = Annotated[tuple[_Exponent, _Exponent], BeforeValidator(_row), AfterValidator(_rising)]
_NAMES = "'eps_c', 'eps_f' or 'eps_t'"
_FIXED = (
    f"a mapping of {_NAMES} to exponents above 0 and up to {_STEEPEST}, or to ranges of them as (low, high), like "
    "{'eps_c': 1.0, 'eps_f': (0.5, 1.0)}"
)

Limit = Annotated[str, Kind(_Limit, _NAMES)]
Variable = Annotated[str, Kind(str, "the name of a variable of the dataset, like 'kappa'")]
Exponents = Annotated[Literal["shared", "free"], Kind(Literal["shared", "free"], "'shared' or 'free'")]
Fixed = Annotated[Mapping[str, float | Sequence[float]], Kind(Mapping[_Limit, _Exponent | _Range], _FIXED)]
Flag = Annotated[bool, Kind(bool, "True or False")]
_TARGETS = Kind(
    Annotated[dict[str, Annotated[float, Field(gt=0, lt=1)]], Field(min_length=1)],
    'a JSON text of relative errors above 0 and below 1, like {"kappa": 0.01}',
)


def targets_of(dataset: xr.Dataset) -> dict[str, float]:
    """Return the relative errors that a campaign is to reach, by variable; none without any. Raises InputError."""
    given = dataset.attrs.get("target", {})
    if given == {}:
        return {}
    try:
        found = json.loads(given)
    except (TypeError, ValueError):
        found = given
    return dict(_TARGETS.checked(found, "the attribute target"))


def checked(function: Callable[Given, Result]) -> Callable[Given, Result]:
    """Make a function check what it is given by the annotations of its arguments; they raise InputError."""
    signature = inspect.signature(function)

    @cache
    def checks() -> dict[str, Callable[[object, str], Any]]:
        hints = get_type_hints(function, include_extras=True)
        return {name: found for name, kind in hints.items() if (found := _check_of(kind)) is not None}

    @wraps(function)
    def call(*args: Given.args, **kwargs: Given.kwargs) -> Result:
        bound = signature.bind(*args, **kwargs)
        for name, check in checks().items():
            if name in bound.arguments:
                bound.arguments[name] = check(bound.arguments[name], name)
        return function(*bound.args, **bound.kwargs)

    return call


def _check_of(kind: Any) -> Callable[[object, str], Any] | None:
    for each in getattr(kind, "__metadata__", ()):
        if hasattr(each, "checked"):  # a `Kind`, or a `DatasetForm`
            return cast(Callable[[object, str], Any], each.checked)
    if type(None) in get_args(kind) and (check := _check_of(get_args(kind)[0])) is not None:
        return lambda given, name: None if given is None else check(given, name)
    return None
