"""Loading and unloading with a hardness, here and by ContactMechanics, whose surfaces keep their dents as well.

python benchmarks/hardness_against_contactmechanics.py; pip install ContactMechanics. Both solve the same random maps on
an elastic half-space, step by step, each from the punch that its own last step has left.
"""

import numpy as np
from ContactMechanics import PeriodicFFTElasticHalfSpace
from ContactMechanics.Factory import make_plastic_system
from SurfaceTopography import PlasticTopography, Topography

import gfmd_numba
from gfmd_numba.roughness import self_affine

NODES, GRADIENT = 128, 0.1
LOADS = (0.05, 0.2, 0.1, 0.02, 0.15, 0.4, 0.05)  # mean pressures over the hardness
MAPS = ((0.3, 0.05), (0.3, 0.2), (0.5, 0.1), (0.8, 0.05), (0.8, 0.2), (0.8, 0.5))  # H and p_H / (g E*)
PENETRATION = 1e-9  # of L_x, that ContactMechanics may leave


def here(heights, hardness):
    """Pressure and depth of each step."""
    scene = {
        "dimension": 2,
        "body": {"poissons_ratio": 0.0, "youngs_modulus": 1.0},
        "roughness": {"method": "measured", "heights": heights, "units": {"z": "L_x"}},
        "interface": {"hard_wall": {"hardness": hardness}},
        "loading": {"pressure": hardness * LOADS[0]},
    }
    path = [{"pressure": hardness * load} for load in LOADS[1:]]
    found = gfmd_numba.solve({"scene": scene, "path": path, "numerics": {"residual": 1e-9}})
    assert (found["status"] == 0).all()
    return found["pressure"].values, found["plastic_depth"].values


def there(heights, hardness):
    """The same by ContactMechanics."""
    surface = PlasticTopography(Topography(heights, (1.0, 1.0), periodic=True), hardness)
    half_space = PeriodicFFTElasticHalfSpace(heights.shape, 1.0, (1.0, 1.0))
    system, found = make_plastic_system(substrate=half_space, surface=surface), []
    for load in LOADS:
        assert system.minimize_proxy(external_force=hardness * load, pentol=PENETRATION, maxiter=50_000).success
        found.append((half_space.force / surface.area_per_pt, abs(surface.plastic_displ)))
    return map(np.array, zip(*found, strict=True))


if __name__ == "__main__":
    print(f"{'H':>4} {'p_H/(g E*)':>10} {'plastic':>8} {'contact':>8} {'differing':>9} {'pressure':>9} {'depth':>9}")
    for i, (hurst, hardness) in enumerate(MAPS):
        heights = (
            GRADIENT * self_affine.SelfAffineWaves(hurst, 2, NODES // 4).heights((NODES, NODES), 7 + i, range(1))[0]
        )
        (pressure, depth), (theirs, dents) = (code(heights, GRADIENT * hardness) for code in (here, there))
        differing = np.count_nonzero((pressure > 0.0) != (theirs > 0.0))
        plastic = (pressure >= GRADIENT * hardness * (1.0 - 1e-8)).mean(axis=(1, 2)).max()
        off = abs(pressure - theirs).max() / (GRADIENT * hardness), abs(depth - dents).max() / depth.max()
        shown = f"{hurst:4} {hardness:10} {plastic:8.4f} {np.count_nonzero(pressure > 0.0):8} {differing:9}"
        print(shown, *(f"{each:9.1e}" for each in off))
