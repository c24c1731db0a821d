"""Ten varied campaigns with a target, three of maps and two of slabs: what `gfmd plan` says and what `gfmd run` takes.

Processor time is that of the whole `gfmd run`, as the system counts it, and of its contacts, as the results have it.
Wall time is from the start of the command to its end, less the time for which its main thread stood in the queue of a
processor that others used (Linux: /proc/PID/schedstat): without others it is what a user waits for.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import gfmd_numba
from gfmd_numba.campaign import design as accuracy
from gfmd_numba.campaign.cross_levels import with_cross_levels
from gfmd_numba.campaign.overhead import overhead
from gfmd_numba.campaign.plan import plan

CAMPAIGN = """
name: varied
seed: {seed}
realisations: 30
scene:
  dimension: {dimension}
  body: {{poissons_ratio: 0.3, aspect_ratio: {a}}}
  roughness: {{method: psd, hurst: {hurst}, rms_gradient: 0.01}}
  interface: {{hard_wall: {{}}}}
  loading: {{reduced_pressure: {p}}}
reference: {{eps_c: 1/{c}, eps_f: 1/{f}, eps_t: 1/{t}}}
limits: {{eps_c: [1/{c2}, 1/{c8}], eps_f: [1/{f4}, 1/{f2}], eps_t: [1/{t2}, 1/{t4}]}}
fit: {{fixed: {{eps_c: [3/2, 5/2], eps_f: [1/2, 3/2], eps_t: [1/2, 3/2]}}}}
"""
PROFILE = {"dimension": 1, "a": ".inf", "c": 4, "f": 128, "t": 4}
MAP = {"dimension": 2, "a": ".inf", "c": 4, "f": 8, "t": 4}
VARIED = [
    PROFILE | {"hurst": 0.3, "p": 0.02, "target": 0.01},
    PROFILE | {"hurst": 0.8, "p": 0.02, "target": 0.02},
    PROFILE | {"hurst": 0.0, "p": 0.05, "f": 512, "t": 8, "target": 0.005},
    PROFILE | {"hurst": 0.8, "p": 0.3, "f": 256, "t": 8, "target": 0.003},
    PROFILE | {"hurst": 0.5, "p": 0.007, "f": 512, "target": 0.02},
    PROFILE | {"hurst": 0.8, "p": 0.05, "a": 0.1, "target": 0.01},
    PROFILE | {"hurst": 0.7, "p": 0.1, "a": 0.5, "f": 64, "t": 16, "target": 0.015},
    MAP | {"hurst": 0.3, "p": 0.05, "target": 0.04},
    MAP | {"hurst": 0.8, "p": 0.1, "target": 0.05},
    MAP | {"hurst": 0.5, "p": 0.02, "t": 8, "target": 0.04},
]
WORKERS = "--workers=0"


def ran(path, out):
    """Wall time without that in queues, and processor time in s, of a run in a process of its own."""
    begun, waited = time.perf_counter(), 0
    command = [sys.executable, "-m", "gfmd_numba", "run", str(path), "-o", str(out), WORKERS]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while True:
        ended, status, usage = os.wait4(process.pid, os.WNOHANG)
        if ended:
            break
        waited = int(Path(f"/proc/{process.pid}/schedstat").read_text().split()[1])  # ns
        time.sleep(0.02)
    if status:
        raise RuntimeError(f"{' '.join(command)} ends with {status}")
    return time.perf_counter() - begun - 1e-9 * waited, usage.ru_utime + usage.ru_stime


def compared(seed, varied):
    """Ratios of what a campaign took to what was predicted: contacts, processor time, wall time; and the errors."""
    c, f, t = varied["c"], varied["f"], varied["t"]
    text = CAMPAIGN.format(seed=seed, c2=c // 2, c8=2 * c, f2=f // 2, f4=f // 4, t2=t // 2, t4=t // 4, **varied)
    with tempfile.TemporaryDirectory() as folder:
        path, written, out = (Path(folder) / name for name in ("varied.yaml", "designed.yaml", "out"))
        path.write_text(text)
        planned = with_cross_levels(plan(path))
        design = accuracy.design(planned, accuracy.pilot(planned), varied["target"], None)
        written.write_text(accuracy.rewritten(planned, design, varied["target"])[0])
        beside = overhead(accuracy.designed(planned, design))
        wall, processor = ran(written, out)
        results = gfmd_numba.open_campaign(out)
    fit = gfmd_numba.fit_tfc(results, fixed={"eps_c": (1.5, 2.5), "eps_f": (0.5, 1.5), "eps_t": (0.5, 1.5)})
    achieved = (fit["kappa_tfc_error"] / fit["kappa_tfc"]).item()
    contacts, everything = design.seconds, design.seconds + beside.cpu_seconds(0)
    waiting = design.seconds + beside.wall_seconds(0)
    kind = "map" if varied["dimension"] == 2 else "profile" if varied["a"] == ".inf" else f"slab, a = {varied['a']}"
    print(
        f"| {kind}, H = {varied['hurst']}, p* = {varied['p']} | {contacts:.2g}, {results.attrs['cpu_seconds']:.2g} | "
        f"{everything:.2g}, {processor:.2g} | {waiting:.2g}, {wall:.2g} | {design.error:.2%}, {achieved:.2%} |",
        flush=True,
    )
    ratios = results.attrs["cpu_seconds"] / contacts, processor / everything, wall / waiting
    return ratios, achieved <= design.error


def main():
    print("| campaign | contacts, s: predicted, actual | processor, s | wall, s | error |\n|---|---|---|---|---|")
    found = [compared(seed, varied) for seed, varied in enumerate(VARIED)]
    for name, ratios in zip(
        ("contacts", "processor time", "wall time"), np.transpose([r for r, _ in found]), strict=True
    ):
        within = ((ratios > 1 / 1.3) & (ratios < 1.3)).sum()
        print(f"{name}: {ratios.min():.2f} to {ratios.max():.2f} times, within 1.3 in {within} of {len(found)}")
    print(f"predicted error covers the achieved one in {sum(covered for _, covered in found)} of {len(found)}")


if __name__ == "__main__":
    main()
