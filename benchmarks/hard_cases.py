"""Table of hard cases: what a plain code does with them, what this one does, its error and its cost.

`python benchmarks/hard_cases.py` prints the table of docs/hard-cases.md. The plain code is the textbook's formula or
the loop that one writes first: NumPy, the thesis's recipe for step and damping, a number of steps decided beforehand.
"""

import tempfile
import warnings
from pathlib import Path

from hard import contacts, files, formulae, results

from gfmd_numba.roughness import self_affine

if __name__ == "__main__":
    print("| case | a plain code | this one | error | cost |\n|---|---|---|---|---|")
    with warnings.catch_warnings(), tempfile.TemporaryDirectory() as folder:
        warnings.simplefilter("ignore")
        contacts.certified(self_affine.SelfAffineWaves(0.8, 2, 16).heights((64,), 1, range(1)), 0.1)  # compiles
        contacts.certified(
            self_affine.SelfAffineWaves(0.8, 2, 16).heights((64,), 1, range(1)), 0.1, "conjugate_gradients"
        )
        for part in (
            formulae.slabs,
            contacts.stepping,
            contacts.single_precision,
            contacts.units,
            contacts.edges,
            formulae.gradients,
        ):
            part()
        for part in (files.scenes, files.files, results.results):
            part(Path(folder))
        contacts.large()
