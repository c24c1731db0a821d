"""The conditions of Signorini and Coulomb on maps, node by node, by NumPy's transforms: independent of the solvers."""

import numpy as np


def tractions(stiffness, tangential, normal, load=None):
    """Tangential tractions `[component, y, x]` and pressure `[y, x]` that displacements call up.

    The load is None where the stiffness of the mean normal displacement counts.
    """
    xx, xy, yy, xz, yz, zz = stiffness.elements
    zz = zz.copy()
    if load is not None or np.isinf(zz[0, 0]):
        zz[0, 0] = 0.0
    x, y, z = np.fft.rfft2(np.array([*tangential, normal]))
    found = np.array([xx * x + xy * y + 1j * xz * z, xy * x + yy * y + 1j * yz * z, zz * z - 1j * (xz * x + yz * y)])
    along_x, along_y, restoring = np.fft.irfft2(found, normal.shape)
    return np.array([along_x, along_y]), (load or 0.0) - restoring


def largest_violation(stiffness, punch, load, friction, result, start=None, row=0):
    """Largest violation of any condition in one row: of lengths over the height of the punch, else over the pressure.

    `start` is what the step began with: nodes slip by their way from where they were then, moved with the punch.
    """
    punch, tangential, normal = punch[row], result.tangential.displacement[row], result.displacement[row]
    shear, pressure = tractions(stiffness, tangential, normal, load)
    peak = result.pressure[row].max()
    volume = 0.0
    if load is None and np.isinf(stiffness.normal[0, 0]):
        pressure = pressure + result.pressure[row].mean()
        volume = abs(normal.mean()) / np.ptp(punch)
    gap = punch - normal
    touching = gap <= 0.0
    slid = tangential - (0.0 if start is None else start.tangential[row] + start.dragged)  # exactly 0 where it sticks
    way = np.hypot(*slid)
    bound = friction * np.where(touching, np.maximum(pressure, 0.0), 0.0)
    slips = touching & (way > 0.0)
    against = shear + bound * slid / np.where(way > 0.0, way, 1.0)
    violations = [
        abs(pressure[~touching]).max(initial=0.0),
        -pressure[touching].min(initial=0.0),
        (np.hypot(*shear) - bound).max(),
        np.hypot(*against)[slips].max(initial=0.0),
    ]
    balance = 0.0 if load is None else abs(pressure[touching].sum() / punch.size / load - 1.0)
    return max(max(violations) / peak if peak > 0.0 else max(violations), -gap.min() / np.ptp(punch), balance, volume)


def sticking(result, row=0):
    """Nodes `[y, x]` that touch and have not slid since the start of the step."""
    return result.touching[row] & ~result.tangential.slip[row].any(axis=0)
