"""What a loading prescribes at each step: the mean pressure in units of g E*, whatever units it is given in."""

from collections.abc import Iterator

from gfmd_numba.scene import Scene, SceneFile
from gfmd_numba.scene.quantities import LARGEST, SMALLEST
from gfmd_numba.scene.reduced_units import quantities, rounded


def reduced_pressure(scene: Scene, rms_gradient: float, contact_modulus: float) -> float | None:
    """Mean pressure p/(g E*) that the loading of a scene prescribes; None if it prescribes a displacement.

    A line load acts on the length L_x, a force on the area L_x^2. `contact_modulus` is that of the scene in Pa. Raises
    ValueError for a load beyond all measure beside the gradient and the modulus, or one that a hardness cannot bear.
    """
    loading = scene.loading
    if loading.displacement is not None:
        return None
    true_modulus = contact_modulus / scene.body.stiffness_scale
    load, quantity = getattr(loading, loading.control), quantities(type(loading)).get(loading.control)
    unit = 1.0 if quantity is None else quantity.scale(scene.length or 1.0, true_modulus) * rms_gradient
    found = load / unit
    if not SMALLEST <= found <= LARGEST:
        raise ValueError(f"a reduced pressure from {SMALLEST:g} to {LARGEST:g}, while this one comes to {found:.3g}")
    hardness = scene.interface.hardness
    if hardness is not None and found >= (most := hardness / (rms_gradient * true_modulus)):
        raise ValueError(f"below {most * unit:.6g}, at which the mean pressure is the hardness itself")
    return rounded(found)


def steps_of(file: SceneFile) -> Iterator[tuple[Scene, float]]:
    """The scene and the sliding displacement (m or L_x) at its own loading, then after each change of the path."""
    scene, sliding = file.scene, 0.0
    yield scene, sliding
    for step in file.path:
        changes = step.model_dump(exclude_none=True)
        sliding = changes.pop("sliding", sliding)
        scene = scene.model_copy(update={"loading": scene.loading.model_copy(update=changes)})
        yield scene, sliding
