"""The page that `peers.py` writes: its table, and the sentences around it."""

import platform
import textwrap
from importlib import metadata
from pathlib import Path

import numpy as np

PAGE = """\
# Compared with other codes

How fast codes solve frictionless contacts of rough surfaces, and what each of them can do. The command
`python benchmarks/peers.py --page docs/peers.md` measured everything and wrote this page.

## How long they take

{summary}

{times}

"ms" is the time of gfmd-numba for one surface. The columns of the other codes say how many times as long each takes:
the median, and in brackets the range over the {surfaces} surfaces of a row. p\\* is the reduced pressure. All punches
are self-affine with a Hurst exponent H. Their longest wavelength is half the period, and the shortest one has four
nodes.

- **Task.** From the heights and the load to the pressure, one surface at a time. The time includes setting up grids and
  transforms, but not importing and compiling.
- **Clock.** Processor time of one thread, on a machine ({processor}) that other processes
  used as well. Each solve of another code stands between two solves of gfmd-numba, and its ratio is to their mean.
- **Methods.** The other codes use the constrained conjugate gradients of Polonsky and Keer, ASPHER from coarse grids to
  fine ones. They need more iterations for more nodes in contact and higher loads. gfmd-numba uses an active-set Newton
  method, which needs few transforms.
- **Versions.** {versions}, Python {python}.

## Equal accuracy

Stopping criteria of different codes are not comparable. So we compute one residual for all of them from the pressure
alone: the largest traction that violates the contact conditions over the largest pressure, or the error of the load
(`residual` in `benchmarks/peers.py`). We tighten the tolerance of every code until it is at most {target}: the
largest residual is {worst}. {agreement}

## What the others can do and gfmd-numba cannot

- **Tamaas**: many machines (MPI) when built from source.
- **ASPHER**: single precision, and little memory per node.
- **ContactMechanics**: many machines (MPI). Its companions are Adhesion, for adhesive contacts, and SurfaceTopography,
  which analyses measured surfaces.

None of these codes has campaigns of many surfaces, limits with error bars, or layers of several materials. [Contacts
without a period](free_contacts.md#other-codes) are compared elsewhere (`python benchmarks/free_peers.py`).
"""


def label(case):
    return f"profile {case.shape[0]}" if len(case.shape) == 1 else f"map {case.shape[0]}²"


def rounded(number):
    return f"{number:.0f}" if number >= 9.5 else f"{number:.1f}"


def spread(ratios):
    return f"{rounded(np.median(ratios))} ({rounded(min(ratios))} to {rounded(max(ratios))})"


def line(case, results):
    """One row for the terminal."""
    parts = [f"{label(case)}, H = {case.hurst}, p* = {case.load}: {1e3 * np.median(results['here'].seconds):.2f} ms"]
    parts += [
        f"{name} {spread(found.ratios)} times, residual {max(found.residuals):.0e}, {found.differing} nodes differ"
        for name, found in results.items()
        if found.ratios
    ]
    return "; ".join(parts)


def table(head, rows):
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)


def times(rows, peers):
    """A table of profiles and one of maps, each with the codes that can do it."""

    def cells(case, results, names):
        milliseconds = 1e3 * np.median(results["here"].seconds)
        shown = f"{milliseconds:.2f}" if milliseconds < 9.995 else f"{milliseconds:.0f}"
        ratios = (spread(results[name].ratios).replace(" to ", "–") for name in names)
        return [label(case), str(case.hurst), str(case.load), shown, *ratios]

    tables = []
    for dimension in (1, 2):
        of_kind = [row for row in rows if len(row[0].shape) == dimension]
        names = [name for name in peers if of_kind and name in of_kind[0][1]]
        tables.append(table(["contact", "H", "p\\*", "ms", *names], [cells(*row, names) for row in of_kind]))
    return "\n\n".join(tables)


def summary(rows, peers):
    """Range of the medians, for profiles and for maps."""
    sentences = []
    for name in peers:
        ranges = []
        for dimension, kind in ((1, "profiles"), (2, "maps")):
            medians = [
                np.median(results[name].ratios)
                for case, results in rows
                if len(case.shape) == dimension and name in results
            ]
            if medians:
                ranges.append(f"{rounded(min(medians))} to {rounded(max(medians))} times as long on {kind}")
        sentences.append(f"{name} takes {' and '.join(ranges)}, depending on the grid and the load.")
    return " ".join(sentences) or "No other code was installed, so only the times of gfmd-numba are given."


def versions(peers):
    names = ("gfmd-numba", *peers, "NumPy")
    return ", ".join(f"{name} {metadata.version(name)}" for name in names)


def processor():
    for found in Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else ():
        if found.startswith("model name"):
            return found.split(":", 1)[1].strip()
    return platform.machine()


def text(rows, peers, target):
    """The whole page."""
    counts = [case.surfaces for case, _ in rows]
    worst = max(max(found.residuals) for _, results in rows for found in results.values())
    differing = sum(found.differing for _, results in rows for found in results.values())
    return PAGE.format(
        summary=textwrap.fill(summary(rows, peers), 110),
        times=times(rows, peers),
        surfaces=f"{min(counts)} to {max(counts)}" if min(counts) < max(counts) else counts[0],
        processor=processor(),
        versions=versions(peers),
        python=platform.python_version(),
        target=f"{target:g}",
        worst=f"{worst:.0e}",
        agreement=f"Of all nodes, {differing} are in contact in one code and open in another.",
    )
