"""Hostile values of every kind, and good values altered: what users, scripts and damaged files hand to a function."""

import os
import signal
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import xarray as xr
from hypothesis import strategies as st

from support.alterations import SIZES, changed_bytes, changed_text
from support.hostile_datasets import datasets

STRANGE = [
    "absent/file.nc",
    "x" * 300,
    "",
    " ",
    "\0",
    "\x1b[2J",
    "\u202e名",
    "\ud800",
    "x" * 5000,
    "nan",
    "-1",
    "1e400",
    "=",
    ":",
    ",",
    "--",
    "{}",
    "%",
]
NUMBERS = [*SIZES, -1, 2, 2**63, 10**400, -0.5, True, 1j, np.float32(2.0), np.int8(-3), np.nan, np.inf]
ARRAYS = [
    np.zeros(0),
    np.zeros((0, 3)),
    np.array(1.0),
    np.array([1.0]),
    np.zeros(3),
    np.ones((2, 3)),
    np.zeros((2, 2, 2)),
    np.array([0.1, np.nan]),
    np.array([0.1, np.inf]),
    np.array([1j, 2.0]),
    np.array([None, 1.0]),
    np.array([{}, "a"], dtype=object),
    np.array(["a", "b"]),
    np.array(["2001-01-01"], dtype="M8[s]"),
    np.array([(1, 2.0)], dtype="i4,f8"),
    np.ma.masked_array([0.1, 0.2, 0.3], [False, True, False]),
    np.array([True, False]),
]
ODD = [
    None,
    [],
    (),
    {},
    set(),
    b"",
    b"\xff\xfe",
    object(),
    object,
    len,
    iter([0.1]),
    [None],
    [[1.0], [1.0, 2.0]],
    {"": None},
    {1: 2},
    {None: None},
    {"unknown": 1},
    Path("."),
    Path("absent"),
    Path("a\0b"),
    xr.Dataset(),
    xr.Dataset({"x": 1}),
    xr.DataArray(),
    xr.DataArray([[1.0, np.nan]], dims=("a", "b")),
]
HOSTILE = [*ODD, *STRANGE, *NUMBERS, *ARRAYS]


class LateError(BaseException):
    """A call that did not end in time."""


@contextmanager
def deadline(seconds):
    """Raise LateError in what takes longer, also where it waits for a pipe."""

    def late(*_):
        raise LateError(f"not done after {seconds} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def altered(value):
    """Strategy of hostile values in place of a good one: of another kind, or the good one with a fault in it."""
    of_kind = (
        datasets(value)
        if isinstance(value, xr.Dataset)
        else _paths(value)
        if isinstance(value, Path)
        else _mappings(value)
        if isinstance(value, dict)
        else _lists(value)
        if isinstance(value, list | tuple)
        else _arrays(value)
        if isinstance(value, np.ndarray)
        else _texts(value)
        if isinstance(value, str)
        else st.sampled_from(NUMBERS)
    )
    return st.one_of(of_kind, st.sampled_from(HOSTILE))


def calls(arguments, other=None):
    """Strategy of the arguments of a good call with one of them altered, or several, each as `other` says by name."""
    other = other or (lambda name: altered(arguments[name]))
    names = sorted(arguments)
    chosen = st.one_of(
        st.sampled_from(names).map(lambda name: [name]), st.lists(st.sampled_from(names), min_size=1, unique=True)
    )
    return chosen.flatmap(
        lambda some: st.fixed_dictionaries({name: other(name) for name in some}).map(lambda others: arguments | others)
    )


def _texts(value):
    return st.one_of(
        st.sampled_from(STRANGE),
        st.text(max_size=8),
        st.randoms(use_true_random=False).map(lambda pick: changed_text(value or "x", pick)),
    )


def _lists(value):
    at = st.integers(0, max(len(value) - 1, 0))
    return st.one_of(
        st.builds(lambda i, other: [*value[:i], other, *value[i + 1 :]], at, st.sampled_from(HOSTILE)),
        st.builds(lambda i: list(value[:i]), at),
        st.sampled_from([list(value) * 2, [list(value)], value[::-1], np.array(value, dtype=object), tuple(value)]),
    )


def _mappings(value):
    if not value:
        return st.sampled_from([{"unknown": 1}, [], ""])
    keys = st.sampled_from(sorted(value, key=str))
    return st.one_of(
        keys.flatmap(lambda key: altered(value[key]).map(lambda other: {**value, key: other})),
        keys.map(lambda key: {name: each for name, each in value.items() if name != key}),
        st.sampled_from([*STRANGE, 1, None, (), np.float64(1.0)]).map(lambda key: {**value, key: 1.0}),
        st.sampled_from([list(value), list(value.items()), str(value)]),
    )


def _arrays(value):
    flat = value.ravel()
    kinds = [complex, object, str, bool, "M8[s]", np.float32, np.int8, np.float16, np.longdouble]
    return st.one_of(
        st.sampled_from(kinds).map(
            lambda kind: value.astype(np.int64).astype(kind) if kind == "M8[s]" else value.astype(kind)
        ),
        st.sampled_from(
            [value[:0], value[..., :1], value[None], flat[: flat.size // 2], np.ma.masked_less(value, value.mean())]
        ),
        st.builds(
            lambda i, other: np.where(np.arange(flat.size).reshape(value.shape) == i, other, value),
            st.integers(0, flat.size - 1),
            st.sampled_from(SIZES),
        ),
        st.sampled_from([np.inf, 1e308, 1e-320, 0.0, np.nan]).map(lambda by: value * by),
    )


def _paths(good):
    """Paths of files made from a good file, if it is there: damaged ones, and what is no file."""
    folder = good / "hostile" if good.is_dir() else good.parent / "hostile"
    folder.mkdir(exist_ok=True, parents=True)
    content = good.read_bytes() if good.is_file() else b""
    return st.one_of(
        st.sampled_from(sorted(_NO_FILES)).map(lambda kind: _made(folder, good.suffix, content, kind)),
        st.randoms(use_true_random=False).map(lambda pick: _damaged(folder, good.suffix, content, pick)),
    )


_NO_FILES = {
    "absent": lambda path, content: None,
    "empty": lambda path, content: path.write_bytes(b""),
    "half": lambda path, content: path.write_bytes(content[: len(content) // 2]),
    "binary": lambda path, content: path.write_bytes(bytes(range(256))),
    "folder": lambda path, content: path.mkdir(),
    "pipe": lambda path, content: os.mkfifo(path),
    "loop": lambda path, content: path.symlink_to(path),
    "unreadable": lambda path, content: (path.write_bytes(content), path.chmod(0)),
}


def _made(folder, suffix, content, kind):
    path = folder / f"{kind}{suffix}"
    if not os.path.lexists(path):
        _NO_FILES[kind](path, content)
    return path


def _damaged(folder, suffix, content, pick):
    path = folder / f"damaged{suffix}"
    if suffix == ".yaml":
        path.write_text(changed_text(content.decode(), pick), encoding="utf-8", errors="surrogateescape")
    else:
        path.write_bytes(changed_bytes(content, pick))
    return path
