"""What the engine itself costs: memory made anew, two workers against one, overhead over the kernels, many cases.

Arguments choose among `memory`, `planning`, `many`, `workers` and `overhead`.
"""

import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import gfmd_numba
from gfmd_numba.campaign.workers import OF_WORKERS

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
    command = [sys.executable, "-m", "gfmd_numba", "run", str(path), "-o", str(out), f"--workers={workers}"]
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
    for hursts in (1000, 10_000):
        path = campaign(folder, 30, "1/16", hursts, 100)
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        subprocess.run(
            [sys.executable, "-m", "gfmd_numba", "plan", "--pilot=0", str(path)], check=True, capture_output=True
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        print(f"planning {100 * hursts} cases: {after.ru_utime - before:.1f} s of the processor, "
              f"{after.ru_maxrss / 1e3:.0f} MB")  # fmt: skip


def many(folder):
    path = campaign(folder, 1, "1/2", 50, 100)
    begun = resource.getrusage(resource.RUSAGE_CHILDREN)
    _, attributes = timed(path, folder / "many", 0)
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = ended.ru_utime + ended.ru_stime - begun.ru_utime - begun.ru_stime
    print(
        f"5000 contacts of 32 nodes: {spent:.1f} s of the processor, {attributes['cpu_seconds']:.1f} s of them in the "
        f"contacts; {len(list((folder / 'many' / 'shards').iterdir()))} files"
    )


WORKER = """
import resource, sys
from gfmd_numba.campaign.plan import plan
from gfmd_numba.contact.evaluation import measure
from gfmd_numba.contact.solution import solve
blocks = list(plan(sys.argv[1]).blocks)
measure(solve(blocks[0].problem, range(1)))
for block in blocks[:: max(1, len(blocks) // 40)]:
    measure(solve(block.problem, range(block.first, block.stop)))
used = resource.getrusage(resource.RUSAGE_SELF)
print(used.ru_utime, used.ru_stime, used.ru_minflt)
"""


def memory(_):
    path = Path(__file__).parents[1] / "campaigns" / "thesis-chapter4.yaml"
    environments = {"new": {"MALLOC_TRIM_THRESHOLD_": "65536"}, "keep": OF_WORKERS}  # dask's own, and ours
    found = {"new": [], "keep": []}
    for _ in range(3):  # in turn, as the machine is not equally fast all the time
        for how, figures in found.items():
            command = [sys.executable, "-c", WORKER, str(path)]
            environment = os.environ | environments[how]
            said = subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout
            figures.append([float(each) for each in said.split()])
    for how, figures in found.items():
        user, system, faults = zip(*figures, strict=True)
        print(f"40 blocks of chapter 4, memory {how}: {spread(user)} s of the user's, {spread(system)} s of the "
              f"system's, {statistics.median(faults):.0f} page faults")  # fmt: skip


PARTS = {
    "memory": memory,
    "planning": planning,
    "many": many,
    "workers": two_workers_against_one,
    "overhead": overhead,
}

if __name__ == "__main__":
    for part in sys.argv[1:] or PARTS:
        with tempfile.TemporaryDirectory() as name:
            PARTS[part](Path(name))
