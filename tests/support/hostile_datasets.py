"""Datasets altered as users, scripts and damaged files alter them: variables, dims, coordinates and attributes."""

import numpy as np
import xarray as xr
from hypothesis import strategies as st

# what befalls a variable of a dataset, a coordinate too: its name, the dataset and another name to the dataset without
_OF_A_VARIABLE = {
    "lost": lambda data, name, other: data.drop_vars(name),
    "renamed": lambda data, name, other: data.rename({name: "renamed"}),
    "of another name": lambda data, name, other: data.drop_vars(name).assign({name: data[other].variable}),
    "not a number": lambda data, name, other: _with(data, name, lambda values: np.full(values.shape, np.nan)),
    "one not a number": lambda data, name, other: _with(data, name, lambda values: _one(values, np.nan)),
    "one infinite": lambda data, name, other: _with(data, name, lambda values: _one(values, np.inf)),
    "one huge": lambda data, name, other: _with(data, name, lambda values: _one(values, 1e308)),
    "zero": lambda data, name, other: _with(data, name, lambda values: np.zeros(values.shape)),
    "negative": lambda data, name, other: _with(data, name, lambda values: -1.0 - np.zeros(values.shape)),
    "huge": lambda data, name, other: _with(data, name, lambda values: np.full(values.shape, 1e308)),
    "tiny": lambda data, name, other: _with(data, name, lambda values: np.full(values.shape, 5e-324)),
    "complex": lambda data, name, other: _with(data, name, lambda values: np.full(values.shape, 1.0 + 1j)),
    "text": lambda data, name, other: _with(data, name, lambda values: values.astype(str)),
    "other text": lambda data, name, other: _with(data, name, lambda values: np.full(values.shape, "\x1b[2J$_")),
    "objects": lambda data, name, other: _with(data, name, lambda values: np.full(values.shape, None)),
    "dates": lambda data, name, other: _with(data, name, lambda values: np.zeros(values.shape, "M8[s]")),
    "flags": lambda data, name, other: _with(data, name, lambda values: np.ones(values.shape, bool)),
    "single": lambda data, name, other: _with(data, name, lambda values: _numbers(values).astype(np.float32)),
    "small whole": lambda data, name, other: _with(data, name, lambda values: np.full(values.shape, 3, np.int8)),
    "reversed": lambda data, name, other: _with(data, name, lambda values: values.ravel()[::-1].reshape(values.shape)),
    "transposed": lambda data, name, other: data.assign({name: data[name].variable.transpose()}),
    "its last value": lambda data, name, other: data.drop_vars(name).assign(
        {name: data[name].variable[(-1,) * data[name].ndim]}
    ),
    "its first row": lambda data, name, other: data.drop_vars(name).assign(
        {name: data[name].variable[(0,) * (data[name].ndim > 0)]}
    ),
    "another dim": lambda data, name, other: data.drop_vars(name).assign(
        {name: data[name].variable.expand_dims({"more": 2})}
    ),
    "without attributes": lambda data, name, other: data.assign({name: data[name].drop_attrs()}),
    "a coordinate": lambda data, name, other: data.set_coords(name),
    "no coordinate": lambda data, name, other: data.reset_coords(name, drop=False),
}
_OF_A_DATASET = {
    "without attributes": lambda data: data.drop_attrs(deep=False),
    "without any attributes": lambda data: data.drop_attrs(),
    "without coordinates": lambda data: data.drop_vars(list(data.coords)),
    "without data": lambda data: data.drop_vars(list(data.data_vars)),
    "of objects": lambda data: data.astype(object),
    "in single precision": lambda data: data.map(
        lambda each: each.astype(np.float32) if each.dtype.kind == "f" else each
    ),
    "named otherwise": lambda data: data.rename({name: f"{name}_" for name in data.dims}),
}
_OF_A_DIM = {
    "empty": lambda data, dim: data.isel({dim: slice(0)}),
    "one": lambda data, dim: data.isel({dim: slice(1)}),
    "gone": lambda data, dim: data.isel({dim: 0}, drop=True),
    "reduced": lambda data, dim: data.isel({dim: -1}),
    "thinned": lambda data, dim: data.isel({dim: slice(None, None, 2)}),
    "reversed": lambda data, dim: data.isel({dim: slice(None, None, -1)}),
    "twice": lambda data, dim: xr.concat([data, data], dim, data_vars="minimal", coords="minimal", compat="override"),
    "renamed": lambda data, dim: data.rename({dim: "renamed"}),
}
_ATTRIBUTES = [
    None,
    "",
    "1",
    "nonsense",
    "m",
    "{}",
    "[]",
    "\x1b$_{",
    -1,
    0.5,
    np.nan,
    10**12,
    np.zeros(3),
    [1, "a"],
    b"\xff",
]


def _numbers(values):
    return values if values.dtype.kind in "fiub" else np.zeros(values.shape)


def _one(values, other):
    changed = _numbers(values).astype(float)
    changed.reshape(-1)[: 1 if changed.size else 0] = other
    return changed


def _with(data, name, function):
    variable = data[name].variable
    return (
        data.drop_vars(name).assign({name: (variable.dims, function(variable.values), variable.attrs)})
        if name in data.data_vars
        else data.drop_vars(name).assign_coords({name: (variable.dims, function(variable.values), variable.attrs)})
    )


def _tried(change, data, *names):
    """Change of a dataset that xarray allows; the same dataset where it does not."""
    try:
        return change(data, *names)
    except (ValueError, TypeError, KeyError, IndexError, AttributeError, Warning):
        return data


def datasets(data):
    """Datasets with one fault, or two."""
    return _faulty(data).flatmap(lambda once: st.one_of(st.just(once), _faulty(once)) if once.dims else st.just(once))


def _faulty(data):
    names = sorted(map(str, data.variables))
    attributes = [(None, key) for key in data.attrs] + [(name, key) for name in names for key in data[name].attrs]
    kinds = [
        st.builds(
            lambda kind, name, other: _tried(_OF_A_VARIABLE[kind], data, name, other),
            st.sampled_from(sorted(_OF_A_VARIABLE)),
            st.sampled_from(names),
            st.sampled_from(names),
        ),
        st.sampled_from(sorted(_OF_A_DATASET)).map(lambda kind: _tried(_OF_A_DATASET[kind], data)),
        st.builds(
            lambda kind, dim: _tried(_OF_A_DIM[kind], data, dim),
            st.sampled_from(sorted(_OF_A_DIM)),
            st.sampled_from(sorted(map(str, data.dims))),
        ),
        st.builds(
            lambda place, other: _with_attribute(data, *place, other),
            st.sampled_from(attributes),
            st.sampled_from(_ATTRIBUTES),
        ),
    ]
    kinds = kinds if attributes else kinds[:-1]
    return st.one_of(kinds[0], *kinds)


def _with_attribute(data, name, key, other):
    changed = data.copy()
    attributes = changed.attrs if name is None else changed[name].attrs
    if other is None:
        del attributes[key]
    else:
        attributes[key] = other
    return changed
