"""What one per cent of kappa_TFC costs by the thesis's procedure, all errors in, with the solver of gfmd.

python benchmarks/price_of_one_percent.py kappa-line-contact/kappa-line-contact.nc

The thesis: ten discretisations, independent surfaces and equal numbers at each, counted area, lines through each limit
(alpha = 1, as its tables 4.3 to 4.7 have them). Its error at any number of surfaces is that of the mean of many, which
more surfaces do not mend, and scatter. It is told against the limit in the file, from far finer levels. Next to it what
its surfaces would give to a fit that knows ranges of the exponents only.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import gfmd_numba
from gfmd_numba.analysis import fit_tfc

SCENE = """
name: price
seed: {seed}
realisations: {realisations}
scene:
  body: {{poissons_ratio: 0.33}}
  roughness: {{method: psd, hurst: {hurst}, rms_gradient: 0.01}}
  interface: {{hard_wall: {{}}}}
  loading: {{reduced_pressure: 0.007}}
"""
THESIS = """
reference: {eps_c: 1/2, eps_f: 1/1024, eps_t: 1/2}
limits: {eps_c: [1, 1/4, 1/8], eps_f: [1/512, 1/2048, 1/4096], eps_t: [1, 1/4, 1/8]}
"""
HURSTS = (0.3, 0.5, 0.8)
LINES = {"eps_c": 1.0, "eps_f": 1.0, "eps_t": 1.0}
RANGES = {"eps_c": (0.7, 1.5), "eps_f": (0.2, 2.0), "eps_t": (0.5, 1.5)}  # of counted areas
POOL, TARGET = 240, 0.01


def independent(dataset, rng):
    """The same numbers with other surfaces at each discretisation: every case's realisations in an order of its own."""
    shuffled = [rng.permutation(row) for row in dataset["kappa_counted"].values]
    return dataset.assign(kappa_counted=(("case", "realisation"), np.stack(shuffled)))


def thesis(folder, hurst, limit):
    path = folder / "thesis.yaml"
    path.write_text(SCENE.format(seed=7, realisations=POOL, hurst=hurst) + THESIS)
    dataset = gfmd_numba.run(path, folder / f"thesis-{hurst}")
    seconds = dataset.attrs["cpu_seconds"] / POOL
    options = {"variable": "kappa_counted", "omit_nyquist": False}
    rng = np.random.default_rng(0)
    # of many: what is left is no scatter; of 30: as the thesis had them
    many = fit_tfc(dataset, fixed=LINES, **options)
    off = many["kappa_tfc"].item() / limit - 1
    few = [fit_tfc(independent(dataset, rng).isel(realisation=slice(30)), fixed=LINES, **options) for _ in range(100)]
    scatter = np.std([fit["kappa_tfc"].item() for fit in few]) / limit
    print(
        f"H = {hurst}: thesis's lines, N = 30: {30 * seconds:.1f} s, off by {100 * off:+.1f} ± "
        f"{100 * many['kappa_tfc_error'].item() / limit:.1f} % and scatter {100 * scatter:.1f} %"
    )
    price = 30 * seconds * scatter**2 / (TARGET**2 - off**2) if abs(off) < TARGET else np.inf
    fit = fit_tfc(independent(dataset, rng), fixed=RANGES, **options)
    ranged = (fit["kappa_tfc_error"] / limit).item()
    print(
        f"  1 % by lines {price:.0f} s, were they not off {30 * seconds * (scatter / TARGET) ** 2:.0f} s; "
        f"by a fit with ranges of exponents {POOL * seconds * (ranged / TARGET) ** 2:.0f} s"
    )


def main():
    known = gfmd_numba.open_campaign(sys.argv[1])
    known = known.isel(case=np.flatnonzero(known["reduced_pressure"] == 0.007))
    limits = fit_tfc(known, exponents="free", fixed={"eps_c": (1.5, 2.5), "eps_f": (0.2, 2.0), "eps_t": (0.5, 1.5)})
    for hurst in HURSTS:
        limit = limits["kappa_tfc"].values[limits["hurst"].values == hurst][0]
        with tempfile.TemporaryDirectory() as folder:
            thesis(Path(folder), hurst, limit)


if __name__ == "__main__":
    main()
