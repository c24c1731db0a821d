"""Press a rough deformable body of several slopes, heights and orders; write two-step-fields/contact.nc and fields.nc.

Each contact is what `gfmd solve` makes of a scene file, and its fields are those of `gfmd fields`.
"""

import warnings
from pathlib import Path

import xarray as xr

import gfmd_numba

ASPECT_RATIOS, SLOPES, ORDERS = (1.0, 0.05), (0.003, 0.01, 0.03, 0.1, 0.2), (0, 1, 2, 3)
SHOWN = 0.1  # slope whose fields are written, of orders 0 and 2
DISCRETISATION = {"eps_c": 1 / 4, "eps_f": 1 / 32, "eps_t": 1 / 2}  # nx = 512
FOLDER = Path("two-step-fields")


def solve(aspect_ratio: float, slope: float, order: int) -> xr.Dataset:
    """Contact of a flat punch with a body of this height over L_x, rms gradient, and order of its topography."""
    roughness = {"method": "psd", "hurst": 0.8, "rms_gradient": slope}
    scene = {
        "body": {"poissons_ratio": 0.33, "aspect_ratio": aspect_ratio, "roughness": roughness},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.1},
    }
    numerics = {"topography_order": order, "residual": 1e-10}
    with warnings.catch_warnings(action="ignore", category=UserWarning):  # of steep slopes: what they do is the subject
        return gfmd_numba.solve({"scene": scene, "numerics": numerics, "discretisation": DISCRETISATION, "seed": 2018})


def fields(contact: xr.Dataset) -> xr.Dataset:
    """Fields over the share of the height below the surface, so that bodies of all heights fit into one file."""
    found = gfmd_numba.body_fields(contact)
    level = abs(found["z"] / found["z"].min()).round(12)
    return found.assign_coords(level=level).swap_dims(z="level").reset_coords("z")


def main() -> None:
    """Write both files."""
    contacts, inside = [], []
    for aspect_ratio in ASPECT_RATIOS:
        for slope in SLOPES:
            for order in ORDERS:
                at = {"aspect_ratio": [aspect_ratio], "slope": [slope], "topography_order": [order]}
                contact = solve(aspect_ratio, slope, order)
                contacts.append(contact.expand_dims(at))
                if slope == SHOWN and order in (0, 2):
                    del at["slope"]
                    inside.append(fields(contact).expand_dims(at))
    FOLDER.mkdir(exist_ok=True)
    for name, parts in (("contact", contacts), ("fields", inside)):
        whole = xr.combine_by_coords(
            parts, combine_attrs="drop_conflicts", join="exact", compat="no_conflicts", coords="different"
        )
        whole.to_netcdf(FOLDER / f"{name}.nc", engine="netcdf4")


if __name__ == "__main__":
    main()
