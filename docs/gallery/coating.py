"""How the modulus of a coating changes the contact area.

A substrate that is softer than its coating makes the contact area larger, because the coating bends into the
valleys. A stiffer substrate makes it smaller. Loads are in units of the coating's modulus.
"""

import numpy as np
from matplotlib.figure import Figure

import gfmd_numba

ratios = [0.1, 0.3, 1.0, 3.0, 10.0]  # modulus of the substrate over that of the coating
kappa = []
for ratio in ratios:
    scene = {
        "scene": {
            "body": {
                "layers": [{"height": 0.05, "youngs_modulus": 1.0, "poissons_ratio": 0.3}],
                "base": {"youngs_modulus": ratio, "poissons_ratio": 0.3},
            },
            "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
            "interface": {"hard_wall": {}},
            "loading": {"reduced_pressure": 0.1},
        },
        "discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 32, "eps_t": 1},
    }
    kappa.append(float(gfmd_numba.solve(scene)["kappa"]))
print(np.round(kappa, 3))

figure = Figure((7, 4), layout="constrained")
axis = figure.subplots()
axis.semilogx(ratios, kappa, "o-", color="#0072B2")
axis.axhline(kappa[ratios.index(1.0)], color="0.4", ls="--", label="one material")
axis.set(xlabel="Modulus of the substrate over that of the coating", ylabel=r"$\kappa$, area over load")
axis.legend()
figure.savefig("coating.png", dpi=80)
