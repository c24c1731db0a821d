"""Coulomb friction on a hard wall by Newton's method; the door is `newton.FrictionalNewton`."""
