"""Results of one contact that somebody altered: what is made from them is made, or they are refused with a reason."""

import random
from functools import cache

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.analysis import UnusableDataError
from gfmd_numba.scene import InputError
from support.alterations import SIZES, changed_text

_PSD = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}
_BODY = {"poissons_ratio": 0.3, "aspect_ratio": 0.5}
_REST = {"interface": {"hard_wall": {}}, "discretisation": {"eps_c": 0.5, "eps_f": 0.125, "eps_t": 1}}
_PRESSED = {"loading": {"reduced_pressure": 0.1}, **_REST}
_DISPLACED = {"loading": {"displacement": 1e-4}, "path": [{"displacement": 2e-4}], **_REST}
SCENES = [
    {"body": _BODY, "roughness": _PSD, **_PRESSED},
    {"body": _BODY, "roughness": _PSD, **_DISPLACED},
    {"body": {**_BODY, "roughness": _PSD}, **_PRESSED},
    {"body": _BODY, "roughness": _PSD, "dimension": 2, **_PRESSED},
    {"scene": {"body": _BODY, "boundary": {"normal_traction": 0.1}}, "points": 16},
]
FUNCTIONS = (
    gfmd_numba.body_fields,
    gfmd_numba.contact_statistics,
    gfmd_numba.gap_percolation,
    gfmd_numba.leakage,
    gfmd_numba.contact_conductance,
)


@cache
def solved(which):
    return gfmd_numba.solve(SCENES[which])


def altered(seed):
    """Results with one or two variables or attributes lost, renamed, cut or filled with something else."""
    pick = random.Random(seed)
    dataset = solved(pick.randrange(len(SCENES))).copy(deep=True)
    for _ in range(pick.choice([1, 1, 2])):
        name, kind = pick.choice(list(dataset.variables)), pick.randrange(8)
        if kind == 0:
            dataset = dataset.drop_vars(name)
        elif kind == 1 and dataset[name].dims and dataset[name].dtype.kind == "f":
            values = dataset[name].values.copy()
            values.flat[pick.randrange(values.size)] = pick.choice(SIZES)
            dataset[name] = (dataset[name].dims, values, dataset[name].attrs)
        elif kind == 2:
            dataset[name].attrs = {}
        elif kind == 3:
            dataset.attrs["scene"] = changed_text(dataset.attrs.get("scene", "{}"), pick)
        elif kind == 4 and name not in dataset.indexes:
            dataset[name] = (dataset[name].dims, np.full(dataset[name].shape, "x"))
        elif kind == 5:
            dataset = dataset.isel({next(iter(dataset.dims)): pick.choice([0, slice(0, 0), slice(0, 1), slice(0, 7)])})
            break
        elif kind == 6:
            dataset = dataset.rename({name: "other"})
            break
        else:
            dataset.attrs.pop("scene", None)
    return dataset


@pytest.mark.filterwarnings("ignore")  # arithmetic with extreme numbers
@pytest.mark.parametrize("seed", [*range(60), 74, 102, 252, 269, 351, 1072])
def test_altered_results_are_used_or_refused_with_a_reason(seed):
    dataset = altered(seed)
    for function in FUNCTIONS:
        try:
            function(dataset)
        except (InputError, UnusableDataError) as error:
            assert "given" in str(error)  # noqa: PT017
