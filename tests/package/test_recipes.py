"""The recipes of docs/architecture.md, followed on a copy of the package: each touches two files at most."""

import pytest
import xarray as xr

from support.recipes import Recipe, command_after

LAW = Recipe(
    "interface/quadratic.py",
    '''\
"""Quadratic attraction of finite range."""

from dataclasses import dataclass

import numpy as np

from gfmd_numba.interface.normal_law import NormalLaw


@dataclass(frozen=True)
class QuadraticLaw(NormalLaw):
    """Energy -work (1 - gap / length)^2 per area up to the gap `length`."""

    work: float
    length: float

    @classmethod
    def of(cls, asked):
        return cls(asked.work_of_adhesion, asked.range)

    @property
    def strength(self):
        return 2.0 * self.work / self.length

    @property
    def softening(self):
        return self.strength / self.length

    def energy(self, gap):
        return -0.5 * self.traction(gap) ** 2 / self.softening

    def traction(self, gap):
        return self.strength * np.clip(1.0 - gap / self.length, 0.0, None)

    def stiffness(self, gap):
        return np.where(gap < self.length, -self.softening, 0.0)

    def energy_change(self, gap, closing):
        return self.energy(gap - closing) - self.energy(gap)

    def stiffest(self, pressure, hard_wall):
        return 0.0
''',
    "scene/interface_records.py",
    (
        (
            '''\
class Quadratic(LawRecord):
    """Attraction of finite range with energy -work_of_adhesion (1 - gap/range)^2 per area."""

    title: ClassVar = "quadratic law"
    ability: ClassVar = "normal law"
    implementation: ClassVar = "gfmd_numba.interface.quadratic:QuadraticLaw"
    normal: ClassVar = True
    across_open_gap: ClassVar = True
    keeps_apart: ClassVar = False
    work_of_adhesion: WorkOfAdhesion = Field(description="Energy per area in J/m^2 (E* L_x without moduli and length)")
    range: Length = Field(description="Gap at which it ends, in m if the scene has a length, else in L_x")


''',
            "Law = (\n",
        ),
        (
            '    quadratic: Quadratic | None = Field(None, description="Attraction of finite range")\n',
            "    cohesive: Cohesive | None",
        ),
    ),
)
SOLVER = Recipe(
    "solvers/heavy_ball.py",
    '''\
"""Heavy-ball descent, which is Verlet's scheme under another name."""

from gfmd_numba.solvers.dynamics import verlet


def heavy_ball_descent(batch, options):
    """Begin with the displacement at rest."""
    return verlet(batch, options)
''',
    "solvers/table.py",
    (
        (
            """\
    "heavy_ball": Solver(
        "descends with momentum",
        can=_DISPLACEMENT,
        condensed=("gfmd_numba.solvers.heavy_ball:heavy_ball_descent",),
        options=_TIME_STEP | _DAMPING,
    ),
""",
            '    "fire": Solver(',
        ),
    ),
)
OBSERVABLE = Recipe(
    "contact/largest_pressure.py",
    '''\
"""The largest pressure of a contact."""


def largest_pressure(contact):
    """Largest pressure in g E* `[realisation]`."""
    pressure = contact.equilibrium.pressure
    return pressure.max(axis=tuple(range(1, pressure.ndim)))
''',
    "contact/observables.py",
    (
        (
            """\
    "largest_pressure": Observable(
        "pressure",
        "largest contact pressure",
        "gfmd_numba.contact.largest_pressure:largest_pressure",
    ),
""",
            '    "mean_gap": Observable(',
        ),
    ),
)
SCENE = """\
  body: {youngs_modulus: 1e9, poissons_ratio: 0.3}
  length: 1e-4
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}, quadratic: {work_of_adhesion: 1e-3, range: 1e-5}}
  loading: {reduced_pressure: 0.05}
numerics: {solver: heavy_ball, residual: 1e-4, time_step: 0.9}
"""
FILES = {
    "contact.yaml": f"scene:\n{SCENE}discretisation: {{eps_c: 1/4, eps_f: 1/4, eps_t: 1/2}}\n",
    "campaign.yaml": f"name: recipes\nseed: 1\nrealisations: 8\nscene:\n{SCENE}"
    "reference: {eps_c: 1/4, eps_f: 1/4, eps_t: 1/2}\nlimits: {eps_c: [1/2, 1/8]}\nfit: {fixed: {eps_c: 1}}\n",
}


@pytest.fixture
def gfmd(tmp_path):
    return command_after((LAW, SOLVER, OBSERVABLE), FILES, tmp_path)


@pytest.mark.long
def test_a_law_a_solver_and_an_observable_go_from_yaml_to_netcdf_fit_and_plot(gfmd, tmp_path):
    *_, limits, _, printed = gfmd(
        "check contact.yaml",
        "solve contact.yaml -o contact.nc",
        "run campaign.yaml --workers=0",
        "fit recipes",
        "plot recipes -o fit.png",
        "schema combinations",
    )
    for file in ("contact.nc", "recipes/recipes.nc"):
        with xr.open_dataset(tmp_path / file) as found:
            assert (found["status"] == 0).all()
            assert found["largest_pressure"].units == "Pa"
            assert (found["largest_pressure"] > found["mean_pressure"]).all()
            assert found.attrs.get("solver", "heavy_ball") == "heavy_ball"
    assert "limit" in limits
    assert (tmp_path / "fit.png").stat().st_size > 1000
    assert "quadratic law" in printed.lower()
    assert "`heavy_ball`" in printed
