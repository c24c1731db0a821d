"""Coulomb friction on a hard wall by Newton's method; the door is `newton.FrictionalNewton`.

A node bears at most what `kernels.Conditions.held` allows. Beyond it slips from its anchor, by the projection onto the
friction cone: `coulomb_cone.py` in Newton's method, `kernels.friction_step` in damped dynamics. A load step hands its
displacements to the next in `contact.state.State`: a node that touches keeps its anchor, which moves with the punch.
"""
