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
from gfmd_numba.kernels.conditions import Conditions, State, wall_pressure, wall_violation
from gfmd_numba.kernels.decay_contacts import (
    DecaySum,
    Level,
    Lists,
    Task,
    Values,
    decay_contact,
    refined_pressure,
    touching_displacement,
)
from gfmd_numba.kernels.decay_sums import decay_product
from gfmd_numba.kernels.energy_descent import (
    Unknowns,
    descent_curvature,
    descent_direction,
    descent_norm,
    descent_start,
    descent_trial,
    descent_update,
    descent_work,
)
from gfmd_numba.kernels.exponential_sum import Decays, Factors, exponential_sum_factor, exponential_sum_solve
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
from gfmd_numba.kernels.steps import fire_step, friction_step, verlet_step
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
