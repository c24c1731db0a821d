"""What the quantities of a scene are in units of L_x, E* and the rms gradient g: its bodies, moduli and loads.

A hardness bears less mean pressure than that at which every node would be plastic.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import accumulate

from gfmd_numba.contact.state import LoadStep
from gfmd_numba.elasticity import moduli
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.elasticity.plasticity import Plasticity
from gfmd_numba.elasticity.prony import PronySeries, in_series
from gfmd_numba.kernels import Hardening
from gfmd_numba.scene import Body, Interface, Scene
from gfmd_numba.scene.body_record import Layer
from gfmd_numba.scene.body_record import Material as MaterialRecord
from gfmd_numba.scene.loading import Step
from gfmd_numba.scene.quantities import LARGEST, SMALLEST
from gfmd_numba.scene.units import in_reduced_units, in_unit_of, quantities, rounded

_INCOMPRESSIBLE = 0.5 - 1e-12
SLIDING = ("sliding", "sliding_y")
_YIELDS = "the body yields at all depths"


def effective_modulus(body: Body, in_pascal: bool) -> float:
    """E* in Pa, or 1 where stresses stay in E*.

    Of layers that of the topmost one, which the shortest waves, and so the contact spots, feel alone.
    """
    if body.surface_modulus is None or not in_pascal:
        return 1.0
    return moduli.plane_modulus(body.surface_modulus, body.surface_poissons_ratio, body.state)


@lru_cache(maxsize=4096)
def in_own_units(body: Body, length: float | None, time: float = 1.0) -> Body:
    """Body in units of L_x, its modulus at the surface and a time, to 12 digits: it is the same in all units."""
    found: Body = in_reduced_units(body, length or 1.0, body.surface_modulus or 1.0, time)
    return found


def elastic_body(own: Body) -> ElasticBody:
    """The body of a record in its own units, with all that is known of it."""
    nu = own.effective_poissons_ratio(own.surface_poissons_ratio)
    if own.layers is None:
        return ElasticBody(nu, None if math.isinf(own.aspect_ratio) else own.aspect_ratio)
    top = moduli.plane_modulus(1.0, own.surface_poissons_ratio, own.state)

    def material(part: Layer | MaterialRecord) -> Material:
        modulus = moduli.plane_modulus(part.youngs_modulus, part.poissons_ratio, own.state) / top
        return Material(rounded(modulus), own.effective_poissons_ratio(part.poissons_ratio))

    return ElasticBody.layered(
        tuple(layer.height for layer in own.layers),
        tuple(material(layer) for layer in own.layers),
        None if own.base is None or own.base == "rigid" else material(own.base),
    )


@dataclass(frozen=True)
class Scales:
    """What the numbers of a scene count in, and its bodies in these units: all that loads do not change.

    `length` is L_x in m and `modulus` is E* in Pa, of all that deforms: under one pressure compliances 1/E* add up.
    Both are 1 where the scene has none. `time` is the longest relaxation time in s, 1 without one. Each of the
    `bodies` has its part E*/E_i* of the compliance 1/E*, to 12 digits: it is the same in all units. `relaxation` are
    the branches of all that deforms over its relaxed modulus and that time, None if nothing creeps.
    """

    length: float
    modulus: float
    time: float
    bodies: tuple[ElasticBody, ...]
    shares: tuple[float, ...]
    relaxation: PronySeries | None


def scales_of(scene: Scene) -> Scales:
    """Return the scales of a scene."""
    return _scales(scene.deformable, scene.length, scene.has_moduli)


@lru_cache(maxsize=4096)
def _scales(bodies: tuple[Body, ...], length: float | None, in_pascal: bool) -> Scales:
    time = max((branch.time for body in bodies for branch in body.relaxation or ()), default=1.0)
    own, relaxation = [in_own_units(body, length, time) for body in bodies], None
    moduli_of = [effective_modulus(body, in_pascal) for body in bodies]
    modulus = moduli_of[0] if len(bodies) == 1 else 1.0 / sum(1.0 / each for each in moduli_of)
    shares = tuple(rounded(modulus / each) for each in moduli_of)
    branches = [body.relaxation or () for body in own]
    series = [PronySeries(tuple(each.modulus for each in of), tuple(each.time for each in of)) for of in branches]
    if any(branches):  # two bodies give way alike, as the table of combinations says, each by its share
        relaxation = series[0] if len(series) == 1 else in_series(tuple(zip(shares, series, strict=True)))
    return Scales(length or 1.0, modulus, time, tuple(map(elastic_body, own)), shares, relaxation)


def times_of(steps: Iterable[Scene]) -> list[float]:
    """Times in s at the end of steps, whose scenes have the durations of their loadings."""
    return list(accumulate(float(scene.loading.duration or 0.0) for scene in steps))


def plasticity(scene: Scene, scales: Scales, rms_gradient: float) -> Plasticity | None:
    """J2 plasticity of the body (g E*, g and L_x), to 12 digits; None if it is elastic."""
    if scene.body.plasticity is None:
        return None
    given, voce = in_reduced_units(scene.body.plasticity, scales.length, rms_gradient * scales.modulus), {}
    if given.saturation_stress is not None and given.saturation_strain is not None:
        rise, strain = given.saturation_stress - given.yield_stress, rounded(given.saturation_strain / rms_gradient)
        voce = {"rise": rise, "strain": strain}
    slope = rounded((given.hardening or 0.0) * rms_gradient)  # over strains in g
    return Plasticity(Hardening(given.yield_stress, slope, **voce), given.depth, given.sublayers, given.increments)


def whole_body_yields(body: Body) -> float:
    """Mean pressure in Pa (E* without moduli) under which a periodic body yields far below its surface; else infinite.

    There the period holds it sideways, so that it bears nu / (1 - nu) of the pressure along the surface.
    """
    if body.plasticity is None or body.surface_poissons_ratio >= _INCOMPRESSIBLE:
        return math.inf
    nu = body.surface_poissons_ratio
    return body.plasticity.yield_stress * (1.0 - nu) / (1.0 - 2.0 * nu)


Sliding = tuple[float, ...]  # of the punch along x, of a map also along y


def reduced_load(scene: Scene, scales: Scales, rms_gradient: float) -> float:
    """What the loading of a scene prescribes, a displacement (g L_x) or the mean pressure (g E*).

    A line load acts on the length L_x, a force on the area L_x^2. Raises ValueError for a load beyond all measure for
    the gradient and the contact modulus, or one that a hardness cannot bear.
    """
    loading, acting = scene.loading, scene.interface
    bounds = (whole_body_yields(scene.body), _YIELDS), (plastic_pressure(acting), at_most(acting))
    if loading.displacement is not None:
        return rounded(loading.displacement / (scales.length * rms_gradient))
    load, quantity = getattr(loading, loading.control), quantities(type(loading)).get(loading.control)
    unit = 1.0 if quantity is None else quantity.scale(scales.length, scales.modulus) * rms_gradient
    found, one = load / unit, rms_gradient * scales.modulus
    if not SMALLEST <= found <= LARGEST:
        raise ValueError(f"a reduced pressure from {SMALLEST:g} to {LARGEST:g}, while this one comes to {found:.3g}")
    for most, told in bounds:
        if most is not None and found >= most / one:
            raise ValueError(f"below {in_unit_of(load, most / one * unit)}, at which {told}")
    return rounded(found)


def reduced_step(scene: Scene, sliding: Sliding, scales: Scales, rms_gradient: float) -> LoadStep:
    """Step of a path that ends with the loading of a scene, and a tangential displacement of its punch (m or L_x).

    Durations count in the longest relaxation time, speeds in L_x over that. Raises ValueError as `reduced_load` does.
    """
    loading, load = scene.loading, reduced_load(scene, scales, rms_gradient)
    ways = tuple(rounded(way / (scales.length * rms_gradient)) for way in sliding)
    speed = rounded((loading.speed or 0.0) / scales.length * scales.time)
    return LoadStep(load, ways, rounded((loading.duration or 0.0) / scales.time), speed)


def steps_of(scene: Scene, path: Iterable[Step]) -> Iterator[tuple[Scene, Sliding]]:
    """The scene and the sliding displacement (m or L_x) at its own loading, then after each change of the path."""
    sliding: Sliding = (0.0,) * scene.dimension
    yield scene, sliding
    for step in path:
        changes = step.model_dump(exclude_none=True)
        asked = changes.pop("sliding", sliding[0]), changes.pop("sliding_y", sliding[-1])
        sliding = asked[: scene.dimension]
        loading = scene.loading.model_copy(update={"duration": None} | changes)
        scene = scene.model_copy(update={"loading": loading})
        yield scene, sliding


def plastic_pressure(interface: Interface) -> float | None:
    """Pressure of a plastic spot in Pa (E* without moduli): the hardness less what a law pulls at no gap, if any."""
    law, hardness = interface.law_of_the_gap, interface.hardness
    return hardness if hardness is None or law is None else hardness - law.pull * law.work_of_adhesion / law.range


def at_most(interface: Interface) -> str:
    """Say what the mean pressure of a wholly plastic contact is."""
    law = interface.law_of_the_gap
    less = "" if law is None or not law.pull else f", less what the {law.title} pulls at no gap"
    return f"the mean pressure is the hardness itself{less}"
