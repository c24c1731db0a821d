"""Under a law that keeps the surfaces apart nothing is told or drawn of touching nodes, of which there are none."""

import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.analysis import plot_contact, plot_statistics
from gfmd_numba.analysis.plots.campaign import _told
from gfmd_numba.cli.tables import of_contact, of_measures

pytestmark = pytest.mark.usefixtures("undrawn")

SCENE = {
    "scene": {
        "length": 1e-7,
        "dimension": 2,
        "body": {"youngs_modulus": 3e9, "poissons_ratio": 0.4},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05},
        "interface": {"lennard_jones": {"work_of_adhesion": 0.02, "range": 2e-9}},
        "loading": {"pressure": 5e6},
    },
    "discretisation": {"eps_c": 1 / 2, "eps_f": 1 / 4, "eps_t": 1 / 2},
}


@pytest.fixture(scope="module")
def contact():
    return gfmd_numba.solve(SCENE)


def test_the_terminal_is_silent_about_areas_and_spots(contact):
    assert float(contact["gap"].min()) > 0.0
    told = {line.label for line in of_contact(contact)}
    assert {"mean gap", "peak pressure", "elastic energy"} <= told
    assert not {"contact area fraction", "contacts", "kappa", "kappa_r"} & told
    measured = {line.label for line in of_measures(gfmd_numba.contact_statistics(contact))}
    assert measured == {"mean gap over rms height"}


def test_pictures_have_no_empty_panels(contact):
    (gaps,) = plot_statistics(gfmd_numba.contact_statistics(contact)).axes
    assert gaps.get_xlabel() == "Gap over rms height"
    labels = [axis.get_xlabel() for axis in plot_contact(contact).axes]
    assert labels.count("Gap over rms height") == 1
    assert not any("contact" in label or "Cluster" in label for label in labels)


def test_conductance_says_why_it_is_zero(contact):
    with pytest.warns(UserWarning, match="Nothing touches"):
        assert gfmd_numba.contact_conductance(contact)["conductance"].item() == 0.0


def test_a_small_parameter_is_a_power_of_ten_in_a_legend():
    label = {"label": r"$\Delta\gamma$", "units": "1"}
    axis = xr.DataArray([1e-7, 2.5e-7], dims="case", name="work_of_adhesion", attrs=label)
    assert _told([(axis, 1e-7)]) == r"$\Delta\gamma = 10^{-7}$"
    assert _told([(axis, 2.5e-7)]) == r"$\Delta\gamma = 2.5 \times 10^{-7}$"
