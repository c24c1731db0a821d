"""Leakage, critical gap and conductance of the same rough maps on three grids. Usage: transport_of_maps.py

H = 0.8, L_x/lambda_l = 4, lambda_l/lambda_s = 8, four surfaces; lengths in g L_x, as the rms gradient is set to 1.
"""

import warnings

import numpy as np

import gfmd_numba

SURFACES, FINENESS, LOADS = 4, (2, 4, 8), (0.02, 0.1, 0.2)


def scene(load, fineness, realisation):
    described = {
        "dimension": 2,
        "body": {"poissons_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 1.0},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": load},
    }
    discretisation = {"eps_c": 1 / fineness, "eps_f": 1 / 8, "eps_t": 1 / 4}
    return {"scene": described, "discretisation": discretisation, "seed": 3, "realisation": realisation}


warnings.simplefilter("ignore")  # of the rms gradient
print("    p*  surface  1/eps_c    area  mean gap   hydraulic gap x, y     critical gap x, y   conductance L_x")
for load in LOADS:
    for surface in range(SURFACES):
        for fineness in FINENESS:
            contact = gfmd_numba.solve(scene(load, fineness, surface))
            flow = gfmd_numba.leakage(contact)["hydraulic_gap"].values
            narrowest = gfmd_numba.gap_percolation(contact)["critical_gap"].values
            conductance = float(gfmd_numba.contact_conductance(contact)["conductance"])
            area, gap = (float(contact[name]) for name in ("contact_area_fraction", "mean_gap"))
            print(
                f"{load:6} {surface:8} {fineness:8} {area:7.4f} {gap:9.5f}   {np.array2string(flow, precision=5)}  "
                f"{np.array2string(narrowest, precision=5)} {conductance:12.4f}",
                flush=True,
            )
