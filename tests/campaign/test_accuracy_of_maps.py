"""What `gfmd accuracy` measures on maps: the same studies, with the solvers and the estimators that maps have."""

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.work_precision import study_of
from gfmd_numba.cli import main
from gfmd_numba.solvers.table import able
from support.campaigns import MAPS, campaign

pytestmark = pytest.mark.long  # all read one campaign that takes its time

LEVELS = "reference: {eps_c: 1/4, eps_f: 1/2, eps_t: 1/2}\nlimits: {eps_c: [1/2, 1/8], eps_f: [1, 1/4]}\n"
FIT = "fit: {fixed: {eps_c: [3/2, 5/2], eps_f: [1/2, 3/2]}}\n"


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    folder = tmp_path_factory.mktemp("maps")
    file = folder / "cost.nc"
    said = CliRunner().invoke(
        main, ["accuracy", str(campaign(folder, MAPS + LEVELS + FIT)), "-o", str(file), "--realisations=2"]
    )
    assert said.exit_code == 0, said.output
    assert file.with_suffix(".png").stat().st_size > 10_000
    return xr.load_dataset(file), said.output


def study(dataset, name, curve=None):
    chosen = dataset.isel(point=dataset["study"].values == name)
    return chosen if curve is None else chosen.isel(point=chosen["curve"].values == curve)


def test_maps_are_studied_with_every_solver_that_can_do_them(measured):
    found = study(measured[0], "solver residual")
    assert set(found["curve"].values) == {name.replace("_", " ") for name in able(("dimension 2", "hard wall"))}
    assert "damping of Verlet" in measured[0]["study"].values


@pytest.mark.parametrize("solver", ["active set newton", "conjugate gradients", "truncated newton", "verlet"])
def test_kappa_of_maps_converges_with_the_residual(measured, solver):
    found = study(measured[0], "solver residual", solver)
    assert found["error"][-1] <= found["error"][0]
    assert found["error"][-1] < 1e-8
    assert (np.diff(found["transforms"]) >= 0).all()


def test_counting_the_nodes_of_a_map_needs_a_finer_grid_than_correcting_for_the_perimeter(measured):
    counted, corrected = (study(measured[0], "eps_c", curve) for curve in ("counted", "corrected on average"))
    assert (np.diff(counted["error"]) < 0).all()
    at = counted["setting"] == 0.25
    assert counted["error"][at].item() > 3 * corrected["error"][corrected["setting"] == 0.25].item()
    assert set(study(measured[0], "eps_c")["curve"].values) == {"counted", "corrected on average"}


def test_every_point_of_maps_has_an_error_and_a_time(measured):
    assert np.isfinite(measured[0]["error"]).all()
    assert (measured[0]["seconds"] > 0).all()
    assert (measured[0]["failed"] == 0).all()


@pytest.mark.parametrize(("nodes", "expected"), [(2**12, 16), (2**16, 8), (2**20, 4)])
def test_a_study_of_a_large_grid_has_fewer_surfaces(tmp_path, nodes, expected):
    eps = f"reference: {{eps_c: 1/4, eps_f: 1/{int(nodes**0.5) // 16}, eps_t: 1/2}}\n"
    planned = plan(campaign(tmp_path, MAPS + eps))
    assert planned.cases[0].problem.surface.nodes == nodes
    assert study_of(planned).realisations == expected
