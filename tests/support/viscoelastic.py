"""A generalised Maxwell material in closed form, and the scenes that press on it."""

import numpy as np
from scipy.integrate import quad
from scipy.linalg import expm

import gfmd_numba

STANDARD = ((3.0, 1.0),)  # moduli over the relaxed one, and times: a standard linear solid
THREE = ((0.5, 10.0), (1.0, 1.0), (2.0, 0.05))


def modulus(series, time):
    """Modulus at a time after a sudden strain, over the relaxed one."""
    return 1.0 + sum(m * np.exp(-time / tau) for m, tau in series)


def compliance(series, time):
    """Strain at a time after a sudden stress, over that of the relaxed body."""
    moduli, times = np.array(series).T
    glassy = 1.0 + moduli.sum()
    rates = (np.outer(np.ones(len(moduli)), moduli) / glassy - np.eye(len(moduli))) / times[:, np.newaxis]
    source = 1.0 / glassy / times
    # dv/dt = rates v + source, with v the displacements of the dashpots
    v = np.linalg.solve(rates, (expm(rates * time) - np.eye(len(moduli))) @ source)
    return float(1.0 + moduli @ v) / glassy


def equivalent_load(series, load, slope, time):
    """Load of a relaxed body that is deformed as by a sudden load that then grows at a rate."""
    return load * compliance(series, time) + slope * quad(lambda s: compliance(series, s), 0.0, time, epsabs=1e-12)[0]


def relaxation(series, modulus=1.0):
    """Key `relaxation` of a body."""
    return [{"modulus": m * modulus, "time": tau} for m, tau in series]


def in_a_window(dimension, radius, points, loading, path=(), **numerics):
    """A ball, or a cylinder, with a node at its apex, solved in a window of length 1 on a standard solid of E* = 1."""
    scene = {
        "dimension": dimension,
        "periodic": False,
        "length": 1.0,
        "body": {"youngs_modulus": 0.75, "poissons_ratio": 0.5, "relaxation": relaxation(STANDARD, 0.75)},
        "form": {"radius": radius, "points": points},
        "interface": {"hard_wall": {}},
        "loading": loading,
    }
    found = gfmd_numba.solve({"scene": scene, "path": list(path), "numerics": numerics})
    assert not found["status"].any()
    return found
