"""What friction takes of a path, from the fields that `gfmd solve` leaves, without any energy."""

import numpy as np


def slipping_losses(path, friction, wall=None):
    """Energy per area that the nodes of a path of a profile lose in each step but the first `[step]`.

    A slipping node begins under its traction of before, or under the friction of the smaller pressure of the `wall`,
    and ends under its traction of now.
    """
    slip = (path.get("sliding", 0.0) - path["tangential_displacement"]).transpose("step", "x").values
    pressure = (path["pressure"] if wall is None else wall).values
    traction = path["tangential_traction"].values
    taken = []
    for i in range(1, len(slip)):
        moved = slip[i] - slip[i - 1]
        work = 0.0
        for j in np.flatnonzero(pressure[i - 1 : i + 1].max(axis=0) > 0.0):
            way, forward = abs(moved[j]), np.sign(moved[j])
            begins, ends = traction[i - 1, j] * forward, traction[i, j] * forward
            if abs(ends) >= 0.999 * friction * pressure[i, j]:  # else it sticks, and its way is rounding
                begins = max(begins, friction * min(pressure[i - 1, j], pressure[i, j]))
            work += 0.5 * (begins + ends) * way
        taken.append(work / slip.shape[1])
    return np.array(taken)
