"""One realisation of a campaign compared with the contact that `solve` finds alone."""

import numpy as np

import gfmd_numba

_OF_WHOLE_PATH = ("status", "residual", "n_iterations", "n_transforms")


def assert_as_solved(found, case, realisation, scene, more, seed=4):
    """Assert that a realisation has exactly the numbers of `solve`, under the same names and in the same units."""
    drawn = {} if seed is None else {"realisation": realisation, "seed": seed}
    single = gfmd_numba.solve({"scene": scene} | drawn | more)
    ours = found.isel(case=case, realisation=realisation)
    recorded = {name for name in ours.data_vars if name not in ("wall_time", "case_seconds")}
    assert {"kappa", "contact_area_fraction"} <= recorded
    assert ("next_order" in recorded) == ("next_order" in single)
    for name in recorded:
        theirs = single[name]
        if name in _OF_WHOLE_PATH and "step" in theirs.dims:
            continue
        theirs = theirs.isel(step=0) if ours[name].ndim < theirs.ndim else theirs
        rounding = 4e-16 if name == "next_order" else 0.0  # it is stored in units of g L_x
        assert np.allclose(ours[name], theirs, rtol=rounding, atol=0.0, equal_nan=True), name
        assert ours[name].attrs["units"] == theirs.attrs["units"]
        assert ours[name].attrs["long_name"] == theirs.attrs["long_name"]
    assert np.array_equal(ours["rms_gradient_target"], single["rms_gradient_target"])
