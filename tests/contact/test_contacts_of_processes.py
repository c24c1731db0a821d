"""One contact that several processes share: the surface, the nodes and the numbers of one."""

import numpy as np
import pytest

from gfmd_numba import simulate
from gfmd_numba.arrays.processes import Slab
from gfmd_numba.contact import distributed
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.scene import InputError, load_scene
from gfmd_numba.solvers.distributed_newton import halvings
from gfmd_numba.solvers.status import Status
from support.cases import some_of
from support.team_of_threads import together

SCENE = """scene:
  dimension: 2
  body: {poissons_ratio: 0.33, aspect_ratio: 0.2}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.05}
discretisation: {eps_c: 1/4, eps_f: 1/8, eps_t: 1/2}
"""


def _loaded(folder, old="", new=""):
    file = folder / "map.yaml"
    file.write_text(SCENE.replace(old, new) if old else SCENE)
    return load_scene(file)


@pytest.mark.parametrize(("nx", "largest", "anisotropy"), [(32, 8, 1.0), (32, 16, 2.0), (20, 7, 1.0)])
def test_each_process_makes_its_rows_of_the_surface_to_the_last_bit(nx, largest, anisotropy):
    """Also where the shortest wave is that of Nyquist."""
    surface = RandomSurface(SelfAffineWaves(0.8, 2.0, largest, anisotropy), nx, 7, 2)
    expected = surface.heights(range(3, 4))[0]
    for size in (1, 3):
        rows = together(size, lambda member: distributed.slab_heights(surface, Slab.of(member, nx), 3))
        np.testing.assert_array_equal(np.concatenate(rows), expected)


@pytest.mark.parametrize(
    ("old", "new"), some_of([("0.33, aspect_ratio: 0.2", "0.3"), ("0.05", "0.3"), ("eps_t: 1/2", "eps_t: 1/3")], 2)
)
def test_processes_find_the_nodes_and_numbers_of_one(tmp_path, old, new):
    """On a slab, a half-space, at a large load, and on a grid that has an odd number of nodes once halved."""
    described = _loaded(tmp_path, old, new)
    expected = simulate.solve(*described)
    several = [together(size, lambda member: simulate.solve_in_processes(*described, member)) for size in (1, 3)]
    found, (first, *others) = several[0][0], several[1]
    assert others == [None, None]
    assert int(found["status"]) == Status.ok
    np.testing.assert_array_equal(found["height"], expected["height"])
    np.testing.assert_array_equal(found["pressure"] > 0.0, expected["pressure"] > 0.0)
    for name in ("pressure", "displacement", "gap", "kappa", "elastic_energy", "mean_gap", "full_contact_rms_pressure"):
        size = float(abs(expected[name]).max())
        np.testing.assert_allclose(found[name], expected[name], atol=1e-7 * size)
        np.testing.assert_array_equal(first[name], found[name])
    assert set(found.variables) == set(expected.variables)
    assert found.attrs["validity"] == expected.attrs["validity"]


@pytest.mark.parametrize(
    ("ny", "nx", "processes", "times"),
    [(64, 512, 1, 0), (512, 512, 1, 3), (512, 384, 1, 3), (768, 729, 1, 0), (729, 768, 1, 0), (512, 512, 64, 1)],
)
def test_a_grid_is_halved_while_it_is_even_and_large_and_each_process_keeps_rows_for_its_neighbours(
    ny, nx, processes, times
):
    assert halvings(ny, nx, processes) == times


def test_a_run_without_iterations_enough_says_so(tmp_path):
    described = _loaded(tmp_path, "discretisation", "numerics: {max_iterations: 3}\ndiscretisation")
    (found,) = together(1, lambda member: simulate.solve_in_processes(*described, member))
    assert int(found["status"]) == Status.steps_used_up
    assert int(found["n_iterations"]) == 3


@pytest.mark.parametrize(
    ("old", "new", "allowed"),
    [
        ("dimension: 2", "dimension: 1", "dimension 2"),
        ("hard_wall: {}", "hard_wall: {}, friction: {coefficient: 0.1}", "no friction"),
        ("rms_gradient: 0.01", "rms_height: 0.01", "a self-affine surface, method psd, with an rms_gradient"),
        ("reduced_pressure: 0.05", "displacement: 0.001", "a reduced_pressure, pressure or force"),
        ("discretisation", "path: [{reduced_pressure: 0.1}]\ndiscretisation", "no path"),
        ("discretisation", "numerics: {threads: 2}\ndiscretisation", "1 with `--mpi`"),
        ("discretisation", "numerics: {solver: conjugate_gradients}\ndiscretisation", "auto with `--mpi`"),
        ("hurst: 0.8, ", "hurst: 0.8, scaling: ensemble, ", "a self-affine surface"),
    ],
)
def test_what_processes_do_not_share_is_refused_in_all(tmp_path, old, new, allowed):
    described = _loaded(tmp_path, old, new)

    def refused(member):
        with pytest.raises(InputError) as error:
            simulate.solve_in_processes(*described, member)
        return str(error.value)

    first, second = together(2, refused)
    assert first == second
    assert allowed in first


def test_more_processes_than_there_are_rows_for_are_refused(tmp_path):
    described = _loaded(tmp_path, "eps_f: 1/8", "eps_f: 1/2")

    def refused(member):
        with pytest.raises(InputError, match="--mpi: you gave 17 processes; gfmd allows at most 16"):
            simulate.solve_in_processes(*described, member)

    together(17, refused)
