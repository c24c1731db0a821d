"""Functions stay small: eight arguments, sixty lines. Ruff holds their complexity."""

import ast
from pathlib import Path

import pytest

import gfmd_numba

PACKAGE = Path(gfmd_numba.__file__).parent
MOST_ARGUMENTS, MOST_LINES = 8, 60


def arguments(function):
    """Number of arguments but `self` or `cls`."""
    given = function.args
    names = [each.arg for each in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
    return len(names) - (names[:1] in (["self"], ["cls"]))


def too_large(source):
    """Names of the functions with more arguments or lines than allowed, also of those within others."""
    functions = [each for each in ast.walk(ast.parse(source)) if isinstance(each, ast.FunctionDef)]
    return [
        each.name
        for each in functions
        if arguments(each) > MOST_ARGUMENTS or each.end_lineno - each.lineno >= MOST_LINES
    ]


@pytest.mark.long
def test_no_function_takes_more_than_eight_arguments_or_sixty_lines():
    found = {str(file.relative_to(PACKAGE)): too_large(file.read_text("utf-8")) for file in PACKAGE.rglob("*.py")}
    assert found.keys() > {"kernels/exponential_sums.py"}
    assert {file: names for file, names in found.items() if names} == {}


@pytest.mark.parametrize(
    ("signature", "lines", "large"),
    [
        ("self, a, b, c, d, *, e, f, g, h", 59, False),
        ("a, b, c, d, /, e, f, g, h, i", 1, True),
        ("a", 59, False),
        ("a", 60, True),
    ],
)
def test_large_functions_are_seen(signature, lines, large):
    source = f"class Outer:\n    def inner({signature}):\n" + "        pass\n" * lines
    assert too_large(source) == ["inner"] * large
