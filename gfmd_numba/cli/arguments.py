"""Arguments and options that commands share, and their checks."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from math import inf
from pathlib import Path
from typing import Any

import click

from gfmd_numba.text.input_error import InputError

Fixed = tuple[str, float | tuple[float, float]]

_ARGUMENT = re.compile(r"^\w+(?=(\[\d+\])?: you gave )")

NEW_FILE = click.Path(dir_okay=False, path_type=Path)
file_argument = click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
output_option = click.option("-o", "--output", required=True, type=NEW_FILE, help="netCDF file to write")
json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON, for programs")
threads_option = click.option(
    "--threads",
    type=click.IntRange(1),
    help="Threads that share the work on a map, at most one for each core; without it, what the file says, or 1",
)
results_argument = click.argument("results", type=click.Path(exists=True, path_type=Path))
OF_PATHS = ("hysteresis", "pull_off_pressure")
LIMITS = {"eps_c": "continuum", "eps_f": "fractal", "eps_t": "thermodynamic"}


def workers_option(what: str) -> Callable[[Any], Any]:
    """Return the option that gives a number of local workers, and says what they do."""
    return click.option("--workers", default=2, show_default=True, type=click.IntRange(0), help=what)


def is_given(option: str) -> bool:
    """Return whether the command line has an option, by the name of its argument."""
    source = click.get_current_context().get_parameter_source(option)
    return source is click.core.ParameterSource.COMMANDLINE


@contextmanager
def told_as(names: Mapping[str, str]) -> Iterator[None]:
    """Name options and files of a command in errors that begin with the name of an argument of a Python function."""
    try:
        yield
    except InputError as error:
        lines = (_ARGUMENT.sub(lambda found: names.get(found[0], found[0]), str(line)) for line in error.args)
        raise InputError(*lines, more=error.more) from None


def not_allowed(given: object, allowed: str) -> click.BadParameter:
    """Return the error about what an option was given, and what is allowed there."""
    return click.BadParameter(f"you gave {given}; gfmd allows {allowed}")


def _variable_given(ctx: click.Context, param: click.Parameter, name: str | None) -> str | None:
    """Return the name of a quantity that has a limit."""
    if name is None:
        return None
    from gfmd_numba.contact.observables import LIMITED, why_no_limit

    if name not in LIMITED:
        allowed = f"one of {', '.join(map(repr, LIMITED))}"
        raise not_allowed(repr(name), "; ".join(filter(None, (allowed, why_no_limit(name)))))
    return name


variable_option = click.option(
    "--variable",
    callback=_variable_given,
    metavar="NAME",
    help="Quantity to extrapolate, like kappa, kappa_r or mean_gap  [that of the campaign]",
)
exponents_option = click.option(
    "--exponents",
    type=click.Choice(["shared", "free"]),
    help="Share exponents among all groups of cases, or fit those of each group [as in the campaign]",
)


def _exponent(option: str) -> Fixed:
    """Return an exponent of the fit as `eps_c=1` or `eps_c=0.5:1` give it."""
    from gfmd_numba.scene.document import plain_scalar

    name, _, given = option.partition("=")
    ends: list[Any] = [plain_scalar(end) for end in given.split(":")]
    numbers = len(ends) <= 2 and all(type(end) in (int, float) for end in ends)
    if name not in LIMITS or not numbers or not 0 < ends[0] <= ends[-1] < inf:
        allowed = f"{', '.join(LIMITS)} with a number above 0 or a range, like eps_t=1 or eps_f=0.5:1"
        raise not_allowed(repr(option), allowed)
    return name, float(ends[0]) if len(ends) == 1 else (float(ends[0]), float(ends[1]))


fixed_option = click.option(
    "--fixed",
    multiple=True,
    callback=lambda ctx, param, options: tuple(map(_exponent, options)),
    metavar="EPS=X[:Y]",
    help="Fix an exponent, or give the range it lies in",
)


def _conditions_given(ctx: click.Context, param: click.Parameter, options: tuple[str, ...]) -> Any:
    """Return the conditions on cases as `hurst=0.8` gives them."""
    pairs = [option.partition("=") for option in options]
    for option, (name, _, value) in zip(options, pairs, strict=True):
        if not name or not value:
            raise not_allowed(repr(option), "a coordinate and its value, like hurst=0.8")
        if sum(name == other for other, _, _ in pairs) > 1:
            raise not_allowed(f"{option!r} and another value of {name}", "one value of each name")
    return tuple((name, value) for name, _, value in pairs)


conditions_option = click.option(
    "--only",
    multiple=True,
    callback=_conditions_given,
    metavar="NAME=VALUE",
    help="Run only cases with this value, like pressure=50MPa",
)


def _targets_given(ctx: click.Context, param: click.Parameter, options: tuple[str, ...]) -> dict[str, str]:
    """Return errors by variable, given as `kappa=2%`; an error without a name is of what the campaign fits."""
    targets: dict[str, str] = {}
    for option in options:
        name, _, error = option.rpartition("=")
        if name in targets or (options[1:] and not name):
            allowed = "several targets of different variables, each with its name, like kappa=2%"
            raise not_allowed(f"{option!r} and {options[0]!r}", allowed)
        targets[name] = error
    return targets


def targets_option(name: str, what: str) -> Callable[[Any], Any]:
    """Return the option that gives errors by variable, and says what they are for."""
    return click.option(name, multiple=True, callback=_targets_given, metavar="kappa=X%", help=what)


budget_option = click.option("--budget", metavar="TIME", help="Processor time that the rounds may take, like 20min")
