"""Results whose faults a plain reader does not notice: contacts of single nodes, altered files."""

import subprocess
import sys
import time
from collections import Counter

import numpy as np

import gfmd_numba
from gfmd_numba.campaign.results import read_results
from gfmd_numba.campaign.run import run
from gfmd_numba.campaign.workers import Workers
from hard.rows import refused, row

CAMPAIGN = """
name: hard
seed: 1
realisations: 5
scene:
  body: {poissons_ratio: 0.33}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 1e-6}
reference: {eps_c: 1/4, eps_f: 1/64, eps_t: 1/2}
limits: {eps_c: [1/2, 1/8]}
fit: {fixed: {eps_c: 1}}
"""


READ = "import sys, xarray; d = xarray.open_dataset(sys.argv[1]).load(); print(d.kappa.values.tobytes().hex())"


def results(folder):
    (folder / "hard.yaml").write_text(CAMPAIGN)
    path, _ = run(folder / "hard.yaml", folder / "out", Workers(0))
    dataset = read_results(path)
    kappa = float(dataset["kappa"].where(dataset["is_reference"]).mean())
    scatter = float(dataset["kappa"].where(dataset["is_reference"]).std())
    message = str(gfmd_numba.fit_tfc(dataset, fixed={"eps_c": 1.0})["message"].values[0])
    note = next(line for line in message.splitlines() if "nodes on average" in line)
    row(
        "p\\* = 1e-6: contacts of single nodes",
        f"κ = {kappa:.0f} ± {scatter:.0f}",
        f"the same, and the fit says: {note}",
        "-",
        "-",
    )
    sound, rng, found, ours = dataset["kappa"].values.tobytes().hex(), np.random.default_rng(0), Counter(), Counter()
    content = path.read_bytes()
    begun, spent = time.perf_counter(), 0.0
    for _ in range(40):
        altered = bytearray(content)
        at = int(rng.integers(len(content) - 200))
        altered[at : at + 200] = bytes(255 - byte for byte in altered[at : at + 200])
        (folder / "altered.nc").write_bytes(altered)
        begun = time.perf_counter()
        said, _ = refused(lambda: read_results(folder / "altered.nc"))
        spent += time.perf_counter() - begun
        ours[said.partition(":")[0]] += 1
        try:
            done = subprocess.run(
                [sys.executable, "-c", READ, str(folder / "altered.nc")], capture_output=True, text=True, timeout=20
            )
            outcome = (
                "an error" if done.returncode else "wrong numbers" if done.stdout.strip() != sound else "no change of κ"
            )
        except subprocess.TimeoutExpired:
            outcome = "no end in 20 s"
        found[outcome] += 1
    row(
        "40 files of results, 200 bytes of each altered",
        ", ".join(f"{n} {what}" for what, n in found.most_common()),
        ", ".join(f"{n} {what}" for what, n in ours.most_common()),
        "-",
        f"{spent / 40 * 1e3:.0f} ms",
    )
