"""What one per cent of sampling error of kappa_TFC costs at the thesis's reference: its procedure, and the one here.

The thesis: independent surfaces at each of ten discretisations, counted area, equal numbers. Here: the same surfaces on
all levels, contact length corrected, numbers of each limit chosen for the least cost. Same solver, same levels,
exponents taken as known in both, so that only the sampling is compared.
"""

import numpy as np

from gfmd_numba.analysis import cheapest_design, fit_tfc
from gfmd_numba.campaign import accuracy
from gfmd_numba.campaign.plan import plan

CAMPAIGN = """
name: price
seed: 5
realisations: 30
scene:
  body: {poissons_ratio: 0.33}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.007}
reference: {eps_c: 1/2, eps_f: 1/1024, eps_t: 1/2}
limits: {eps_c: [1, 1/2, 1/4, 1/8], eps_f: [1/512, 1/1024, 1/2048, 1/4096], eps_t: [1, 1/2, 1/4, 1/8]}
grid: {hurst: [0.3, 0.5, 0.8]}
"""
COUNTED = {"eps_c": 0.9, "eps_f": 0.75, "eps_t": 1.0}
CORRECTED = {"eps_c": 2.0, "eps_f": 0.75, "eps_t": 1.0}
REALISATIONS, TARGET = 48, 0.01


def independent(dataset, rng):
    """The same numbers with other surfaces at each discretisation: every case's realisations in an order of its own."""
    shuffled = [rng.permutation(dataset.sizes["realisation"]) for _ in range(dataset.sizes["case"])]
    values = dataset["kappa_counted"].values
    mixed = np.stack([row[order] for row, order in zip(values, shuffled, strict=True)])
    return dataset.assign(kappa_counted=(("case", "realisation"), mixed))


def main():
    import tempfile
    from pathlib import Path

    accuracy.REALISATIONS = REALISATIONS
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "price.yaml"
        path.write_text(CAMPAIGN)
        pilot = accuracy.pilot(plan(path))
    seconds = np.array(pilot.seconds)
    rng = np.random.default_rng(0)
    for hurst in (0.3, 0.5, 0.8):
        mine = pilot.results["hurst"].values == hurst
        dataset, each = pilot.results.isel(case=mine), seconds[mine]
        options = {"variable": "kappa_counted", "fixed": COUNTED, "bootstrap": 200, "omit_nyquist": False}
        fits = [fit_tfc(independent(dataset, rng), **options) for _ in range(8)]
        error = float(np.median([(fit["kappa_tfc_error"] / fit["kappa_tfc"]).item() for fit in fits]))
        theirs = REALISATIONS * each.sum() * (error / TARGET) ** 2
        design = cheapest_design(dataset, each, TARGET, "kappa", CORRECTED)
        print(
            f"H = {hurst}: thesis's procedure {100 * error * np.sqrt(REALISATIONS / 30):.1f} % at N = 30, "
            f"{theirs:.0f} s for 1 %; here {design.seconds:.0f} s ({design.realisations}); "
            f"ratio {theirs / design.seconds:.1f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
