"""Loads and plasticity of a scene in units of L_x, E* and the rms gradient g.

A load under a hardness must stay below the one under which every node is plastic.
"""

import math
from collections.abc import Iterable, Iterator
from itertools import accumulate

from gfmd_numba.contact.state import LoadStep
from gfmd_numba.elasticity.plastic_sublayers import PlasticSublayers
from gfmd_numba.elasticity.scales import Scales
from gfmd_numba.kernels import Hardening
from gfmd_numba.scene import Body, Interface, Scene
from gfmd_numba.scene.loading import Step
from gfmd_numba.scene.quantities import LARGEST, SMALLEST
from gfmd_numba.scene.units import in_reduced_units, in_unit_of, quantities, rounded

_INCOMPRESSIBLE = 0.5 - 1e-12
SLIDING = ("sliding", "sliding_y")
_YIELDS = "the body yields at all depths"


def times_of(steps: Iterable[Scene]) -> list[float]:
    """Times in s at the end of steps, whose scenes have the durations of their loadings."""
    return list(accumulate(float(scene.loading.duration or 0.0) for scene in steps))


def plasticity(scene: Scene, scales: Scales, rms_gradient: float) -> PlasticSublayers | None:
    """J2 plasticity of the body (g E*, g and L_x), to 12 digits; None if it is elastic."""
    if scene.body.plasticity is None:
        return None
    given, voce = in_reduced_units(scene.body.plasticity, scales.length, rms_gradient * scales.modulus), {}
    if given.saturation_stress is not None and given.saturation_strain is not None:
        rise, strain = given.saturation_stress - given.yield_stress, rounded(given.saturation_strain / rms_gradient)
        voce = {"rise": rise, "strain": strain}
    slope = rounded((given.hardening or 0.0) * rms_gradient)  # over strains in g
    return PlasticSublayers(
        Hardening(given.yield_stress, slope, **voce), given.depth, given.sublayers, given.increments
    )


def whole_body_yields(body: Body) -> float:
    """Mean pressure in Pa (E* without moduli) under which a periodic body yields far below its surface; else infinite.

    Far below the surface the period prevents lateral strain, so that the lateral stress is nu / (1 - nu) of the
    pressure, and the body yields at a pressure of Y (1 - nu) / (1 - 2 nu).
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
            si = quantity.si if quantity is not None and scene.has_moduli else ""
            raise ValueError(f"below {in_unit_of(load, most / one * unit, si)}, at which {told}")
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
