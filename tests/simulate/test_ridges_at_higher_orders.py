"""What acts on a ridge of a map at higher orders in its slope acts as on the profile, along x and along y."""

import numpy as np
import pytest

import gfmd_numba
from support.cases import some_of

NX = 24
X = np.arange(NX) / NX
HEIGHTS = 0.01 * np.cos(2 * np.pi * X) + 0.004 * np.sin(6 * np.pi * X + 0.4)
WALL = {"hard_wall": {}}
SLAB = {"youngs_modulus": 1.0, "poissons_ratio": 0.3, "aspect_ratio": 0.4}
OTHER = {"youngs_modulus": 2.0, "poissons_ratio": 0.4}
LAYERS = {
    "layers": [
        {"height": 0.08, "youngs_modulus": 1.0, "poissons_ratio": 0.2},
        {"height": 0.3, "youngs_modulus": 0.2, "poissons_ratio": 0.45},
    ],
    "base": "rigid",
}
COATED = {
    "layers": [{"height": 0.06, "youngs_modulus": 0.1, "poissons_ratio": 0.5}],
    "base": {"youngs_modulus": 1.0, "poissons_ratio": 0.3},
}
COHESIVE = {"cohesive": {"work_of_adhesion": 1e-4, "normal_length": 8e-3, "tangential_length": 8e-3}}
TRACTIONS = {
    "normal_traction": 2e-3 * np.cos(6 * np.pi * X + 0.2),
    "tangential_traction": 3e-3 * np.sin(4 * np.pi * X) + 1e-4,
}
CASES = {
    "tractions on one of two": {"boundary": True, "counter_body": OTHER},
    "tractions and hardness": {"boundary": True, "interface": {"hard_wall": {"hardness": 0.012}}},
    "layers on two": {"body": LAYERS, "counter_body": COATED},
    "cohesive law": {"interface": COHESIVE, "loading": {"displacement": 2e-3}, "path": True},
    "cohesive law and layers": {"interface": WALL | COHESIVE, "path": True, "body": LAYERS},
}


def solved(case, order, folder, along=None):
    """The contact of a profile, or of its ridge on a map, whose heights vary `along` x or y."""

    def ridge(values):
        whole = values if along is None else np.tile(values, (NX, 1))
        return whole.T.copy() if along == "y" else whole

    end = "_y" if along == "y" else ""
    scene = {"body": SLAB, "interface": WALL, "loading": {"reduced_pressure": 0.05}} | CASES[case]
    scene["dimension"] = 1 if along is None else 2
    scene["body"] = scene["body"] | {
        "roughness": {"method": "measured", "heights": ridge(HEIGHTS), "units": {"z": "L_x"}}
    }
    path = [{f"sliding{end}": 1e-3}] if scene.pop("path", False) else []
    if scene.pop("boundary", False):
        scene["boundary"] = {}
        for name, values in TRACTIONS.items():
            file = folder / f"{name}_{along}.csv"
            np.savetxt(file, ridge(values), delimiter=",")
            scene["boundary"][name + end * name.startswith("tangential")] = str(file)
    numerics = {"residual": 1e-11, "topography_order": order}
    found = gfmd_numba.solve({"scene": scene, "numerics": numerics} | ({"path": path} if path else {}))
    assert (found["status"] == 0).all()
    return found


@pytest.mark.filterwarnings("ignore:a deformable surface has an rms gradient")
@pytest.mark.parametrize("case", some_of(CASES, 2))
@pytest.mark.parametrize(
    ("order", "along", "across"), [pytest.param(1, "x", "y", marks=pytest.mark.long), (2, "y", "x")]
)
def test_a_ridge_is_its_profile(case, order, along, across, tmp_path):
    profile = solved(case, order, tmp_path)
    ridge = solved(case, order, tmp_path, along).isel({across: 3})
    for name in ("pressure", "displacement", "gap", "tangential_displacement", "tangential_traction"):
        own = name + "_y" * (along == "y" and name.startswith("tangential"))
        if own in ridge:
            atol = 1e-8 * float(abs(profile[name]).max())
            np.testing.assert_allclose(ridge[own], profile[name], atol=atol, err_msg=name)
    errors = ridge["next_order"].values, profile["next_order"].values
    if "tangential_displacement" in ridge:
        assert errors[0] == pytest.approx(errors[1], rel=1e-5)
    else:  # that of the normal displacement alone
        assert (errors[0] < (1.0 + 1e-5) * errors[1]).all()


def diagonal(values):
    """Map whose values vary along x + y as those of a profile."""
    return values[np.add.outer(np.arange(NX), np.arange(NX)) % NX]


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:a deformable surface has an rms gradient")
@pytest.mark.parametrize("is_cohesive", [True, False])
def test_a_diagonal_ridge_is_the_profile_of_a_shorter_period(is_cohesive, tmp_path):
    """In units of its period, lengths of the profile, and works of adhesion, are longer by the square root of 2."""
    root, found = np.sqrt(2.0), []
    for stretch, made in ((root, np.asarray), (1.0, diagonal)):
        rough = {"method": "measured", "heights": stretch * made(0.7 * HEIGHTS), "units": {"z": "L_x"}}
        layers = [layer | {"height": stretch * layer["height"]} for layer in LAYERS["layers"]]
        law = {name: stretch * value for name, value in COHESIVE["cohesive"].items()}
        scene = {
            "dimension": rough["heights"].ndim,
            "body": LAYERS | {"layers": layers, "roughness": rough},
            "interface": WALL | {"cohesive": law} if is_cohesive else {"hard_wall": {"hardness": 0.012}},
            "loading": {"displacement": stretch * 2e-3},
        }
        is_map = stretch == 1.0
        way = {"sliding": 1e-3, "sliding_y": 1e-3} if is_map else {"sliding": 2e-3}
        if not is_cohesive:
            along = TRACTIONS["tangential_traction"] * stretch / root
            given = {"normal_traction": TRACTIONS["normal_traction"], "tangential_traction": along}
            given |= {"tangential_traction_y": along} if is_map else {}
            for name, values in given.items():
                np.savetxt(tmp_path / f"{name}_{is_map}.csv", made(values), delimiter=",")
            scene["boundary"] = {name: str(tmp_path / f"{name}_{is_map}.csv") for name in given}
        file = {"scene": scene, "numerics": {"residual": 1e-11, "topography_order": 2}}
        found.append(gfmd_numba.solve(file | ({"path": [way]} if is_cohesive else {})))
        assert (found[-1]["status"] == 0).all()
    profile, ridge = found
    names = ("pressure", "displacement", "gap", "tangential_displacement", "tangential_traction")
    for name in (name for name in names if name in ridge):
        scale = 1.0 if name in ("pressure", "tangential_traction") else root
        expected = profile[name].values / scale
        ends, turned = (("", "_y"), root) if name.startswith("tangential") else (("",), 1.0)
        for end in ends:
            own = turned * ridge[name + end].values[..., 0, :]
            # the shortest wave runs along both diagonals, and a law hands some of it on to others
            atol = (1e-8 if turned == 1.0 else 1e-5) * abs(expected).max()
            np.testing.assert_allclose(own, expected, atol=atol, err_msg=name)
