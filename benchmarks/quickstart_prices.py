"""What errors of kappa cost: runs of the quickstart campaign until three errors, round by round.

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
from gfmd_numba.cli.tables import duration

CAMPAIGN = Path(__file__).parents[1] / "campaigns/quickstart.yaml"
GOALS = (0.03, 0.02, 0.01)


def main(picture=None, goals=GOALS):
    print(f"One thread of {processor()}:\n\n| run until | round | processor time | error of κ |\n|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for goal in goals:
            run = gfmd_numba.run(CAMPAIGN, Path(folder, f"until-{goal}"), until={"kappa": goal})
            for number, seconds, error in zip(
                run["round"].values, run["round_cpu_seconds"].values, run["round_error"].values, strict=True
            ):
                print(f"| {100 * goal:g} % | {number} | {duration(seconds)} | {100 * error:.2g} % |", flush=True)
            print(f"{run.attrs['ended']}: {int((run['status'] == 0).sum())} contacts", file=sys.stderr)
        if picture is not None:
            plot_rounds(run).savefig(picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
