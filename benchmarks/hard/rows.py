"""What the parts of the table of hard cases share: how a row is printed, and what a refusal says."""

import time

from gfmd_numba.scene import InputError


def row(case, naive, here, error, cost):
    print(f"| {case} | {naive} | {here} | {error} | {cost} |", flush=True)


def refused(question):
    begun = time.perf_counter()
    try:
        question()
    except InputError as error:
        return "refused: " + str(error).rpartition("you gave ")[2].replace("|", "\\|"), time.perf_counter() - begun
    return "accepted", time.perf_counter() - begun
