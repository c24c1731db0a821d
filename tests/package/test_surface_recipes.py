"""The recipes of docs/architecture.md for a generator, a spectrum and an axis, followed on a copy of the package."""

import pytest
import xarray as xr

from support.recipes import Recipe, command_after

GENERATOR = Recipe(
    "roughness/random_phases.py",
    '''\
"""Self-affine surfaces whose waves have fixed amplitudes and random phases."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from gfmd_numba.fourier import grid
from gfmd_numba.roughness.amplitudes import waves
from gfmd_numba.roughness.generators import band
from gfmd_numba.roughness.self_affine import SelfAffineWaves


@dataclass(frozen=True)
class RandomPhases:
    """Waves of a power law, of which only the phases are random."""

    unit_gradient: ClassVar = False
    law: SelfAffineWaves

    @property
    def hurst(self):
        return self.law.hurst

    @property
    def band(self):
        return self.law.band

    def heights(self, shape, seed, realisations):
        envelope, largest = np.sqrt(self.power(shape)), self.law.shortest_wave_index
        phases = [np.exp(1j * np.angle(waves(seed, each, shape, largest))) for each in realisations]
        return np.stack([grid.signal(envelope * phase, *shape) for phase in phases])

    def mean_square_height(self, shape):
        return 1.0

    def power(self, shape):
        return self.law.power(shape)

    def without_shortest(self, halvings):
        law = self.law.without_shortest(halvings)
        return None if law is None else replace(self, law=law)


def generator(record, discretisation, dimension, nx):
    longest, shortest = band(record, discretisation)
    return RandomPhases(SelfAffineWaves(record.hurst, longest, int(shortest)))
''',
    "scene/surfaces.py",
    (
        (
            '''\
class RandomPhases(PowerLaw):
    """Power law whose waves have fixed amplitudes and random phases."""

    implementation: ClassVar = "gfmd_numba.roughness.random_phases:generator"
    method: Literal["random_phases"] = Field(description="How the surface is made")


''',
            "def _self_affine_by_default(",
        ),
        ("RandomPhases | ", "Recursive | Measured,"),
    ),
)
SPECTRUM = Recipe(
    "roughness/gaussian.py",
    '''\
"""Model with a Gaussian autocorrelation."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gfmd_numba.roughness.model_surfaces import ModelWaves


@dataclass(frozen=True)
class Gaussian:
    """Autocorrelation exp(-(r / xi)^2)."""

    isotropic: ClassVar = True
    hurst: ClassVar = 1.0
    dimension: int
    correlation_length: float

    def autocorrelation(self, distance):
        return np.exp(-((distance / self.correlation_length) ** 2))

    def psd(self, q):
        xi = self.correlation_length
        return (xi / np.sqrt(4.0 * np.pi)) ** self.dimension * np.exp(-((q * xi) ** 2) / 4.0)


def gaussian(record, discretisation, dimension, nx):
    return ModelWaves.of(Gaussian(dimension, record.breadth), record, nx)
''',
    "scene/surfaces.py",
    (
        (
            '''\
class GaussianCorrelation(Spectral):
    """Model with a Gaussian autocorrelation."""

    implementation: ClassVar = "gfmd_numba.roughness.gaussian:gaussian"
    model: Literal["gaussian"] = Field(description="Spectrum of the surface")
    breadth: Length


''',
            "class LengthAnisotropy(",
        ),
        ("GaussianCorrelation | ", "Correlated | LengthAnisotropy | Scaling"),
    ),
)
AXIS = Recipe(
    None,
    "",
    "campaign/axes.py",
    (
        (
            '    Axis("breadth", "roughness", "b", "$b$", "breadth of the model"),\n',
            '    Axis("eps_c",',
        ),
    ),
)
RECIPES = (GENERATOR, SPECTRUM, AXIS)
PHASES = "method: random_phases, hurst: 0.8"
OWN_GRID = "points: 64, cut_on: 5e-6, roll_off: 5e-5"
GAUSSIAN = "method: psd, model: gaussian, breadth: 1e-5, rms_height: 1e-7, points: 64"


def campaign(name, roughness, rest):
    return f"""\
name: {name}
seed: 1
realisations: 8
scene:
  body: {{youngs_modulus: 1e9, poissons_ratio: 0.3}}
  length: 1e-4
  roughness: {{{roughness}}}
  interface: {{hard_wall: {{}}}}
  loading: {{reduced_pressure: 0.05}}
{rest}
"""


LIMITS = """\
reference: {eps_c: 1/4, eps_f: 1/8, eps_t: 1/2}
limits: {eps_c: [1/2, 1/8], eps_f: [1/4, 1/16]}
fit: {fixed: {eps_c: 1, eps_f: 1}}"""
FILES = {
    "phases.yaml": campaign("phases", f"{PHASES}, rms_gradient: 0.01", LIMITS),
    "breadths.yaml": campaign("breadths", GAUSSIAN, "grid: {breadth: [4e-6, 8e-6]}"),
    "profile.yaml": f"surface: {{{PHASES}, {OWN_GRID}, rms_gradient: 0.01}}\nlength: 1e-4\n",
    "map.yaml": f"surface: {{{GAUSSIAN}}}\nlength: 1e-4\ndimension: 2\n",
}


@pytest.fixture
def gfmd(tmp_path):
    return command_after(RECIPES, FILES, tmp_path)


@pytest.mark.long
def test_a_generator_a_spectrum_and_an_axis_go_from_yaml_to_netcdf_fit_and_plot(gfmd, tmp_path):
    *_, phases, breadths, listed = gfmd(
        *(f"surface {name}.yaml -o {name}.nc" for name in ("profile", "map")),
        *(f"run {name}.yaml --workers=0" for name in ("phases", "breadths")),
        *(f"plot {name} -o {name}.png" for name in ("phases", "breadths")),
        *(f"fit {name} -o {name}-fit.nc" for name in ("phases", "breadths")),
        "schema scene",
    )
    for name in ("phases", "breadths"):
        assert (tmp_path / f"{name}.png").stat().st_size > 1000
    assert "limit" in phases
    assert "b (m)" in breadths
    with xr.open_dataset(tmp_path / "phases-fit.nc") as fitted:
        assert fitted["kappa_tfc"].notnull().all()
    with xr.open_dataset(tmp_path / "breadths-fit.nc") as fitted:
        assert fitted["breadth"].values.tolist() == [4e-6, 8e-6]
    with xr.open_dataset(tmp_path / "breadths" / "breadths.nc") as found:
        assert (found["status"] == 0).all()
        assert found["breadth"].attrs["units"] == "m"
        assert found["breadth"].attrs["axis"] == "physics"
        kappa = found["kappa"].mean("realisation")
        assert kappa[0] != kappa[1]
    for name in ("profile", "map"):
        with xr.open_dataset(tmp_path / f"{name}.nc") as made:
            assert float(made["height"].std()) > 0
    assert "random_phases" in listed
    assert "gaussian" in listed
