"""What the engine itself costs: two workers against one, overhead over the kernels, planning many cases."""

import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import gfmd_numba

REPEATS = 2
CAMPAIGN = """
name: engine
seed: 1
realisations: {realisations}
scene:
  body: {{poissons_ratio: 0.33}}
  roughness: {{method: psd, hurst: 0.8, rms_gradient: 0.01}}
  interface: {{hard_wall: {{}}}}
  loading: {{reduced_pressure: 0.05}}
reference: {{eps_c: 1/4, eps_f: {eps_f}, eps_t: 1/2}}
grid: {{hurst: [{hurst}], reduced_pressure: [{pressures}]}}
"""


def campaign(folder, realisations, eps_f, hursts, pressures):
    path = folder / "engine.yaml"
    path.write_text(
        CAMPAIGN.format(
            realisations=realisations,
            eps_f=eps_f,
            hurst=", ".join(f"{(i + 1) / (hursts + 1):.4f}" for i in range(hursts)),
            pressures=", ".join(f"{0.02 * (i + 1):.4f}" for i in range(pressures)),
        )
    )
    return path


def timed(path, out, workers):
    command = [sys.executable, "-m", "gfmd_numba.cli", "run", str(path), "-o", str(out), f"--workers={workers}"]
    begun = time.perf_counter()
    subprocess.run(command, check=True, capture_output=True)
    wall = time.perf_counter() - begun
    return wall, gfmd_numba.open_campaign(out).attrs


def spread(values):
    return f"{statistics.median(values):.3f} ({min(values):.3f} to {max(values):.3f})"


def two_workers_against_one(folder):
    path = campaign(folder, 64, "1/512", 20, 10)
    timed(path, folder / "warm", 2)
    ratios = []
    for i in range(REPEATS):
        one, _ = timed(path, folder / f"one{i}", 1)
        two, attributes = timed(path, folder / f"two{i}", 2)
        ratios.append(one / two)
        print(
            f"200 cases: {one:.1f} s with one worker, {two:.1f} s with two, digest {attributes['content_sha256'][:8]}"
        )
    print(f"two workers are {spread(ratios)} times as fast, start-up and collection included")


def overhead(folder):
    path = campaign(folder, 64, "1/4096", 4, 2)
    shares = []
    for i in range(REPEATS):
        _, attributes = timed(path, folder / f"overhead{i}", 1)
        shares.append(attributes["last_run_seconds"] / attributes["cpu_seconds"] - 1.0)
    blocks = attributes["last_run_blocks"]
    each = attributes["cpu_seconds"] / blocks
    print(f"overhead over the kernels, {blocks} blocks of {each:.1f} s: {spread(shares)}")


def planning(folder):
    path = campaign(folder, 30, "1/16", 1000, 100)
    begun = time.perf_counter()
    subprocess.run([sys.executable, "-m", "gfmd_numba.cli", "plan", "--pilot=0", str(path)], check=True)
    megabytes = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e3
    print(f"planning 100 000 cases: {time.perf_counter() - begun:.1f} s, {megabytes:.0f} MB")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        planning(Path(name))
        two_workers_against_one(Path(name))
        overhead(Path(name))
