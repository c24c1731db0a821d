"""The figure of the paper: python paper/figure.py runs the quickstart campaign and draws paper/limits.png."""

import tempfile
from pathlib import Path

import gfmd_numba
from gfmd_numba.analysis import plot_campaign

HERE = Path(__file__).parent

if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        results = gfmd_numba.run(HERE.parent / "campaigns/quickstart.yaml", Path(folder, "quickstart"))
    plot_campaign(results, gfmd_numba.fit_tfc(results), width="double").savefig(HERE / "limits.png", dpi=300)
