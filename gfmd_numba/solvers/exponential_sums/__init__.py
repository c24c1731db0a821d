"""Profiles whose compliance is nearly a sum of exponential decays, which takes no transforms.

A hard wall enters by `newton.decay_newton`, friction by `exponential_sum.py`.
"""
