"""Ten varied campaigns with a target: predicted against actual processor time and error."""

import tempfile
from pathlib import Path

import numpy as np

import gfmd_numba
from gfmd_numba.campaign import design as accuracy
from gfmd_numba.campaign.cross_levels import with_cross_levels
from gfmd_numba.campaign.plan import plan

CAMPAIGN = """
name: varied
seed: {seed}
realisations: 30
scene:
  body: {{poissons_ratio: {nu}, aspect_ratio: {a}}}
  roughness: {{method: psd, hurst: {hurst}, rms_gradient: 0.01}}
  interface: {{hard_wall: {{}}}}
  loading: {{reduced_pressure: {p}}}
reference: {{eps_c: 1/4, eps_f: 1/{f}, eps_t: 1/{t}}}
limits: {{eps_c: [1/2, 1/8], eps_f: [1/{f4}, 1/{f2}], eps_t: [1/{t2}, 1/{t4}]}}
fit: {{fixed: {{eps_c: [3/2, 5/2], eps_f: [1/2, 3/2], eps_t: [1/2, 3/2]}}}}
"""
VARIED = [
    {"hurst": 0.3, "p": 0.02, "a": ".inf", "nu": 0.3, "f": 128, "t": 4, "target": 0.02},
    {"hurst": 0.5, "p": 0.02, "a": ".inf", "nu": 0.3, "f": 128, "t": 4, "target": 0.02},
    {"hurst": 0.8, "p": 0.02, "a": ".inf", "nu": 0.3, "f": 128, "t": 4, "target": 0.02},
    {"hurst": 1.0, "p": 0.05, "a": ".inf", "nu": 0.3, "f": 256, "t": 8, "target": 0.02},
    {"hurst": 0.0, "p": 0.05, "a": ".inf", "nu": 0.3, "f": 64, "t": 8, "target": 0.01},
    {"hurst": 0.8, "p": 0.3, "a": ".inf", "nu": 0.3, "f": 128, "t": 8, "target": 0.01},
    {"hurst": 0.8, "p": 0.05, "a": 0.1, "nu": 0.3, "f": 128, "t": 4, "target": 0.02},
    {"hurst": 0.3, "p": 0.05, "a": 0.02, "nu": 0.49, "f": 128, "t": 4, "target": 0.02},
    {"hurst": 0.5, "p": 0.007, "a": ".inf", "nu": 0.3, "f": 512, "t": 4, "target": 0.03},
    {"hurst": 0.7, "p": 0.1, "a": 0.5, "nu": 0.5, "f": 64, "t": 16, "target": 0.02},
]


def main():
    costs, covered = [], 0
    for seed, varied in enumerate(VARIED):
        f, t = varied["f"], varied["t"]
        text = CAMPAIGN.format(seed=seed, f2=f // 2, f4=f // 4, t2=t // 2, t4=t // 4, **varied)
        with tempfile.TemporaryDirectory() as folder:
            path, written = Path(folder) / "varied.yaml", Path(folder) / "designed.yaml"
            path.write_text(text)
            planned = with_cross_levels(plan(path))
            design = accuracy.design(planned, accuracy.pilot(planned), varied["target"], None)
            written.write_text(accuracy.rewritten(planned, design, varied["target"])[0])
            results = gfmd_numba.run(written, Path(folder) / "out")
        fit = gfmd_numba.fit_tfc(results, fixed={"eps_c": (1.5, 2.5), "eps_f": (0.5, 1.5), "eps_t": (0.5, 1.5)})
        achieved = (fit["kappa_tfc_error"] / fit["kappa_tfc"]).item()
        ratio = results.attrs["cpu_seconds"] / design.seconds
        costs.append(ratio)
        covered += achieved <= design.error
        shown = ", ".join(f"{name} {value}" for name, value in varied.items())
        print(
            f"{shown}: predicted {design.seconds:.1f} s and {100 * design.error:.2f} %, "
            f"actual {results.attrs['cpu_seconds']:.1f} s ({ratio:.2f}) and {100 * achieved:.2f} %",
            flush=True,
        )
    within = sum(1 / 1.5 <= ratio <= 1.5 for ratio in costs)
    print(f"cost within 1.5 times in {within} of {len(costs)} (median ratio {np.median(costs):.2f})")
    print(f"predicted error covers the achieved one in {covered} of {len(costs)}")


if __name__ == "__main__":
    main()
