"""SIGKILL a campaign in each phase of its life, resume, and compare with the uninterrupted run.

usage: kill_and_resume.py [until]

The phases are start-up (before the first new shard), middle (before the last one; here workers are killed, too),
collection (before the new netCDF file) and fit (before the end). With `until` it is a run until an error, in this
process or with two workers, and the kills come at any time: each run is killed twice, then resumes and ends.
"""

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
from gfmd_numba.campaign import rounds
from gfmd_numba.campaign.plan import plan

KILLS = 15  # in each phase
KILLS_UNTIL = 20  # at any time
UNTIL = "--until=kappa=5%"
PHASES = {"start-up": 4.0, "middle": 6.0, "collection": 0.3, "fit": 4.0}  # s that a phase may last at most
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
ROUNDS = """
limits: {eps_c: [1/2, 1/8], eps_f: [1/32, 1/64], eps_t: [1, 1/4]}
fit: {fixed: {eps_c: [3/2, 5/2], eps_f: [1/4, 2], eps_t: [1/2, 3/2]}}
grid: {hurst: [0.3, 0.8]}
"""


class Run:
    """A run in a process of its own, and the phase it is in, by the files it leaves."""

    def __init__(self, campaign, out, *options):
        self.out, self.n_blocks = out, len(plan(campaign).blocks_in(out))
        self.shards_before, self.results_before = self.n_shards(), self.results()
        self.left_before = self.unfinished_results()
        command = [sys.executable, "-m", "gfmd_numba", "run", str(campaign), "-o", str(out), *options]
        self.process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
        )

    def n_shards(self):
        return len(list(self.out.glob("shards/*.shard")))

    def results(self):
        files = list(self.out.glob("*.nc"))
        return files[0].stat().st_mtime_ns if files else None

    def phase(self):
        if self.results() != self.results_before:
            return "fit"
        if self.n_shards() == self.n_blocks:
            collecting = self.shards_before < self.n_blocks or self.unfinished_results() - self.left_before
            return "collection" if collecting else "start-up"
        return "middle" if self.n_shards() > self.shards_before else "start-up"

    def unfinished_results(self):
        return set(self.out.glob("*.nc.*.tmp"))

    def workers(self):
        try:
            children = psutil.Process(self.process.pid).children()
            return [child for child in children if "spawn_main" in " ".join(child.cmdline())]
        except psutil.Error:
            return []

    def kill_in(self, phase, rng):
        """Kill it somewhere in a phase; return the phase it was in, None if it had ended."""
        while self.process.poll() is None and self.phase() != phase:
            time.sleep(0.001)
        time.sleep(rng.uniform(0.0, PHASES[phase]))
        if self.process.poll() is not None:
            return None
        workers = self.workers()
        if phase == "middle" and workers and rng.random() < 0.5:
            now = self.phase()
            rng.choice(workers).kill()
            return now
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        return self.phase()


def digest(out):
    return gfmd_numba.open_campaign(out).attrs["content_sha256"]


def where(out):
    """What the directory of a killed run tells of how far it was."""
    n_shards, found = len(list(out.glob("shards/*.shard"))), rounds.read(out)
    return f"{n_shards} shards, {'no round' if found is None else f'round {len(found.rounds) - 1} {found.ended}'}"


def killed_until(campaign, out, seconds, workers, rng):
    """Kill a run until an error twice at any time of its life, and let it end; the number of kills that met it."""
    command = [sys.executable, "-m", "gfmd_numba", "run", str(campaign), "-o", str(out), UNTIL, workers]
    kills = 0
    for last in (False, False, True):
        process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
        )
        try:
            process.wait(None if last else rng.uniform(0.0, seconds))
            break
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            kills += 1
            print(f"  killed with {where(out)}", flush=True)
    if process.returncode:
        raise RuntimeError(f"{' '.join(command)} exits with {process.returncode}")
    return kills


def until():
    rng = random.Random(1)
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        campaign = folder / "killed.yaml"
        campaign.write_text(CAMPAIGN[: CAMPAIGN.index("limits")] + ROUNDS.lstrip())
        begun = time.perf_counter()
        killed_until(campaign, folder / "first", 1e6, "--workers=0", rng)  # no kill
        seconds, expected = time.perf_counter() - begun, digest(folder / "first")
        n_rounds = gfmd_numba.open_campaign(folder / "first").sizes["round"]
        print(f"uninterrupted: {seconds:.0f} s, {n_rounds} rounds, digest {expected[:16]}", flush=True)
        kills = campaigns = wrong = 0
        while kills < KILLS_UNTIL:
            out = folder / f"out{campaigns}"
            kills += killed_until(campaign, out, seconds, f"--workers={2 * (campaigns % 2)}", rng)
            campaigns += 1
            wrong += digest(out) != expected
            print(f"campaign {campaigns}: kills so far {kills}, digest {digest(out)[:16]}", flush=True)
        print(f"{kills} kills of runs until an error, in {campaigns} campaigns: {wrong} digests differ")


def main():
    rng = random.Random(0)
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        campaign = folder / "killed.yaml"
        campaign.write_text(CAMPAIGN)
        begun = time.perf_counter()
        gfmd_numba.run(campaign, folder / "reference")
        expected = digest(folder / "reference")
        print(f"uninterrupted, in one process: {time.perf_counter() - begun:.0f} s, digest {expected[:16]}", flush=True)
        kills, of_workers = dict.fromkeys(PHASES, 0), 0
        campaigns = wrong = 0
        while min(kills.values()) < KILLS:
            out = folder / f"out{campaigns}"
            run = Run(campaign, out)
            for phase in PHASES:
                if kills[phase] >= KILLS:
                    continue
                found = run.kill_in(phase, rng)
                if found is not None:
                    kills[found] += 1
                if run.process.poll() is None:
                    of_workers += 1
                else:
                    run = Run(campaign, out)
            if run.process.wait() == 3:  # a worker died twice under one block: it was given up by name
                Run(campaign, out, "--retry-failed").process.wait()
            campaigns += 1
            found = digest(out)
            wrong += found != expected
            print(f"campaign {campaigns}: kills so far {kills}, digest {found[:16]}", flush=True)
        total = f"{sum(kills.values())} kills, {of_workers} of them of a worker, in {campaigns} campaigns"
        print(f"{total}: {wrong} digests differ")


if __name__ == "__main__":
    until() if "until" in sys.argv[1:] else main()
