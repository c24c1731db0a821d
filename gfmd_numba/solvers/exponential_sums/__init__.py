"""Profiles whose compliance is nearly a sum of exponential decays, which takes no transforms.

A hard wall enters by `newton.decay_newton`, friction and laws by `exponential_sum.py` and `parallel_law.py`.
"""
