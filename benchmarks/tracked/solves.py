"""Processor time of the cases of benchmarks/peers.py, from heights to pressure with one thread."""

import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from peers import CASES, RESIDUAL, here
from peers_page import label


class Contacts:
    params = tuple(f"{label(case)}, H = {case.hurst}, p* = {case.load}" for case in CASES)
    param_names = ("contact",)
    timer = time.process_time
    timeout = 120

    def setup(self, contact):
        case = CASES[self.params.index(contact)]
        self.punch, self.load = next(case.punches()), case.load
        here(self.punch, self.load, RESIDUAL)  # compiles

    def time_solve(self, contact):
        here(self.punch, self.load, RESIDUAL)

    def peakmem_solve(self, contact):
        here(self.punch, self.load, RESIDUAL)
