"""From a rough punch, a stiffness and a load to static equilibrium."""

from gfmd_numba.dynamics.equilibrium import Equilibrium, Start, Status, equilibrate

__all__ = ["Equilibrium", "Start", "Status", "equilibrate"]
