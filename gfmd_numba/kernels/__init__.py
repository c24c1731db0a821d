"""Every compiled function, and nothing else."""

from gfmd_numba.kernels.active_sets import (
    closing_displacement,
    contact_nodes,
    newton_direction,
    newton_error,
    newton_update,
    open_gap,
    revise_contact,
)
from gfmd_numba.kernels.boundary_value_problem import free_mean, prescribed_step, prescribed_violation
from gfmd_numba.kernels.conditions import friction_violation, kkt_violation, wall_pressure
from gfmd_numba.kernels.energy_descent import (
    descent_curvature,
    descent_direction,
    descent_norm,
    descent_start,
    descent_trial,
    descent_update,
    descent_work,
)
from gfmd_numba.kernels.exponential_sum import exponential_sum_factor, exponential_sum_solve
from gfmd_numba.kernels.gradients import cg_direction, cg_gap, cg_update, close_gap
from gfmd_numba.kernels.hardness import bound, damp, level, revise_bounds, stop_at_first_bound, wrong_gaps
from gfmd_numba.kernels.laws import exponential_pull, xu_needleman_pull
from gfmd_numba.kernels.near_field import near_field_pressure
from gfmd_numba.kernels.spectral import couple, multiply
from gfmd_numba.kernels.steps import coupled_step, fire_step, verlet_step

__all__ = [
    "bound",
    "cg_direction",
    "cg_gap",
    "cg_update",
    "close_gap",
    "closing_displacement",
    "contact_nodes",
    "couple",
    "coupled_step",
    "damp",
    "descent_curvature",
    "descent_direction",
    "descent_norm",
    "descent_start",
    "descent_trial",
    "descent_update",
    "descent_work",
    "exponential_pull",
    "exponential_sum_factor",
    "exponential_sum_solve",
    "fire_step",
    "free_mean",
    "friction_violation",
    "kkt_violation",
    "level",
    "multiply",
    "near_field_pressure",
    "newton_direction",
    "newton_error",
    "newton_update",
    "open_gap",
    "prescribed_step",
    "prescribed_violation",
    "revise_bounds",
    "revise_contact",
    "stop_at_first_bound",
    "verlet_step",
    "wall_pressure",
    "wrong_gaps",
    "xu_needleman_pull",
]
