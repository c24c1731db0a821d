"""SIGKILL workers and main process of a campaign at random moments, resume, and compare with the uninterrupted run."""

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import psutil

import gfmd_numba

KILLS = 50
CAMPAIGN = """
name: killed
seed: 1
realisations: 30
scene:
  body: {poissons_ratio: 0.33}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.05}
reference: {eps_c: 1/4, eps_f: 1/128, eps_t: 1/2}
limits: {eps_c: [1/2, 1/8], eps_f: [1/32, 1/64]}
grid: {hurst: [0.3, 0.5, 0.8], reduced_pressure: [0.01, 0.05, 0.3]}
"""


def start(campaign, out):
    command = [sys.executable, "-m", "gfmd_numba.cli", "run", str(campaign), "-o", str(out)]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)


def workers_of(process):
    """The processes that compute: children of the main process that have used processor time."""
    try:
        children = psutil.Process(process.pid).children(recursive=True)
        return [child for child in children if "spawn_main" in " ".join(child.cmdline())]
    except psutil.Error:
        return []


def main():
    rng = random.Random(0)
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        campaign = folder / "killed.yaml"
        campaign.write_text(CAMPAIGN)
        begun = time.perf_counter()
        expected = gfmd_numba.run(campaign, folder / "reference").attrs["content_sha256"]
        print(f"uninterrupted, in one process: {time.perf_counter() - begun:.0f} s, digest {expected[:16]}")
        kills = {"worker": 0, "main process": 0}
        campaigns = wrong = 0
        while sum(kills.values()) < KILLS:
            out = folder / f"out{campaigns}"
            while True:
                process = start(campaign, out)
                while process.poll() is None and sum(kills.values()) < KILLS:
                    time.sleep(rng.uniform(0.0, 6.0))
                    if process.poll() is not None:
                        break
                    workers = workers_of(process)
                    if workers and rng.random() < 0.5:
                        rng.choice(workers).kill()
                        kills["worker"] += 1
                    else:
                        os.killpg(process.pid, signal.SIGKILL)
                        process.wait()
                        kills["main process"] += 1
                if process.wait() == 0:
                    break
                if process.returncode == 3:  # a worker died twice under one block: it was given up by name
                    subprocess.run(
                        [
                            sys.executable,
                            "-m",
                            "gfmd_numba.cli",
                            "run",
                            str(campaign),
                            "-o",
                            str(out),
                            "--retry-failed",
                        ],
                        capture_output=True,
                    )
                    break
            campaigns += 1
            found = gfmd_numba.open_campaign(out).attrs["content_sha256"]
            wrong += found != expected
            print(f"campaign {campaigns}: kills so far {kills}, digest {found[:16]}")
        print(f"{sum(kills.values())} kills in {campaigns} campaigns: {wrong} digests differ")


if __name__ == "__main__":
    main()
