"""The examples in the docstrings of the public functions give what they print, one after the other."""

import doctest
import inspect

import pytest

import gfmd_numba


@pytest.mark.long
def test_every_public_function_has_an_example_that_gives_what_it_prints(undrawn, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    functions = [getattr(gfmd_numba, name) for name in gfmd_numba.__all__]
    functions = [each for each in functions if inspect.isfunction(each)]
    known = {"gfmd_numba": gfmd_numba}
    parser, runner = doctest.DocTestParser(), doctest.DocTestRunner()
    for function in sorted(functions, key=lambda each: inspect.getsourcelines(each)[1]):
        example = parser.get_doctest(inspect.getdoc(function), known, function.__name__, None, 0)
        assert example.examples, f"{function.__name__} has no example"
        runner.run(example, clear_globs=False)
        known = example.globs
    assert runner.summarize(verbose=False).failed == 0, capsys.readouterr().out
