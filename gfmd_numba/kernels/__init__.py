"""Every compiled function, and the records that they take: whoever needs one writes `kernels.name`."""

from gfmd_numba.kernels.contact_conditions import *
from gfmd_numba.kernels.eigenstrain import *
from gfmd_numba.kernels.energy_descent import *
from gfmd_numba.kernels.exponential_sums import *
from gfmd_numba.kernels.grids_in_parallel import *
from gfmd_numba.kernels.laws import *
from gfmd_numba.kernels.pressure_solvers import *
from gfmd_numba.kernels.return_mapping import *
from gfmd_numba.kernels.spectral import *
from gfmd_numba.kernels.steps import *
from gfmd_numba.kernels.tiles import *
