"""Coulomb friction on a hard wall by Newton's method; the door is `newton.FrictionalNewton`.

The tangential traction of a node is at most `kernels.ContactLimits.friction_limit`. A node that reaches the limit slips
from its anchor, and its traction is projected onto the friction cone: `FrictionGuess.revise` (`friction_guess.py`) does
this in Newton's method, `kernels.friction_step` in damped dynamics, and `kernels.tangential_violation` certifies it. A
load step hands its displacements to the next in `contact.state.State`: a node that touches keeps its anchor, which
moves with the punch.
"""
