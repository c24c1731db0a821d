"""Every compiled function, and the records that they take."""

from gfmd_numba.kernels.active_sets import (
    Iterate,
    closing_displacement,
    contact_nodes,
    newton_direction,
    newton_error,
    newton_update,
    open_gap,
    revise_contact,
)
from gfmd_numba.kernels.boundary_value_problem import Boundary, free_mean, prescribed_step, prescribed_violation
from gfmd_numba.kernels.conditions import CoupledState, State, friction_violation, kkt_violation, wall_pressure
from gfmd_numba.kernels.decay_contacts import decay_contact, refined_pressure, touching_displacement
from gfmd_numba.kernels.decay_sums import decay_product
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
from gfmd_numba.kernels.gradients import cg_direction, cg_free, cg_gap, cg_update, close_gap
from gfmd_numba.kernels.hardness import bound, damp, level, revise_bounds, stop_at_first_bound, wrong_gaps
from gfmd_numba.kernels.laws import exponential_pull, xu_needleman_pull
from gfmd_numba.kernels.least_squares import least_squares
from gfmd_numba.kernels.maps import (
    close_map,
    level_of_contact,
    mark_contact,
    mark_loaded,
    move_tiles,
    open_map,
    pack_rows,
    put_tiles,
    refine_pressure,
    take_tiles,
)
from gfmd_numba.kernels.near_field import near_field_pressure
from gfmd_numba.kernels.parallel_stiffness import parallel_solve
from gfmd_numba.kernels.spectral import count, couple, multiply, power, soften, stiffen
from gfmd_numba.kernels.steps import coupled_step, fire_step, verlet_step
from gfmd_numba.kernels.tile_newton import (
    closing_residual,
    revise_tiles,
    tile_direction,
    tile_error,
    tile_update,
)
from gfmd_numba.kernels.tiles import (
    gather_back,
    list_tiles,
    soften_tiles,
    spread,
    sum_tiles,
    surround,
    tile_stencil,
)

__all__ = [
    "Boundary",
    "CoupledState",
    "Iterate",
    "State",
    "bound",
    "cg_direction",
    "cg_free",
    "cg_gap",
    "cg_update",
    "close_gap",
    "close_map",
    "closing_displacement",
    "closing_residual",
    "contact_nodes",
    "count",
    "couple",
    "coupled_step",
    "damp",
    "decay_contact",
    "decay_product",
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
    "gather_back",
    "kkt_violation",
    "least_squares",
    "level",
    "level_of_contact",
    "list_tiles",
    "mark_contact",
    "mark_loaded",
    "move_tiles",
    "multiply",
    "near_field_pressure",
    "newton_direction",
    "newton_error",
    "newton_update",
    "open_gap",
    "open_map",
    "pack_rows",
    "parallel_solve",
    "power",
    "prescribed_step",
    "prescribed_violation",
    "put_tiles",
    "refine_pressure",
    "refined_pressure",
    "revise_bounds",
    "revise_contact",
    "revise_tiles",
    "soften",
    "soften_tiles",
    "spread",
    "stiffen",
    "stop_at_first_bound",
    "sum_tiles",
    "surround",
    "take_tiles",
    "tile_direction",
    "tile_error",
    "tile_stencil",
    "tile_update",
    "touching_displacement",
    "verlet_step",
    "wall_pressure",
    "wrong_gaps",
    "xu_needleman_pull",
]
