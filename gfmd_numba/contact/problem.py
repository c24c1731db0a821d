"""The plan of one contact: the dimensionless problem a scene reduces to, what was dropped, and its identity.

A frictionless hard wall on a linear body scales: with heights in g L_x and stresses in g E* (g the rms gradient)
neither E, L_x nor g is left, and Poisson's ratio matters only through the stiffness of a finite slab. E* of layers is
that of the topmost one.
"""

import hashlib
import json
import math
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.prescribed_load import reduced_pressure
from gfmd_numba.contact.results_version import results_version
from gfmd_numba.contact.tractions import Tractions
from gfmd_numba.elasticity import moduli, stiffness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.layer import Material
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.interface.table import LAWS
from gfmd_numba.roughness import recipe, statistics
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.scene import Body, Discretisation, Interface, LoadedBody, Numerics, Random, Scene
from gfmd_numba.scene.layer_records import Layer
from gfmd_numba.scene.layer_records import Material as MaterialRecord
from gfmd_numba.scene.quantities import LARGEST, SMALLEST
from gfmd_numba.scene.reduced_units import in_reduced_units, rounded
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.table import SOLVERS, automatic

_ROUNDING = float(np.finfo(float).eps) / 2


@dataclass(frozen=True)
class GivenSurface:
    """The user's own heights `[(ny,) nx]`, or the sum of several surfaces, in g L_x."""

    nx: int
    digest: str
    heights: Reals = field(repr=False, compare=False)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the surface."""
        return self.heights.shape

    @property
    def nodes(self) -> int:
        """Number of its nodes."""
        return self.heights.size


@dataclass(frozen=True)
class CounterBody:
    """A second deformable body in place of the rigid punch; `share` is its part of the compliance 1/E*, E*/E_2*."""

    body: ElasticBody
    share: float


@dataclass(frozen=True)
class Effect:
    """What became of one effect of the scene (on, off, condensed or dropped) and why."""

    name: str
    state: str
    reason: str


@dataclass(frozen=True)
class Problem:
    """Heights in g L_x, stresses in g E*; one of the two loads is None."""

    surface: RandomSurface | GivenSurface
    body: ElasticBody
    interface: Interactions
    mean_pressure: float | None
    displacement: float | None
    numerics: Options
    tractions: Tractions | None = None
    counter: CounterBody | None = None

    @cached_property
    def identity(self) -> str:
        """Hash of everything that decides the numbers: equal problems are solved once."""
        surface = asdict(self.surface)
        surface.pop("heights", None)
        if isinstance(self.surface, RandomSurface):
            # its text names the classes: models with equal numbers differ in nothing else
            surface["generator"] = repr(self.surface.generator)
        interface = asdict(self.interface) | {"laws": self.interface.laws}
        if self.interface.hardness is None:
            del interface["hardness"]
        content = {
            "results_version": results_version(),
            "surface": surface,
            "body": _content(self.body),
            "interface": interface,
            "mean_pressure": self.mean_pressure,
            "displacement": self.displacement,
            "numerics": asdict(self.numerics),
        }
        if self.tractions is not None:
            content["tractions"] = self.tractions.digest
        if self.counter is not None:
            content["counter"] = {"body": _content(self.counter.body), "share": self.counter.share}
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:24]


def _content(body: ElasticBody) -> dict[str, object]:
    """What tells a body from others; nothing is said of layers where there are none."""
    content = asdict(body)
    if body.stack is None:
        del content["stack"]
    return content


def random_surface(scene: Scene, discretisation: Discretisation | None, seed: int) -> tuple[RandomSurface, float]:
    """Ensemble of surfaces that the punch of a scene has at a discretisation, and the rms gradient asked of it.

    Raises TypeError for a punch without random roughness.
    """
    if not isinstance(scene.roughness, Random):
        raise TypeError("a random surface needs a random roughness of the punch")
    period = scene.length or 1.0
    surface = recipe.random_surface(scene.roughness, discretisation, period, scene.dimension, seed)
    return surface, recipe.rms_gradient(scene.roughness, surface, period)


def given_surface(heights: Reals, gradient: float | None = None) -> tuple[GivenSurface, float]:
    """Surface in units of a `gradient` g, by default the rms gradient of its heights (in L_x), and that gradient.

    Raises ValueError for a flat surface, without roughness to speak of, or one too large for its gradient.
    """
    scale, slope = scaled_gradient(heights)
    rounding = heights.shape[-1] * np.finfo(float).eps  # about the rms gradient of heights of order 1 that are rounded
    own = slope * scale
    if slope <= 100.0 * rounding:
        size = f"an rms gradient of {own:.2g} in heights of up to {np.abs(heights).max():.3g}"
        raise ValueError(f"{size}: it is flat but for rounding")
    if not SMALLEST <= own <= LARGEST:
        raise ValueError(f"an rms gradient of {own:.3g}, not from {SMALLEST:g} to {LARGEST:g}")
    unit = heights / scale / (slope if gradient is None else gradient / scale)
    digest = hashlib.sha256(unit.tobytes()).hexdigest()
    return GivenSurface(unit.shape[-1], digest, unit), own if gradient is None else gradient


def scaled_gradient(heights: Reals) -> tuple[float, float]:
    """A power of two about as large as the heights, which rounds nothing, and their rms gradient in units of it."""
    scale = math.ldexp(1.0, math.frexp(np.abs(heights).max())[1] - 1)
    return scale, float(statistics.rms_gradient(heights / scale, (1.0,) * heights.ndim))


def reduce(
    scene: Scene,
    surface: RandomSurface | GivenSurface,
    rms_gradient: float,
    numerics: Numerics,
    tractions: Tractions | None = None,
) -> tuple[Problem, tuple[Effect, ...]]:
    """Dimensionless problem of a scene, and what became of each of its effects; `tractions` are its boundary's.

    Raises ValueError for a load that is beyond all measure beside the rms gradient and the moduli, or that the hardness
    cannot carry.
    """
    loading = scene.loading
    period, modulus = scene.length or 1.0, contact_modulus(scene)
    displacement = None
    if loading.displacement is not None:
        displacement = rounded(loading.displacement / period) / rms_gradient
    given = elastic_body(scene.body, scene.length)
    interface, interactions = _interface(scene.interface, given, period, modulus, rms_gradient)
    exact = displacement is not None or interface.normal_law is not None  # a jump may hang on any small difference
    tolerance = 0.0 if exact or numerics.effects == "exact" else numerics.effects
    body, elasticity = _body(given, interface, displacement is not None, tractions is not None, tolerance)
    options = solver_options(numerics, automatic(scene.dimension, interface.abilities))
    load = reduced_pressure(scene, rms_gradient, modulus)
    pressure = None if load is None else load / scene.body.stiffness_scale
    counter = None
    if scene.counter_body is not None:
        counter_body = elastic_body(scene.counter_body, scene.length)
        other = _body(counter_body, interface, displacement is not None, False, tolerance)[0]
        counter = CounterBody(other, modulus / effective_modulus(scene.counter_body))
    problem = Problem(surface, body, interface, pressure, displacement, options, tractions, counter)
    effects = (*elasticity, *interactions, _as_asked("prescribed tractions", tractions))
    if scene.body.stiffness_scale != 1.0:
        wrong = f"all stiffnesses are {scene.body.stiffness_scale:g} times too large, as the scene asks for"
        effects = (Effect("stiffness scale", "on", wrong), *effects)
    return problem, effects


def effective_modulus(body: Body) -> float:
    """Modulus of the stiffness, in Pa or 1 without Young's modulus: E* but for a `stiffness_scale`.

    Of layers that of the topmost one, which the shortest waves, and so the contact spots, feel alone.
    """
    if body.surface_modulus is None:
        return body.stiffness_scale
    return moduli.plane_modulus(body.stiffness_scale * body.surface_modulus, body.surface_poissons_ratio, body.state)


@lru_cache(maxsize=4096)
def elastic_body(body: Body, length: float | None) -> ElasticBody:
    """The body of a record in units of L_x and E*, with all that is known of it; `length` is L_x in m, if known."""
    if body.layers is None:
        nu = body.effective_poissons_ratio(body.surface_poissons_ratio)
        return ElasticBody(nu, None if math.isinf(body.aspect_ratio) else body.aspect_ratio)
    top = body.layers[0]

    def material(part: Layer | MaterialRecord) -> Material:
        # a quotient of Young's moduli does not depend on their unit, to the last digit
        shapes = (moduli.plane_modulus(1.0, each.poissons_ratio, body.state) for each in (part, top))
        modulus = part.youngs_modulus / top.youngs_modulus * (next(shapes) / next(shapes))
        return Material(modulus, body.effective_poissons_ratio(part.poissons_ratio))

    return ElasticBody.layered(
        tuple(layer.height / (length or 1.0) for layer in body.layers),
        tuple(material(layer) for layer in body.layers),
        None if body.base is None or body.base == "rigid" else material(body.base),
    )


def contact_modulus(scene: Scene | LoadedBody) -> float:
    """Contact modulus E* in Pa of all that deforms: under one pressure compliances 1/E* add up."""
    if isinstance(scene, LoadedBody) or scene.counter_body is None:
        return effective_modulus(scene.body)
    return 1.0 / sum(1.0 / effective_modulus(body) for body in scene.deformable)


@lru_cache
def solver_options(numerics: Numerics, automatic: str) -> Options:
    """Options of the solver that the numerics name, or of the `automatic` one, without those that it does not have."""
    solver = automatic if numerics.solver == "auto" else numerics.solver
    own = {name: getattr(numerics, name) for name in SOLVERS[solver].options}
    return Options(solver, numerics.residual, numerics.max_iterations, numerics.precision, **own)


@lru_cache(maxsize=4096)
def _body(
    body: ElasticBody, interface: Interactions, mean_matters: bool, loaded: bool, tolerance: float
) -> tuple[ElasticBody, tuple[Effect, ...]]:
    condensed = Effect(
        "tangential displacement", "condensed", "without friction the normal one decides it exactly (6.75)"
    )
    coupled = Effect("tangential displacement", "on", "tangential tractions act on it")
    if body.stack is not None:
        return _stack(body, coupled if interface.couples else condensed, mean_matters or loaded, tolerance)
    if body.aspect_ratio is None:
        off = Effect("slab", "off", "the body is a half-space")
        if interface.couples:
            return body, (coupled, off)
        if loaded:  # tangential tractions move the surface up and down by nu
            return body, (condensed, off)
        unknown = Effect("Poisson's ratio", "dropped", "a frictionless half-space knows it only through E*")
        return ElasticBody(None, None), (condensed, off, unknown)
    if interface.couples:
        return body, (coupled, Effect("slab", "on", "its mean displacement counts"))
    effect = stiffness.stiffening(body.nu, body.aspect_ratio)
    name = f"slab of aspect ratio {body.aspect_ratio:g}, Poisson's ratio {body.nu:g}"
    bound = f"it stiffens the longest wave, and so changes kappa, by at most {effect:.1e}"
    if mean_matters or loaded or effect > max(_ROUNDING, tolerance):
        return body, (condensed, Effect(name, "on", bound))
    return ElasticBody(None, None), (condensed, Effect(name, "dropped", f"{bound}, {_below(effect, tolerance)}"))


def _stack(
    body: ElasticBody, tangential: Effect, all_matters: bool, tolerance: float
) -> tuple[ElasticBody, tuple[Effect, ...]]:
    assert body.stack is not None
    n = len(body.stack.heights)
    name = f"{n} layer{'s' if n > 1 else ''} on a {'rigid base' if body.stack.base is None else 'half-space'}"
    if tangential.state == "on":
        return body, (tangential, Effect(name, "on", "both displacements feel them"))
    effect = stiffness.deviation(body.condensed_stiffness, body.stack.heights[0])
    bound = f"what is below the topmost layer changes the stiffness of a wave, and so kappa, by at most {effect:.1e}"
    if all_matters or effect > max(_ROUNDING, tolerance):
        return body, (tangential, Effect(name, "on", bound))
    return ElasticBody(None, None), (tangential, Effect(name, "dropped", f"{bound}, {_below(effect, tolerance)}"))


def _below(effect: float, tolerance: float) -> str:
    return "below " + ("double precision" if effect <= _ROUNDING else f"numerics.effects = {tolerance:g}")


@lru_cache(maxsize=4096)
def _interface(
    asked: Interface, body: ElasticBody, period: float, modulus: float, rms_gradient: float
) -> tuple[Interactions, tuple[Effect, ...]]:
    laws = {name: in_reduced_units(law, period, modulus) for name, law in asked.laws.items()}
    interactions = Interactions.scaled(asked.model_copy(update=laws), rms_gradient, rms_gradient * rms_gradient)
    effects = {name: _as_asked(law.title, getattr(asked, name)) for name, law in LAWS.items()}
    incompressible = body.aspect_ratio is None and body.poissons_ratio == 0.5
    if interactions.friction is not None and incompressible:
        interactions = replace(interactions, friction=None)
        reason = "an incompressible half-space has no tangential displacement under normal load"
        effects["friction"] = Effect("friction", "dropped", reason)
    if interactions.hardness is not None:
        effects["hardness"] = Effect("hardness", "on", f"the pressure is at most {interactions.hardness:.4g} g E*")
    return interactions, tuple(effects.values())


def _as_asked(name: str, record: object) -> Effect:
    return Effect(name, "off", "not in the scene") if record is None else Effect(name, "on", "in the scene")
