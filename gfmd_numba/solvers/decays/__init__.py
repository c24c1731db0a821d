"""Profiles whose compliance is a sum of decays: no transforms; the door for a hard wall is `newton.decay_newton`."""
