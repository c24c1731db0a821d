"""Fields below maps: time and memory of a section of 101 levels, Hertz's largest shear, and orders in the slope.

python benchmarks/fields_below_maps.py
"""

import time
import tracemalloc
import warnings

import numpy as np

import gfmd_numba
from gfmd_numba.elasticity import fields, topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.fields import DISPLACEMENTS, STRAINS, STRESSES

LEVELS = -(np.linspace(0.0, 1.0, 101) ** 2)


def time_and_memory():
    print("nodes   order   section, s   scan, s   bytes a node, peak of both")
    body, rng = ElasticBody(0.3, None), np.random.default_rng(1)
    for n, order in ((256, 0), (512, 0), (1024, 0), (2048, 0), (256, 1), (256, 2), (256, 3), (512, 2)):
        tractions, heights = rng.standard_normal((3, n, n)), 0.01 / n * rng.standard_normal((n, n))
        tracemalloc.start()
        surface = topography.rough_surface(tractions, heights - heights.mean(), body, order)
        begun = time.perf_counter()
        fields.Periodic(surface, body).section(LEVELS, DISPLACEMENTS + STRAINS + STRESSES, "y", 0.5)
        between = time.perf_counter()
        fields.Periodic(surface, body).largest_von_mises(LEVELS)
        ended, peak = time.perf_counter(), tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        print(f"{n:5}   {order:5}   {between - begun:10.2f}   {ended - between:7.2f}   {peak / n**2:12.0f}")


def hertz():
    print("nodes a radius   largest shear over p0   at depth over a   (Johnson: 0.310 at 0.48)")
    body, radius = ElasticBody(0.3, None), 0.06
    for n in (64, 128, 256, 512):
        x = np.arange(n) / n - 0.5
        pressure = np.sqrt(np.maximum(1.0 - (x**2 + x[:, np.newaxis] ** 2) / radius**2, 0.0))
        none = np.zeros_like(pressure)
        surface = fields.surface_under_tractions(np.stack([none, none, -pressure]), body)
        depth = radius * np.linspace(0.0, 1.5, 151)
        s1, s3 = fields.Periodic(surface, body).section(-depth, ("stress1", "stress3"), "y", 0.5)[..., n // 2]
        shear = 0.5 * abs(s3 - s1)
        print(f"{radius * n:14.1f}   {shear.max():21.4f}   {depth[shear.argmax()] / radius:15.3f}")


def orders():
    print("rms gradient   order   s   transforms   expected error   error, over the largest displacement of order 3")
    for gradient in (0.03, 0.1):
        found, seconds = [], []
        for order in range(4):
            body = {"poissons_ratio": 0.33, "aspect_ratio": 0.5}
            body["roughness"] = {"method": "psd", "hurst": 0.8, "rms_gradient": gradient}
            scene = {"dimension": 2, "body": body, "interface": {"hard_wall": {}}}
            scene["loading"] = {"reduced_pressure": 0.05}
            file = {"scene": scene, "discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 32, "eps_t": 1 / 2}}
            if not found:
                gfmd_numba.solve(file)  # kernels and plans are made
            begun = time.perf_counter()
            found.append(gfmd_numba.solve(file | {"numerics": {"topography_order": order}}))
            seconds.append(time.perf_counter() - begun)
        largest = float(abs(found[-1].displacement).max())
        for order, (each, taken) in enumerate(zip(found, seconds, strict=True)):
            off = float(abs(each.displacement - found[-1].displacement).max()) / largest
            expected = float(each.next_order) / largest
            print(
                f"{gradient:12}   {order:5}   {taken:.1f}   {int(each.n_transforms):10}   {expected:14.1e}   {off:.1e}"
            )


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    time_and_memory()
    hertz()
    orders()
