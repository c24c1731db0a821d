"""Every compiled function, and the records that they take."""

from gfmd_numba.kernels.conditions import Conditions, State, wall_pressure, wall_violation
from gfmd_numba.kernels.decays import (
    Decays,
    DecaySum,
    Factors,
    Level,
    Lists,
    Task,
    Values,
    decay_contact,
    decay_product,
    exponential_sum_factor,
    exponential_sum_solve,
    least_squares,
    parallel_solve,
    refined_pressure,
    touching_displacement,
)
from gfmd_numba.kernels.eigenstrain import Waves, reflect, strains, waves_upwards
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
from gfmd_numba.kernels.laws import exponential_pull, xu_needleman_pull
from gfmd_numba.kernels.plastic_flow import Hardening, return_to_yield
from gfmd_numba.kernels.pressures import (
    Iterate,
    bound,
    cg_direction,
    cg_free,
    cg_gap,
    cg_update,
    close_gap,
    closing_displacement,
    contact_nodes,
    damp,
    level,
    newton_direction,
    newton_error,
    newton_update,
    open_gap,
    revise_bounds,
    revise_contact,
    stop_at_first_bound,
    wrong_gaps,
)
from gfmd_numba.kernels.spectral import (
    count,
    couple,
    multiply,
    multiply_columns,
    multiply_map,
    power,
    power_of_columns,
    put_columns,
    take_columns,
)
from gfmd_numba.kernels.splines import spline_slopes
from gfmd_numba.kernels.steps import fire_step, friction_step, verlet_step
from gfmd_numba.kernels.tiles import (
    close_map,
    gather_back,
    level_of_contact,
    list_tiles,
    mark_contact,
    mark_loaded,
    move_tiles,
    near_field_pressure,
    open_map,
    pack_rows,
    put_tiles,
    refine_pressure,
    restore_map,
    soften_tiles,
    spread,
    sum_tiles,
    surround,
    take_tiles,
    tile_stencil,
    tractions_around,
)
