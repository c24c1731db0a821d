"""From a scene to its dimensionless problem, and what became of each of its effects.

A frictionless hard wall on a linear body scales: with heights in g L_x and stresses in g E* (g the rms gradient)
neither E, L_x nor g is left, and Poisson's ratio matters only through the stiffness of a finite slab. E* of layers is
that of the topmost one.
"""

from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.problem import DeformableBody, Effect, Problem, Tractions
from gfmd_numba.contact.reduced_loads import plasticity, reduced_step, steps_of
from gfmd_numba.contact.rough_surfaces import FacingSurfaces
from gfmd_numba.elasticity import free_body, moduli
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.scales import scales_of
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.scene import Interface, Numerics, Scene
from gfmd_numba.scene.interface_records import LAWS
from gfmd_numba.scene.loading import Step
from gfmd_numba.scene.records import TIME_TOLERANCE
from gfmd_numba.scene.units import in_reduced_units, rounded
from gfmd_numba.solvers.table import SOLVERS, Options, automatic

_NU = "Poisson's ratio"
_ROUNDING = float(np.finfo(float).eps) / 2
_NO_MISMATCH = 1e-12  # of Dundurs' beta, whose share of a body in the compliance has 12 digits


def reduce(
    scene: Scene,
    surfaces: FacingSurfaces,
    numerics: Numerics,
    path: Iterable[Step] = (),
    tractions: Tractions | None = None,
    pattern: Reals | None = None,
) -> tuple[Problem, tuple[Effect, ...]]:
    """Dimensionless problem of a scene along a path, and what became of each of its effects.

    `tractions` are those of its boundary, and a `pattern` `[(y,) x]` multiplies the work of adhesion of its law. Raises
    ValueError for a load that is beyond all measure for the rms gradient and the moduli, or that the hardness cannot
    carry.
    """
    rms_gradient, rough, scales = surfaces.rms_gradient, surfaces.rough, scales_of(scene)
    first, *steps = (reduced_step(*step, scales, rms_gradient) for step in steps_of(scene, path))
    displacement, pressure = (None, first.load) if scene.loading.displacement is None else (first.load, None)
    facing = None if scene.counter_body is None else DeformableBody(scales.bodies[1], scales.compliance_fractions[1])
    may_slip = surfaces.order > 0 or any(scene.ends)  # as inclined surfaces do, and punches that drag a free body
    length, stress = rms_gradient * scales.length, rms_gradient * scales.modulus
    acting = in_reduced_units(scene.interface, length, stress, scales.time)
    interface, interactions = _interface(acting, scales.bodies[0], facing, may_slip, (stress, length / scales.time))
    exact = displacement is not None or interface.normal_law is not None  # a jump may hang on any small difference
    tolerance = 0.0 if exact or numerics.effects == "exact" else numerics.effects
    if scales.relaxation is not None:  # of two bodies that give way alike, the one stands for both
        facing = rough = None  # slopes are followed nowhere
    mean_matters = displacement is not None or any(scene.ends) or scales.relaxation is not None
    needs_nu = tractions is not None or scene.body.plasticity is not None
    body, elasticity = _body(scales.bodies[0], interface, mean_matters, needs_nu, tolerance)
    options = _options(numerics, scene, interface.abilities)
    counter, dropped = _counter_body(facing, interface, displacement is not None, tolerance)
    elasticity += dropped
    if rough is not None:  # Poisson's ratio, which the flat bodies do without, their topographies need
        elasticity = tuple(effect for effect in elasticity if not effect.name.startswith(_NU))
    if pattern is not None:
        interface = interface.patterned(pattern, free_body.padded_shape(pattern.shape, scene.ends))
    passes = scene.passes and any(any(step.sliding) for step in steps)
    problem = Problem(
        surfaces.surface,
        body,
        interface,
        pressure,
        displacement,
        options,
        tractions,
        counter,
        tuple(steps),
        rough,
        periodic=scene.periodic,
        duration=first.duration,
        speed=first.speed,
        relaxation=scales.relaxation,
        time_tolerance=numerics.time_tolerance or TIME_TOLERANCE if scene.creeps or acting.wear else None,
        wear_rate=None if acting.wear is None else acting.wear.rate,
        plasticity=plasticity(scene, scales, rms_gradient),
        passing=rounded(rms_gradient) if passes else None,
        fields_in_period=scene.fields_in_period,
    )
    effects = interactions + _slow_effects(scene)
    return problem, _all_effects(elasticity, effects, tractions is not None)


def _counter_body(
    facing: DeformableBody | None, interface: Interactions, mean_matters: bool, tolerance: float
) -> tuple[DeformableBody | None, tuple[Effect, ...]]:
    """Counter body, None without one, and what of its elasticity is dropped."""
    if facing is None:
        return None, ()
    body, effects = _body(facing.elastic, interface, mean_matters, False, tolerance)
    dropped = (effect for effect in effects if effect.state == "dropped")
    return DeformableBody(body, facing.compliance_fraction), tuple(
        replace(effect, name=f"{effect.name}, of the counter_body") for effect in dropped
    )


def _slow_effects(scene: Scene) -> tuple[Effect, ...]:
    asked = {"relaxation": scene.creeps or None, "wear": scene.interface.wear, "plastic flow": scene.body.plasticity}
    return tuple(_as_asked(name, record) for name, record in asked.items())


@lru_cache(maxsize=4096)  # a tuple that many problems share
def _all_effects(
    elasticity: tuple[Effect, ...], interactions: tuple[Effect, ...], has_tractions: bool
) -> tuple[Effect, ...]:
    return (*elasticity, *interactions, _as_asked("prescribed tractions", has_tractions or None))


def _options(numerics: Numerics, scene: Scene, abilities: tuple[str, ...]) -> Options:
    needs = *abilities, *(() if scene.loading.speed is None else ("speed",))
    return solver_options(numerics, automatic(scene.dimension, needs))


@lru_cache
def solver_options(numerics: Numerics, automatic: str) -> Options:
    """Options of the solver that the numerics name, or of the `automatic` one, without those that it does not have."""
    solver = automatic if numerics.solver == "auto" else numerics.solver
    own = {name: getattr(numerics, name) for name in SOLVERS[solver].options}
    return Options(solver, numerics.residual, numerics.max_iterations, **own, threads=numerics.threads)


@lru_cache(maxsize=4096)
def _body(
    body: ElasticBody, interface: Interactions, mean_matters: bool, needs_nu: bool, tolerance: float
) -> tuple[ElasticBody, tuple[Effect, ...]]:
    condensed = Effect(
        "tangential displacement", "condensed", "without friction the normal displacement determines it exactly (6.75)"
    )
    coupled = Effect("tangential displacement", "on", "tangential tractions act on it")
    tangential = coupled if interface.couples else condensed
    if body.stack is None and body.aspect_ratio is None:
        off = Effect("slab", "off", "the body is a half-space")
        if interface.couples or needs_nu:  # tangential tractions move the surface up and down by nu
            return body, (tangential, off)
        unknown = Effect(_NU, "dropped", "it enters a frictionless half-space only through E*")
        return ElasticBody(None, None), (condensed, off, unknown)
    if body.stack is not None:
        n = len(body.stack.heights)
        name = f"{n} layer{'s' if n > 1 else ''} on a {'rigid base' if body.stack.base is None else 'half-space'}"
        matters, what = (
            "both displacements feel them",
            "what is below the topmost layer changes the stiffness of a wave, and so kappa",
        )
    else:
        name = f"slab of aspect ratio {body.aspect_ratio:g}, Poisson's ratio {body.nu:g}"
        matters, what = "its mean displacement counts", "it stiffens the longest wave, and so changes kappa"
    if interface.couples:
        return body, (coupled, Effect("slab" if body.stack is None else name, "on", matters))
    effect = body.deviation()
    bound = f"{what}, by at most {effect:.1e}"
    if mean_matters or needs_nu or effect > max(_ROUNDING, tolerance):
        return body, (condensed, Effect(name, "on", bound))
    return ElasticBody(None, None), (condensed, Effect(name, "dropped", f"{bound}, {_below(effect, tolerance)}"))


def _below(effect: float, tolerance: float) -> str:
    return "below " + ("double precision" if effect <= _ROUNDING else f"numerics.effects = {tolerance:g}")


@lru_cache(maxsize=4096)
def _interface(
    asked: Interface, body: ElasticBody, counter: DeformableBody | None, may_slip: bool, units: tuple[float, float]
) -> tuple[Interactions, tuple[Effect, ...]]:
    interactions = Interactions.of(asked, units)
    effects = {name: _as_asked(law.title, getattr(asked, name)) for name, law in LAWS.items()}
    reason = "" if interactions.friction is None or may_slip else _why_nothing_slips(body, counter)
    if reason:
        interactions = replace(interactions, friction=None, slip_rate=None)
        effects["friction"] = Effect("friction", "dropped", reason)
    if interactions.hardness is not None:
        effects["hardness"] = Effect("hardness", "on", f"the pressure is at most {interactions.hardness:.4g} g E*")
    return interactions, tuple(effects.values())


def _why_nothing_slips(body: ElasticBody, counter: DeformableBody | None) -> str:
    """Return why no load makes the surfaces slip; nothing if one may."""
    bodies = (body,) if counter is None else (body, counter.elastic)
    if any(each.aspect_ratio is not None or each.poissons_ratio is None for each in bodies):
        return ""
    if counter is None:
        return "an incompressible half-space has no tangential displacement under normal load" if body.nu == 0.5 else ""
    if abs(moduli.dundurs_beta(body.nu, counter.elastic.nu, counter.compliance_fraction)) > _NO_MISMATCH:
        return ""
    return "two half-spaces whose Dundurs' beta is 0 give way alike along the surface under normal load"


def _as_asked(name: str, record: object) -> Effect:
    return Effect(name, "off", "not in the scene") if record is None else Effect(name, "on", "in the scene")
