"""Contact stiffness of line contacts against load: K h_rms / p on a half-space, for several L_x/lambda_l.

lambda_l/lambda_s = 256, lambda_s/2 dx = 4; each value is from two loads 10 % apart on the same surfaces.
Usage: contact_stiffness.py [SURFACES]
"""

import sys
import tempfile
from pathlib import Path

import gfmd_numba
from gfmd_numba.analysis import secant_stiffness
from gfmd_numba.roughness import self_affine, statistics

SEED, HURSTS, LENGTHS = 2018, (0.3, 0.8), (2, 8, 32)  # L_x/lambda_l
PRESSURES = (0.001, 0.003, 0.01, 0.03, 0.1, 0.3)
GRADIENT, SHORTEST, RESOLUTION = 0.01, 256, 4
CAMPAIGN = """
name: stiffness
seed: {seed}
realisations: {surfaces}
scene:
  body: {{poissons_ratio: 0.33}}
  roughness: {{method: psd, hurst: 0.8, rms_gradient: {gradient}}}
  interface: {{hard_wall: {{}}}}
  loading: {{reduced_pressure: 0.01}}
reference: {{eps_c: 1/{resolution}, eps_f: 1/{shortest}, eps_t: 1/2}}
grid:
  hurst: {hursts}
  eps_t: {lengths}
  reduced_pressure: {loads}
"""


def rms_heights(case, surfaces):
    """Rms height of each surface of a case, in L_x."""
    cut_on = round(1 / float(case.eps_t))
    profiles = self_affine.SelfAffineWaves(float(case.hurst), cut_on, SHORTEST * cut_on).heights(
        (int(case.nx),), SEED, range(surfaces)
    )
    return GRADIENT * statistics.rms_height(profiles)


def main(surfaces=100):
    loads = [p * factor for p in PRESSURES for factor in (0.95, 1.05)]
    lengths = [f"1/{length}" for length in LENGTHS]
    text = CAMPAIGN.format(
        seed=SEED,
        surfaces=surfaces,
        gradient=GRADIENT,
        resolution=RESOLUTION,
        shortest=SHORTEST,
        hursts=list(HURSTS),
        lengths=f"[{', '.join(lengths)}]",
        loads=loads,
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "stiffness.yaml"
        path.write_text(text)
        dataset = gfmd_numba.run(path, Path(folder) / "stiffness")
    heights = [rms_heights(dataset.isel(case=i), surfaces) for i in range(dataset.sizes["case"])]
    found = secant_stiffness(dataset.assign(rms_height=(("case", "realisation"), heights)))
    columns = [(hurst, length) for hurst in HURSTS for length in LENGTHS]
    print(f"K h_rms / p of {surfaces} surfaces\n     p*", *(f"H = {h}, L_x/lambda_l = {n:<2} " for h, n in columns))
    for load in PRESSURES:
        cells = []
        for hurst, length in columns:
            chosen = (found.hurst == hurst) & (abs(found.eps_t * length - 1) < 1e-9)
            one = found.isel(interval=(chosen & (abs(found.reduced_pressure / load - 1) < 0.01)).values).squeeze()
            cells.append(f"{float(one.stiffness_reduced):13.3f} +- {float(one.stiffness_reduced_error):.3f}    ")
        print(f"{load:7}", *cells)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
