"""What `gfmd accuracy` measures: errors that fall with the setting, and a file and a picture of them."""

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from gfmd_numba.cli import main
from support.campaigns import campaign

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    folder = tmp_path_factory.mktemp("accuracy")
    file = folder / "cost.nc"
    said = CliRunner().invoke(main, ["accuracy", str(campaign(folder)), "-o", str(file), "--realisations=4"])
    assert said.exit_code == 0, said.output
    assert file.with_suffix(".png").stat().st_size > 10_000
    return xr.load_dataset(file), said.output


def study(dataset, name, curve=None):
    chosen = dataset.isel(point=dataset["study"].values == name)
    return chosen if curve is None else chosen.isel(point=chosen["curve"].values == curve)


@pytest.mark.parametrize("solver", ["active set newton", "conjugate gradients", "verlet", "gronbech jensen", "fire"])
def test_kappa_converges_with_the_residual(measured, solver):
    found = study(measured[0], "solver residual", solver)
    assert found["setting"].values.tolist() == [1e-2, 1e-3, 1e-4, 1e-6, 1e-8]
    assert found["error"][-1] < 1e-6
    assert found["error"][-1] <= found["error"][0]
    assert (np.diff(found["transforms"]) >= 0).all()


def test_counting_needs_a_finer_grid_than_correcting(measured):
    counted, corrected = (study(measured[0], "eps_c", curve) for curve in ("counted", "corrected on average"))
    assert (np.diff(counted["error"]) < 0).all()
    at = counted["setting"] == 0.25
    assert counted["error"][at].item() > 3 * corrected["error"][at].item()


def test_damping_and_time_step_change_the_cost_but_not_the_result(measured):
    found = study(measured[0], "damping of Verlet")
    assert (found["error"] < 1e-6).all()
    assert found["transforms"].max() > 10 * found["transforms"].min()


def test_sampling_error_falls_as_the_root_of_the_number(measured):
    found = study(measured[0], "surfaces")
    np.testing.assert_allclose(found["error"] * np.sqrt(found["setting"]), found["error"][0].item() * 2, rtol=1e-12)
