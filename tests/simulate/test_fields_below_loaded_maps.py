"""Fields below maps with prescribed tractions, with and without a punch, and under a law of gap and slip."""

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.analysis import plot_body
from gfmd_numba.scene import InputError
from support.command_line import gfmd
from support.legible import faults

pytestmark = pytest.mark.usefixtures("undrawn")

N = 32
Y, X = np.meshgrid(np.arange(N) / N, np.arange(N) / N, indexing="ij")
GIVEN = {
    "normal_traction": 2e-3 * np.cos(2 * np.pi * (3 * X + Y) + 0.2),
    "tangential_traction": 3e-3 * np.sin(4 * np.pi * Y) + 1e-3,
    "tangential_traction_y": 2e-3 * np.cos(2 * np.pi * X) - 2e-3,
}
SLAB = {"poissons_ratio": 0.3, "aspect_ratio": 0.5}
LAYERS = {
    "layers": [
        {"height": 0.1, "youngs_modulus": 5.0, "poissons_ratio": 0.3},
        {"height": 0.4, "youngs_modulus": 1.0, "poissons_ratio": 0.45},
    ],
    "base": "rigid",
}
ROUGH = {"roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}, "loading": {"reduced_pressure": 0.1}}
EPS = {"eps_c": 0.5, "eps_f": 0.25, "eps_t": 0.5}  # 32 nodes both ways
COHESIVE = {"cohesive": {"work_of_adhesion": 2e-7, "normal_length": 1e-4, "tangential_length": 2e-4}}


def save(folder, arrays):
    for name, array in arrays.items():
        np.save(folder / f"{name}.npy", array)
    return {name: str(folder / f"{name}.npy") for name in arrays}


def loaded(folder, body=SLAB, given=GIVEN):
    return gfmd_numba.solve({"scene": {"dimension": 2, "body": body, "boundary": save(folder, given)}})


def pressed(folder, interface, body=SLAB, given=GIVEN, path=(), **loading):
    scene = {"dimension": 2, "body": body, "interface": {"hard_wall": {}} | interface} | ROUGH
    scene |= {"boundary": save(folder, given)} if given else {}
    scene |= {"loading": loading} if loading else {}
    numerics = {"residual": 1e-9}
    return gfmd_numba.solve({"scene": scene, "discretisation": EPS, "path": list(path), "numerics": numerics})


def check_surface(fields, tractions, displacements):
    """Stresses at the surface are the tractions there, displacements those of the contact."""
    line, largest = {"y": fields.y.item()}, max(abs(each).max().item() for each in tractions)
    for stress, traction in zip(("stress_5", "stress_4", "stress_3"), tractions, strict=True):
        np.testing.assert_allclose(fields[stress].sel(z=0.0), traction.sel(line), atol=1e-12 * largest)
    moved = max(abs(each).max().item() for each in displacements.values())
    for component, displacement in displacements.items():
        found = fields[f"displacement_{component}"]
        np.testing.assert_allclose(found.sel(z=0.0), displacement.sel(line), atol=1e-7 * moved)
        np.testing.assert_allclose(found.isel(z=-1), 0.0, atol=1e-12 * moved)


def test_below_a_loaded_map_tractions_and_displacements_are_those_of_the_surface(tmp_path):
    held = np.where(np.hypot(X - 0.5, Y - 0.5) < 0.2, -1e-3, np.nan)
    for given in (
        GIVEN,
        {**GIVEN, "normal_traction": np.where(np.isnan(held), 0.0, np.nan), "normal_displacement": held},
    ):
        contact = loaded(tmp_path, LAYERS, given)
        fields = gfmd_numba.body_fields(contact, [0.0, -0.2, -0.5], y=0.5)
        names = ("tangential_{}", "tangential_{}_y", "normal_{}")
        displacements = {i + 1: contact[name.format("displacement")] for i, name in enumerate(names)}
        check_surface(fields, [contact[name.format("traction")] for name in names], displacements)
        np.testing.assert_allclose(fields.pressure, -contact.normal_traction.sel(y=0.5), atol=0.0)


def test_below_a_loaded_half_space_a_wave_is_that_of_the_closed_form(tmp_path):
    """Under t cos(q x) the stresses along z are t (1 + q d) exp(-q d) at a depth d (Johnson 1985, chapter 2)."""
    wave = {"normal_traction": 1e-3 * np.cos(2 * np.pi * (3 * X + 4 * Y))}
    contact = loaded(tmp_path, {"poissons_ratio": 0.3}, wave)
    planes = gfmd_numba.body_fields(contact, planes=[-0.01, -0.05])
    for depth in (0.01, 0.05):
        decay = (1 + 10 * np.pi * depth) * np.exp(-10 * np.pi * depth)
        np.testing.assert_allclose(planes.stress_3.sel(z=-depth), decay * wave["normal_traction"], atol=1e-14)
    assert planes.pressure.dims == ("y", "x")


@pytest.mark.parametrize("along", ["x", "y"])
def test_a_loaded_ridge_has_the_fields_of_its_profile(tmp_path, along):
    x = np.arange(N) / N
    t1, t3 = 1e-3 * np.sin(2 * np.pi * x) + 2e-3, 1e-3 * np.cos(6 * np.pi * x) - 1e-3
    boundary = save(tmp_path, {"t1": t1, "t3": t3})
    boundary = {"tangential_traction": boundary["t1"], "normal_traction": boundary["t3"]}
    profile = gfmd_numba.body_fields(gfmd_numba.solve({"scene": {"body": SLAB, "boundary": boundary}}), [0.0, -0.1])
    name = "tangential_traction" if along == "x" else "tangential_traction_y"
    ridge = {name: np.tile(t1, (N, 1)), "normal_traction": np.tile(t3, (N, 1))}
    ridge = ridge if along == "x" else {key: array.T for key, array in ridge.items()}
    found = gfmd_numba.body_fields(loaded(tmp_path, SLAB, ridge), [0.0, -0.1], **{"y" if along == "x" else "x": 0.25})
    turned = (
        {} if along == "x" else {"displacement_1": "displacement_2", "strain_5": "strain_4", "stress_1": "stress_2"}
    )
    for field in ("displacement_1", "displacement_3", "strain_5", "stress_1", "stress_3", "von_mises"):
        given = found[turned.get(field, field)]
        np.testing.assert_allclose(given, profile[field], atol=1e-10 * abs(profile[field]).max(), err_msg=field)


@pytest.mark.parametrize(
    ("friction", "loading"),
    [({}, {"displacement": 3e-3}), ({"friction": {"coefficient": 0.2}}, {"reduced_pressure": 0.1})],
    ids=["frictionless", "friction"],
)
def test_tractions_under_a_punch_add_to_its_own(tmp_path, friction, loading):
    contact = pressed(tmp_path, friction, **loading)
    fields = gfmd_numba.body_fields(contact, [0.0, -0.2, -0.5], y=0.25)
    tractions = [contact[f"prescribed_{name}"] for name in ("tangential_traction", "tangential_traction_y")]
    displacements = {3: contact.displacement}
    if friction:
        tractions = [
            each + contact[f"tangential_traction{end}"] for each, end in zip(tractions, ("", "_y"), strict=True)
        ]
        displacements |= {1: contact.tangential_displacement, 2: contact.tangential_displacement_y}
    normal = contact.prescribed_normal_traction - contact.pressure
    check_surface(fields, [*tractions, normal], displacements)
    np.testing.assert_allclose(fields.pressure, -normal.sel(y=0.25), atol=0.0)


@pytest.mark.long
def test_below_a_cohesive_map_every_step_has_its_tractions_and_displacements(tmp_path):
    path = [{"sliding": 2e-4, "sliding_y": -1e-4}, {"reduced_pressure": 0.05}]
    contact = pressed(tmp_path, COHESIVE, given=None, path=path)
    fields = gfmd_numba.body_fields(contact, [0.0, -0.2, -0.5], y=0.25)
    assert abs(contact.tangential_traction_y[1]).max() > 0.1 * abs(contact.tangential_traction[1]).max() > 0.0
    for i in range(3):
        step = contact.isel(step=i)
        displacements = {3: step.displacement, 1: step.tangential_displacement, 2: step.tangential_displacement_y}
        tractions = [step.tangential_traction, step.tangential_traction_y, -step.pressure]
        check_surface(fields.isel(step=i), tractions, displacements)
    assert contact.pressure.min() < 0.0


@pytest.mark.parametrize("name", GIVEN)
def test_a_traction_that_was_dropped_is_missed(tmp_path, name):
    other = pressed(tmp_path, {})
    for contact, dropped in ((loaded(tmp_path), name), (other, f"prescribed_{name}")):
        with pytest.raises(InputError, match=r"contact: you gave (a contact that was altered|no results)"):
            gfmd_numba.body_fields(contact.drop_vars(dropped))
    with pytest.raises(InputError, match=r"body: you gave 'counter_body'; gfmd allows 'body'"):
        gfmd_numba.body_fields(other, body="counter_body")


@pytest.mark.long
def test_the_command_draws_the_section_and_planes_below_a_loaded_map(tmp_path):
    loaded(tmp_path).to_netcdf(tmp_path / "loaded.nc")
    for name, options in (("section", ()), ("planes", ("--plane", "-0.1"))):
        output = tmp_path / f"{name}.nc"
        said = gfmd("fields", tmp_path / "loaded.nc", "-o", output, *options)
        assert said.exit_code == 0, said.output
        with xr.open_dataset(output) as fields:
            assert faults(plot_body(fields)) == []
