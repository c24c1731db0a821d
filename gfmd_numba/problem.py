"""The plan of one contact: the dimensionless problem a scene reduces to, what was dropped, and its identity.

A frictionless hard wall on a linear body scales: with heights in g L_x and stresses in g E* (g the rms gradient)
neither E, L_x nor g is left, and Poisson's ratio matters only through the stiffness of a finite slab.
"""

import hashlib
import json
import math
from dataclasses import asdict, dataclass, field

import numpy as np
import numpy.typing as npt

from gfmd_numba.elasticity import stiffness
from gfmd_numba.interface import Exponential, Interface
from gfmd_numba.roughness import statistics
from gfmd_numba.scene import Discretisation, Numerics, Scene, SelfAffine

Reals = npt.NDArray[np.float64]

RESULTS_VERSION = 2  # raised whenever a change of the code changes a number: older shards are then not reused
_SPARSE_CONTACT = 0.01  # reduced pressure up to which conjugate gradients need less time than Verlet


@dataclass(frozen=True)
class RandomSurface:
    """An ensemble of self-affine profiles; wave indices count periods in L_x."""

    hurst: float
    cut_on_index: int
    cut_off_index: int
    nx: int
    seed: int


@dataclass(frozen=True)
class Profile:
    """The user's own profile `[nx]`, scaled to unit rms gradient."""

    nx: int
    digest: str
    heights: Reals = field(repr=False, compare=False)


@dataclass(frozen=True)
class Slab:
    """An elastic slab of height `aspect_ratio` L_x on a rigid base."""

    poissons_ratio: float
    aspect_ratio: float


@dataclass(frozen=True)
class Effect:
    """What became of one effect of the scene (on, off, condensed or dropped) and why."""

    name: str
    state: str
    reason: str


@dataclass(frozen=True)
class Problem:
    """Heights in g L_x, stresses in g E*; `slab` is None for a half-space; one of the two loads is None."""

    surface: RandomSurface | Profile
    slab: Slab | None
    interface: Interface
    mean_pressure: float | None
    displacement: float | None
    numerics: Numerics

    @property
    def identity(self) -> str:
        """Hash of everything that decides the numbers: equal problems are solved once."""
        surface = asdict(self.surface)
        surface.pop("heights", None)
        content = {
            "results_version": RESULTS_VERSION,
            "surface": surface,
            "slab": None if self.slab is None else asdict(self.slab),
            "interface": asdict(self.interface),
            "mean_pressure": self.mean_pressure,
            "displacement": self.displacement,
            "numerics": self.numerics.model_dump(),
        }
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:24]


def self_affine(scene: Scene) -> SelfAffine:
    """Roughness of a scene that asks for random surfaces; raises TypeError for any other."""
    if not isinstance(scene.roughness, SelfAffine):
        raise TypeError(f"a random surface needs roughness.method psd, not {scene.roughness.method}")
    return scene.roughness


def random_surface(scene: Scene, discretisation: Discretisation, seed: int) -> RandomSurface:
    """Ensemble of surfaces a scene with `psd` roughness asks for at one discretisation."""
    return RandomSurface(
        hurst=self_affine(scene).hurst,
        cut_on_index=discretisation.cut_on_index,
        cut_off_index=discretisation.cut_off_index,
        nx=discretisation.nx,
        seed=seed,
    )


def profile(heights: Reals) -> tuple[Profile, float]:
    """Profile of unit rms gradient and the rms gradient of the heights (in L_x) it was made from.

    Raises ValueError for a flat profile: without roughness there is no contact area to speak of.
    """
    gradient = float(statistics.rms_gradient(heights))
    if gradient == 0.0:
        raise ValueError("an rms gradient of 0: it is flat")
    unit = heights / gradient
    return Profile(len(unit), hashlib.sha256(unit.tobytes()).hexdigest(), unit), gradient


def reduce(
    scene: Scene, surface: RandomSurface | Profile, rms_gradient: float, numerics: Numerics
) -> tuple[Problem, tuple[Effect, ...]]:
    """Dimensionless problem of a scene, and what became of each of its effects."""
    loading = scene.loading
    displacement = None
    if loading.displacement is not None:
        displacement = loading.displacement / (scene.length or 1.0) / rms_gradient
    slab, elasticity = _slab(scene, displacement is not None)
    interface, interactions = _interface(scene, rms_gradient)
    if numerics.solver == "auto":
        sparse = loading.reduced_pressure is None or loading.reduced_pressure <= _SPARSE_CONTACT
        gradients = sparse and interface.law is None
        numerics = numerics.model_copy(update={"solver": "conjugate_gradients" if gradients else "verlet"})
    problem = Problem(surface, slab, interface, loading.reduced_pressure, displacement, numerics)
    return problem, (_TANGENTIAL, *elasticity, *interactions)


_TANGENTIAL = Effect(
    "tangential displacement",
    "condensed",
    "without friction it follows the normal one exactly (Schur complement, 6.75)",
)


def effective_modulus(scene: Scene) -> float:
    """Plane strain modulus E* = E / (1 - nu^2) in Pa; 1 if the scene gives no Young's modulus."""
    body = scene.body
    return 1.0 if body.youngs_modulus is None else body.youngs_modulus / (1.0 - body.poissons_ratio**2)


def _slab(scene: Scene, mean_matters: bool) -> tuple[Slab | None, tuple[Effect, ...]]:
    body = scene.body
    if math.isinf(body.aspect_ratio):
        return None, (
            Effect("slab", "off", "the body is a half-space"),
            Effect("Poisson's ratio", "dropped", "a frictionless half-space knows it only through E*"),
        )
    slab = Slab(body.poissons_ratio, body.aspect_ratio)
    effect = slab_effect(slab)
    name = f"slab of aspect ratio {body.aspect_ratio:g}, Poisson's ratio {body.poissons_ratio:g}"
    bound = f"it stiffens the longest wave by {effect:.1e} relative to the half-space"
    if mean_matters or effect > np.finfo(float).eps / 2:
        return slab, (Effect(name, "on", bound),)
    return None, (Effect(name, "dropped", f"{bound}, below double precision"),)


def _interface(scene: Scene, rms_gradient: float) -> tuple[Interface, tuple[Effect, ...]]:
    wall, exponential = scene.interface.hard_wall is not None, scene.interface.exponential
    effects = [Effect("hard wall", "on" if wall else "off", "as the scene says")]
    if exponential is None:
        return Interface(wall, None), (*effects, Effect("exponential law", "off", "not in the scene"))
    length = rms_gradient * (scene.length or 1.0)
    law = Exponential(
        work=exponential.work_of_adhesion / (length * rms_gradient * effective_modulus(scene)),
        length=exponential.range / length,
    )
    return Interface(wall, law), (*effects, Effect("exponential law", "on", "as the scene says"))


def slab_effect(slab: Slab) -> float:
    """Largest relative stiffening of any wave by the rigid base, that of the longest wave."""
    k = 2.0 * np.pi * slab.aspect_ratio
    ratio = stiffness.slab_factor(np.array([k]), slab.poissons_ratio)[0] - 1.0
    # below rounding the exact ratio is out of reach; its leading term is (1 + kappa^2 + 4 k^2) exp(-2 k) / kappa
    kappa = 3.0 - 4.0 * slab.poissons_ratio
    tail = (1.0 + kappa**2 + 4.0 * k**2 + 4.0 * kappa * k) * math.exp(-2.0 * k) / kappa
    return float(ratio) if abs(ratio) > 1e-12 else tail
