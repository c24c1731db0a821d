"""Table of hard cases: what a plain code does with them, what this one does, its error and its cost.

`python benchmarks/hard_cases.py` prints the table of docs/hard-cases.md. The plain code is the textbook's formula or
the loop that one writes first: NumPy, the thesis's recipe for step and damping, a number of steps decided beforehand.
"""

import subprocess
import sys
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path

import mpmath
import numpy as np
import yaml

import gfmd_numba
from gfmd_numba.campaign.execution import Workers
from gfmd_numba.campaign.results import read_results
from gfmd_numba.campaign.run import run
from gfmd_numba.contact.edges import EDGE_BIAS
from gfmd_numba.elasticity import stiffness
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import self_affine, statistics
from gfmd_numba.scene import InputError
from gfmd_numba.scene.document import read_document
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.status import Status
from gfmd_numba.theory import closed_forms

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


def row(case, naive, here, error, cost):
    print(f"| {case} | {naive} | {here} | {error} | {cost} |", flush=True)


def verlet(heights, load, steps, dt, damping, tolerance=0.0, dtype=np.float64):
    """Displacement and restoring traction after some steps, or once no free node feels more than a traction."""
    n = len(heights)
    k = (0.5 * grid.wavenumbers(n)).astype(dtype)
    softest, dt = k[1], dt / np.sqrt(k[-1])
    eta = damping * (2 * np.sqrt(softest) / dt - softest)
    wall = (heights.max() - heights).astype(dtype)
    u = last = np.zeros(n, dtype)
    memory, push, load = dtype(1 - eta * dt * dt), dtype(dt * dt), dtype(load)
    for _ in range(steps):
        restoring = np.fft.irfft(k * np.fft.rfft(u), n)
        if np.abs(np.where(u < wall, load - restoring, 0)).max() <= tolerance:
            break
        u, last = np.minimum(u + memory * (u - last) + push * (load - restoring), wall), u
        if not np.isfinite(u).all() or np.abs(u).max() > 1e6:
            return None, None
    return u, np.fft.irfft(k * np.fft.rfft(u), n)


def certified(heights, load, solver="verlet", **numerics):
    heights = np.atleast_2d(heights)
    body = stiffness.half_space(grid.wavenumbers(heights.shape[1]))
    begun = time.perf_counter()
    punch = heights.max(axis=1, keepdims=True) - heights
    return equilibrate(punch, body, load, Options(solver, **numerics)), time.perf_counter() - begun


def textbook(k, nu):
    """Ratio of slab to half-space by hyperbolic functions as (6.58) has them."""
    r, s = 1 / (3 - 4 * nu), (1 - 2 * nu) / (2 * (1 - nu))
    f = np.sinh(k) ** 2 - (r * k) ** 2
    m11, m33 = ((1 - r) * (np.cosh(k) * np.sinh(k) + sign * r * k) / f for sign in (-1, 1))
    m13 = (1 - r) / (1 + r) * ((1 - r) * np.sinh(k) ** 2 - 2 * (r * k) ** 2) / f
    return 2 * (1 - nu) ** 2 / (1 - 2 * nu) * (m33 - m13**2 / m11) if s else np.full_like(k, np.nan)


def exact(k, nu):
    with mpmath.workdps(60):
        k, kappa = mpmath.mpf(k), 3 - 4 * mpmath.mpf(nu)
        if k > 500:
            return 1.0
        x = 2 * k
        top = 2 * kappa * mpmath.cosh(x) + 1 + kappa**2 + x**2
        return float(top / (2 * kappa * mpmath.sinh(x) - 2 * x))


def slabs():
    k = np.logspace(-8, 8, 161)
    for nu in (0.33, 0.499999, 0.5):
        truth = np.array([exact(one, nu) for one in k])
        naive = textbook(k, nu)
        usable = np.isfinite(naive)
        worst = abs(naive / truth - 1)[usable]
        said = f"nan for {(~usable).sum()} of {k.size} wave numbers"
        said += f", {(worst > 0.01).sum()} more off by over 1 %" if usable.any() else ""
        begun = time.perf_counter()
        ours = stiffness.slab_factor(k, nu)
        cost = (time.perf_counter() - begun) / k.size
        error = abs(ours / truth - 1).max()
        row(
            f"slab, ν = {nu:g}, q z_m from 1e-8 to 1e8",
            said,
            "a number for each",
            f"{error:.0e}",
            f"{cost * 1e9:.0f} ns",
        )


def stepping():
    heights, load, nx = self_affine.profiles(0.8, 2, 2048, 8192, 1, range(1))[0], 0.007, 8192
    best, _ = certified(heights, load, "conjugate_gradients", residual=1e-12)
    count = best.touching.sum()
    ours, seconds = certified(heights, load)
    off = abs(ours.touching.sum() - count) / count
    cost = f"{ours.n_iterations[0]} steps, {seconds:.2g} s"
    for steps in (100, 300):
        u, restoring = verlet(heights, load, steps, 1.9, 0.5)
        found = ((u >= heights.max() - heights) & (load > restoring)).sum()
        row(
            f"{steps} steps decided beforehand, nx = {nx}",
            f"area off by {found / count - 1:+.0%}",
            "stops at a residual",
            f"area {off:.0%}",
            cost,
        )
    for damping in (3.0, 100.0):
        u, _ = verlet(heights, load, 300, 1.98, damping)
        ours, seconds = certified(heights, load, time_step=0.99, damping=damping, max_iterations=20_000)
        state = Status(ours.status[0]).name
        row(
            f"damping of {damping:g} η_cr, Δt at 0.99 of K Δt² = 4",
            "diverges" if u is None else "stable",
            f"{state}: the limit counts η too",
            "left out of fits" if ours.status[0] else "area 0%",
            f"{ours.n_iterations[0]} steps, {seconds:.2g} s",
        )


def single_precision():
    for nx in (4096, 65536):
        heights, load = self_affine.profiles(0.8, 2, nx // 4, nx, 1, range(1))[0], 0.007
        best, seconds = certified(heights, load)
        u, restoring = verlet(heights, load, int(best.n_iterations[0]), 1.9, 0.5, dtype=np.float32)
        touching = (u >= (heights.max() - heights).astype(np.float32)) & (restoring < load)
        worst = abs(np.where(touching, 0, load - restoring)).max() / (load - restoring).max()
        wrong = (touching != best.touching[0]).sum() / best.touching.sum()
        row(
            f"single precision, nx = {nx}",
            f"residual stays at {worst:.0e}; {wrong:.1%} of the nodes wrong",
            f"double: {best.residual[0]:.0e}",
            "0 nodes",
            f"{seconds:.2g} s",
        )


def units():
    x = np.arange(256) / 256
    amplitude, load, modulus = 1e-4, 5e-5, 1e-3
    heights = amplitude * np.cos(2 * np.pi * x)
    truth = 2 * closed_forms.westergaard_half_width(load, amplitude)
    u, restoring = verlet(heights, load, 100_000, 1.9, 0.5, tolerance=1e-8 / modulus)
    naive = ((u >= heights.max() - heights) & (restoring < load)).mean()
    ours, seconds = certified(heights, load)
    edges = ours.touching.mean() - 2 * EDGE_BIAS / 256
    row(
        "E = 1 mPa, stop at a force of 1e-8 Pa",
        f"contact length {naive / truth - 1:+.0%}",
        "stops at a share of the pressure",
        f"{edges / truth - 1:+.1%}",
        f"{seconds:.2g} s",
    )


def edges():
    """Contact lengths over those of Westergaard, at loads that move the edges across the grid."""
    loads, amplitude, nx = np.linspace(0.03, 0.09, 31) * np.pi * 0.01, 0.01, 64
    heights = amplitude * np.cos(2 * np.pi * np.arange(nx) / nx)
    truth = np.array([2 * closed_forms.westergaard_half_width(load, amplitude) for load in loads])
    begun = time.perf_counter()
    counted = np.array([certified(heights, load)[0].touching.mean() for load in loads])
    cost = (time.perf_counter() - begun) / len(loads)
    naive, ours = counted / truth - 1, (counted - 2 * EDGE_BIAS / nx) / truth - 1
    nodes = f"{counted.min() * nx:.0f} to {counted.max() * nx:.0f}"
    said = f"mean {ours.mean():+.1%}, scatter {ours.std():.0%}"
    row(
        f"contacts of {nodes} nodes",
        f"counted length: mean {naive.mean():+.1%}, scatter {naive.std():.0%}",
        "length less 0.19 spacings an edge",
        said,
        f"{cost:.1g} s",
    )


def gradients():
    for hurst in (0.0, 1.0):
        heights = self_affine.profiles(hurst, 2, 256, 1024, 1, range(1))[0]
        naive = np.sqrt((np.gradient(heights, 1 / 1024) ** 2).mean())
        begun = time.perf_counter()
        ours = float(statistics.rms_gradient(heights))
        row(
            f"rms gradient, H = {hurst:g}, 4 nodes a wave",
            f"finite differences {naive - 1:+.0%}",
            "Parseval's sum",
            f"{abs(ours - 1):.0e}",
            f"{(time.perf_counter() - begun) * 1e6:.0f} µs",
        )


def scene(**changes):
    parts = {
        "body": {"poissons_ratio": 0.5, "aspect_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
        "interface": {"hard_wall": {}},
        "loading": {"displacement": 0.01},
    }
    return {"scene": parts | changes, "discretisation": {"eps_c": 0.25, "eps_f": 1 / 32, "eps_t": 0.5}, "seed": 3}


def refused(question):
    begun = time.perf_counter()
    try:
        question()
    except InputError as error:
        return "refused: " + str(error).rpartition("given ")[2].replace("|", "\\|"), time.perf_counter() - begun
    return "accepted", time.perf_counter() - begun


def scenes(folder):
    flat = np.full(257, 0.1)
    np.save(folder / "flat.npy", flat)
    gradient = np.sqrt((grid.multiplicity(257) * np.abs(grid.wavenumbers(257) * grid.coefficients(flat)) ** 2).sum())
    measured = scene(
        roughness={"method": "measured", "file": str(folder / "flat.npy")}, loading={"reduced_pressure": 1}
    )
    del measured["discretisation"]
    said, seconds = refused(lambda: gfmd_numba.solve(measured))
    row(
        "flat profile of 257 nodes",
        f"an rms gradient of {gradient:.0e}, taken for roughness",
        said,
        "-",
        f"{seconds * 1e3:.0f} ms",
    )
    said, seconds = refused(lambda: gfmd_numba.solve(scene()))
    row(
        "ν = 1/2, pushed deeper than volume allows",
        "(this code once) full contact under 8e15 E\\*, certified",
        said,
        "-",
        f"{seconds * 1e3:.0f} ms",
    )


def files(folder):
    bomb = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
        f"{b}: &{b} [{', '.join([f'*{a}'] * 9)}]\n" for a, b in zip("abcdefgh", "bcdefghi", strict=True)
    )
    (folder / "bomb.yaml").write_text(bomb)
    leaves = 9**9
    said, seconds = refused(lambda: read_document(folder / "bomb.yaml"))
    row(f"alias bomb of {len(bomb)} bytes", f"{leaves:.0e} values", said, "-", f"{seconds * 1e3:.0f} ms")
    (folder / "twice.yaml").write_text("seed: 1\nseed: 2\n")
    said, seconds = refused(lambda: read_document(folder / "twice.yaml"))
    row(
        "a key given twice",
        f"the last one counts: {yaml.safe_load('seed: 1' + chr(10) + 'seed: 2')}",
        said,
        "-",
        f"{seconds * 1e3:.0f} ms",
    )
    (folder / "number.yaml").write_text("residual: 1e-8\n")
    value = read_document(folder / "number.yaml").data["residual"]
    row(
        "residual: 1e-8",
        f"the text {yaml.safe_load('residual: 1e-8')['residual']!r}",
        f"the number {value!r}",
        "-",
        "-",
    )


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


def large():
    for nx in (2**20, 3**12):
        heights = self_affine.profiles(0.8, 2, nx // 64, nx, 1, range(1))
        ours, seconds = certified(heights, 0.05, "active_set_newton")
        said = f"{Status(ours.status[0]).name} after {ours.n_transforms[0]} transforms"
        row(f"nx = {nx}", "-", said, f"residual {ours.residual[0]:.0e}", f"{seconds:.2g} s")


if __name__ == "__main__":
    print("| case | a plain code | this one | error | cost |\n|---|---|---|---|---|")
    with warnings.catch_warnings(), tempfile.TemporaryDirectory() as folder:
        warnings.simplefilter("ignore")
        certified(self_affine.profiles(0.8, 2, 16, 64, 1, range(1)), 0.1)  # compiles
        certified(self_affine.profiles(0.8, 2, 16, 64, 1, range(1)), 0.1, "conjugate_gradients")
        for part in (slabs, stepping, single_precision, units, edges, gradients):
            part()
        for part in (scenes, files, results):
            part(Path(folder))
        large()
