"""What the functions of the package say of arguments of another kind than theirs."""

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.analysis import plot_curve, plot_fit, secant_stiffness
from gfmd_numba.scene import InputError
from gfmd_numba.storage.atomic_file import write_dataset
from support.campaigns import campaign
from support.cases import some_of

SCENE = {
    "body": {"poissons_ratio": 0.3, "aspect_ratio": 1.0},
    "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
    "interface": {"hard_wall": {}},
    "loading": {"reduced_pressure": 0.1},
    "discretisation": {"eps_c": 0.5, "eps_f": 0.25, "eps_t": 1},
}
WRONG = [np.zeros(64), None, 3, 0.5, [], ["scene.yaml"], b"scene.yaml", object(), {1, 2}, lambda: None]
OF_A_CONTACT = (
    gfmd_numba.contact_statistics,
    gfmd_numba.gap_percolation,
    gfmd_numba.leakage,
    gfmd_numba.contact_conductance,
    gfmd_numba.body_fields,
)


@pytest.mark.parametrize("given", WRONG, ids=lambda given: type(given).__name__)
def test_what_is_neither_a_file_nor_a_mapping_is_no_scene(given):
    with pytest.raises(InputError, match=r"scene: you gave .*; gfmd allows the path of a YAML file, or a mapping"):
        gfmd_numba.solve(given)
    with pytest.raises(InputError, match=r"surface: you gave .*; gfmd allows the path of a YAML file, or a mapping"):
        gfmd_numba.make_surface(given)


@pytest.mark.parametrize("given", [{}, {"scene": np.zeros(3)}, {1: 2}, {"body": None}, xr.Dataset({"x": 1}), {None: 0}])
def test_a_mapping_of_something_else_is_no_scene(given):
    for function in (gfmd_numba.solve, gfmd_numba.make_surface):
        with pytest.raises(InputError, match=r"gfmd (allows|needs) "):
            function(given)


@pytest.mark.parametrize("given", [*WRONG, {}], ids=lambda given: type(given).__name__)
@pytest.mark.parametrize("function", [gfmd_numba.fit_tfc, *OF_A_CONTACT])
def test_what_is_no_dataset_is_told_who_makes_one(function, given):
    with pytest.raises(
        InputError, match=r"you gave .*; gfmd allows an xarray.Dataset, as gfmd_numba\.(open_campaign|solve)"
    ):
        function(given)


@pytest.mark.parametrize("given", WRONG, ids=lambda given: type(given).__name__)
def test_what_is_no_path_is_no_campaign(given):
    with pytest.raises(InputError, match=r"path: you gave .*; gfmd allows a netCDF file, or the output directory"):
        gfmd_numba.open_campaign(given)


def test_a_contact_is_no_campaign(tmp_path):
    write_dataset(tmp_path / "contact.nc", gfmd_numba.solve(SCENE))
    with pytest.raises(InputError, match=r"contact.nc: you gave a file without results of a campaign; gfmd allows"):
        gfmd_numba.open_campaign(tmp_path / "contact.nc")


def test_a_dataset_in_chunks_is_loaded():
    chunked = gfmd_numba.solve(SCENE).chunk()
    assert gfmd_numba.contact_statistics(chunked).identical(gfmd_numba.contact_statistics(chunked.compute()))


@pytest.mark.parametrize("z", ["deep", [[-0.1]], [-0.1, None], object(), np.array(["a"]), 1j, [-2.0], 0.1, np.nan])
def test_heights_that_are_none_are_told(z):
    contact = gfmd_numba.solve(SCENE)
    with pytest.raises(InputError, match=r"z: you gave .*; gfmd allows "):
        gfmd_numba.body_fields(contact, z)
    with pytest.raises(InputError, match=r"body: you gave .*; gfmd allows 'body'"):
        gfmd_numba.body_fields(contact, -0.1, z)


@pytest.mark.parametrize("scene", ["", "{}", "[", "3", '{"scene": 1}'])
def test_results_with_another_scene_are_told(scene):
    contact = gfmd_numba.solve(SCENE).assign_attrs(scene=scene)
    with pytest.raises(InputError, match="contact: you gave a contact whose scene is unreadable"):
        gfmd_numba.body_fields(contact)


@pytest.mark.parametrize(
    ("function", "said"),
    [
        (gfmd_numba.fit_tfc, "you gave no results of a campaign; gfmd allows what a finished `gfmd run` leaves"),
        (gfmd_numba.contact_statistics, "you gave no results of a contact; gfmd allows what `gfmd solve` leaves"),
        (gfmd_numba.gap_percolation, "you gave no results of a map's contact; gfmd allows what `gfmd solve` leaves"),
        (gfmd_numba.leakage, "you gave no results of a contact; gfmd allows what `gfmd solve` leaves of one"),
        (gfmd_numba.contact_conductance, "you gave no results of a contact; gfmd allows what `gfmd solve` leaves of"),
        (secant_stiffness, "you gave no results of several loads; gfmd allows a campaign's, or those of a path"),
        (plot_fit, "you gave no fit; gfmd allows what `gfmd fit -o` leaves"),
        (plot_curve, "you gave no load curve; gfmd allows what `gfmd curve` leaves"),
    ],
)
def test_a_dataset_of_another_kind_is_an_error_of_the_input(function, said):
    with pytest.raises(InputError, match=said):
        function(xr.Dataset())


@pytest.mark.parametrize(
    "function", some_of([gfmd_numba.fit_tfc, gfmd_numba.contact_statistics, gfmd_numba.body_fields], 0, 1)
)
def test_a_path_stands_for_the_results_in_it(tmp_path, function):
    with pytest.raises(InputError, match=r"absent.nc: you gave a path that cannot be read"):
        function(tmp_path / "absent.nc")
    if function is gfmd_numba.fit_tfc:
        path = tmp_path / "out"
        results = gfmd_numba.run(campaign(tmp_path, **{"[0.3, 0.8]": "[0.8]"}), path)
    else:
        path = tmp_path / "contact.nc"
        results = gfmd_numba.solve(SCENE)
        results.to_netcdf(path, engine="netcdf4")
    of_path, of_dataset = (function(given).drop_vars("seconds", errors="ignore") for given in (path, results))
    xr.testing.assert_allclose(of_path, of_dataset)
