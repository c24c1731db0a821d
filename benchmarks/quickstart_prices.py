"""What errors of kappa cost: the quickstart campaign as it stands, plans for four errors, and a run until one per cent.

python benchmarks/quickstart_prices.py [until.png]

Processor time of the contacts of all three H, in one process with one thread. The table is that of docs/accuracy.md,
"What the quickstart campaign costs", and the README repeats some of its rows. The picture, docs/until.png, is that of
the last run.
"""

import os
import sys
import tempfile
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = "1"

from peers_page import processor

import gfmd_numba
from gfmd_numba.analysis import plot_rounds
from gfmd_numba.campaign import design as accuracy
from gfmd_numba.campaign.cross_levels import with_cross_levels
from gfmd_numba.campaign.plan import plan
from gfmd_numba.cli.tables import duration

CAMPAIGN = Path(__file__).parents[1] / "campaigns/quickstart.yaml"
GOALS = (0.1, 0.03, 0.01, 0.003)


def row(name, seconds, error):
    print(f"| {name} | {duration(seconds)} | {100 * error:.2g} % |", flush=True)


def main(picture=None, goals=GOALS):
    print(f"One thread of {processor()}:\n\n| contacts | processor time | error of κ |\n|---|---|---|")
    exponents = {"eps_c": (1.5, 2.5), "eps_f": (0.2, 2.0), "eps_t": (0.5, 1.5)}
    with tempfile.TemporaryDirectory() as folder:
        whole = gfmd_numba.run(CAMPAIGN, Path(folder, "whole"))
        fit = gfmd_numba.fit_tfc(whole, fixed=exponents, exponents="free")
        row("`gfmd run`", whole.attrs["cpu_seconds"], (fit["kappa_tfc_error"] / fit["kappa_tfc"]).max().item())
        planned = with_cross_levels(plan(CAMPAIGN))
        pilot = accuracy.pilot(planned)
        for goal in goals:
            row(f"`--target kappa={100 * goal:g}%`", accuracy.design(planned, pilot, goal, None).seconds, goal)
        until = gfmd_numba.run(CAMPAIGN, Path(folder, "until"), until={"kappa": 0.01})
        for number, (seconds, error) in enumerate(
            zip(until["round_cpu_seconds"].values, until["round_error"].values, strict=True)
        ):
            row(f"`--until kappa=1%`, round {number}", seconds, error)
        if picture is not None:
            plot_rounds(until).savefig(picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
