"""The conditions of Signorini and Coulomb, node by node, by NumPy's transforms: independent of solvers and kernels."""

import numpy as np


def tractions(stiffness, tangential, normal, load=None):
    """Tangential traction and pressure that two displacements `[x]` call up; the load is None where K33(0) counts."""
    n = len(normal)
    k33 = stiffness.normal.copy()
    if load is not None or np.isinf(k33[0]):
        k33[0] = 0.0
    c1, c3 = np.fft.rfft(tangential), np.fft.rfft(normal)
    shear = np.fft.irfft(stiffness.elements[0] * c1 + 1j * stiffness.elements[1] * c3, n)
    restoring = np.fft.irfft(k33 * c3 - 1j * stiffness.elements[1] * c1, n)
    return shear, (load or 0.0) - restoring


def largest_violation(stiffness, punch, load, friction, result, start=None, row=0, law=None):
    """Largest violation of any condition in one row: of lengths over the height of the punch, else over the pressure.

    With a law of the gap over the largest traction. Under an infinite friction nodes may have touched down anywhere.

    `start` is what the step began with: nodes slip by their way from where they were then, moved with the punch.
    """
    punch, u1, u3 = punch[row], result.tangential.displacement[row, 0], result.displacement[row]
    shear, pressure = tractions(stiffness, u1, u3, load)
    pull = 0.0 * punch if law is None else law.work / law.length * np.exp((u3 - punch) / law.length)
    pressure = pressure + pull
    volume = 0.0
    if load is None and np.isinf(stiffness.normal[0]):
        pressure = pressure + result.pressure[row].mean()
        volume = abs(u3.mean()) / np.ptp(punch)
    gap = punch - u3
    touching = gap <= 0.0
    slid = u1 - (0.0 if start is None else (start.tangential + start.dragged)[row, 0])  # exactly 0 where it sticks
    peak = max((result.pressure[row] + pull)[touching].max(initial=0.0), abs(pull).max())
    bound = np.multiply(friction, pressure, out=np.zeros_like(pressure), where=touching & (pressure > 0.0))
    slips = touching & (slid != 0.0) & (bound < np.inf)
    violations = [
        abs(pressure[~touching]).max(initial=0.0),
        -pressure[touching].min(initial=0.0),
        (abs(shear) - bound).max(),
        abs(shear[slips] + np.sign(slid[slips]) * bound[slips]).max(initial=0.0),
    ]
    balance = 0.0 if load is None else abs((np.where(touching, pressure, 0.0) - pull).mean() / load - 1.0)
    return max(max(violations) / peak if peak > 0.0 else max(violations), -gap.min() / np.ptp(punch), balance, volume)


def sticking(result, start, row=0):
    """Nodes `[x]` that touch and have not slid since the start of the step."""
    held = (start.tangential + start.dragged)[row, 0]
    return result.touching[row] & (result.tangential.displacement[row, 0] == held)
