"""Scenes and files whose faults a plain reader takes for input."""

import numpy as np
import yaml

import gfmd_numba
from gfmd_numba.fourier import grid
from gfmd_numba.scene.document import read_document
from hard.rows import refused, row


def scene(**changes):
    parts = {
        "body": {"poissons_ratio": 0.5, "aspect_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
        "interface": {"hard_wall": {}},
        "loading": {"displacement": 0.01},
    }
    return {"scene": parts | changes, "discretisation": {"eps_c": 0.25, "eps_f": 1 / 32, "eps_t": 0.5}, "seed": 3}


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
