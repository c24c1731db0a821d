"""Units of the numbers of a scene, L_x, E* and a time, and its elastic bodies in these units."""

import math
from dataclasses import dataclass
from functools import lru_cache

from gfmd_numba.elasticity import moduli
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.elasticity.prony import PronySeries, in_series
from gfmd_numba.scene import Body, Scene
from gfmd_numba.scene.body_record import Layer, MaterialRecord
from gfmd_numba.scene.units import in_reduced_units, rounded


def effective_modulus(body: Body, in_pascal: bool) -> float:
    """E* in Pa, or 1 where stresses stay in E*.

    The E* of layers is that of the topmost one, as the shortest waves, and so the contact spots, feel this layer alone.
    """
    if body.surface_modulus is None or not in_pascal:
        return 1.0
    return moduli.plane_modulus(body.surface_modulus, body.surface_poissons_ratio, body.state)


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
    """Units of the numbers of a scene, and its bodies in these units, which no load changes.

    `length` is L_x in m, and `modulus` is E* in Pa. Under one pressure the compliances of two bodies add up,
    1/E* = 1/E_1* + 1/E_2*. Both are 1 where the scene has none. `time` is the longest relaxation time in s, 1 without
    one. `compliance_fractions` are the E*/E_i* of the `bodies`, to 12 digits: they are the same in all units.
    `relaxation` is the Prony series of the bodies together, its moduli over the relaxed E* and its times over `time`;
    None if nothing creeps.
    """

    length: float
    modulus: float
    time: float
    bodies: tuple[ElasticBody, ...]
    compliance_fractions: tuple[float, ...]
    relaxation: PronySeries | None


def scales_of(scene: Scene) -> Scales:
    """Return the scales of a scene."""
    return _scales(tuple(scene.deformable.values()), scene.length, scene.has_moduli)


@lru_cache(maxsize=4096)
def _scales(bodies: tuple[Body, ...], length: float | None, in_pascal: bool) -> Scales:
    time = max((branch.time for body in bodies for branch in body.relaxation or ()), default=1.0)
    moduli_of = [effective_modulus(body, in_pascal) for body in bodies]
    modulus = moduli_of[0] if len(bodies) == 1 else 1.0 / sum(1.0 / each for each in moduli_of)
    fractions = tuple(rounded(modulus / each) for each in moduli_of)
    # in its own modulus, so that it is the same in all units
    own = [in_reduced_units(body, length or 1.0, body.surface_modulus or 1.0, time) for body in bodies]
    branches = [body.relaxation or () for body in own]
    series = [PronySeries(tuple(each.modulus for each in of), tuple(each.time for each in of)) for of in branches]
    relaxation = None
    if any(branches):  # two bodies give way alike, as the table of combinations says, each by its fraction
        relaxation = series[0] if len(series) == 1 else in_series(tuple(zip(fractions, series, strict=True)))
    return Scales(length or 1.0, modulus, time, tuple(map(elastic_body, own)), fractions, relaxation)
