"""Elastic bodies of a scene in units of L_x and E*, and the moduli that E* stands for."""

import math
from functools import lru_cache

from gfmd_numba.elasticity import moduli
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.scene import Body, LoadedBody, Scene
from gfmd_numba.scene.body_record import Layer
from gfmd_numba.scene.body_record import Material as MaterialRecord
from gfmd_numba.scene.units import rounded


def effective_modulus(body: Body, in_pascal: bool) -> float:
    """Modulus of the stiffness, in Pa, or 1 where stresses stay in E*: E* but for a `stiffness_scale`.

    Of layers that of the topmost one, which the shortest waves, and so the contact spots, feel alone.
    """
    if body.surface_modulus is None or not in_pascal:
        return body.stiffness_scale
    return moduli.plane_modulus(body.stiffness_scale * body.surface_modulus, body.surface_poissons_ratio, body.state)


@lru_cache(maxsize=4096)
def elastic_body(body: Body, length: float | None) -> ElasticBody:
    """The body of a record in units of L_x and E*, with all that is known of it; `length` is L_x in m, if known.

    Heights and moduli of layers have 12 digits, so that they are the same in all units.
    """
    if body.layers is None:
        nu = body.effective_poissons_ratio(body.surface_poissons_ratio)
        return ElasticBody(nu, None if math.isinf(body.aspect_ratio) else body.aspect_ratio)
    top = body.layers[0]

    def material(part: Layer | MaterialRecord) -> Material:
        shapes = (moduli.plane_modulus(1.0, each.poissons_ratio, body.state) for each in (part, top))
        modulus = part.youngs_modulus / top.youngs_modulus * (next(shapes) / next(shapes))
        return Material(rounded(modulus), body.effective_poissons_ratio(part.poissons_ratio))

    return ElasticBody.layered(
        tuple(rounded(layer.height / (length or 1.0)) for layer in body.layers),
        tuple(material(layer) for layer in body.layers),
        None if body.base is None or body.base == "rigid" else material(body.base),
    )


def contact_modulus(scene: Scene | LoadedBody) -> float:
    """Contact modulus E* in Pa of all that deforms: under one pressure compliances 1/E* add up."""
    own = [effective_modulus(body, scene.has_moduli) for body in scene.deformable]
    return own[0] if len(own) == 1 else 1.0 / sum(1.0 / each for each in own)


def compliance_share(scene: Scene | LoadedBody, body: Body) -> float:
    """Part E*/E_i* that a body of a scene has in the compliance 1/E*, to 12 digits: it is the same in all units."""
    return rounded(contact_modulus(scene) / effective_modulus(body, scene.has_moduli))


def stiffness_scale(scene: Scene | LoadedBody) -> float:
    """Factor by which all that deforms is stiffer than its moduli say."""
    if len(scene.deformable) == 1:
        return scene.body.stiffness_scale
    softness = sum(body.stiffness_scale / effective_modulus(body, in_pascal=True) for body in scene.deformable)
    return rounded(contact_modulus(scene) * softness)
