"""Fields at displaced nodes are those of the waves, and forces handed back do the same work."""

import numpy as np
import pytest

from gfmd_numba.fourier.displaced_nodes import DisplacedNodes

SHAPES = [(48,), (24, 48)]


def places(shape):
    return [each / n for each, n in zip(np.indices(shape), shape, strict=True)][::-1]


@pytest.mark.parametrize("shape", SHAPES)
def test_a_wave_is_read_where_the_nodes_are(shape):
    way = 0.3 * np.random.default_rng(0).normal(size=(len(shape), *shape))

    def wave(*places):
        return np.cos(2.0 * np.pi * np.dot([3, -2][: len(shape)], np.array(places).reshape(len(shape), -1)) + 0.4)

    x = places(shape)
    found = DisplacedNodes(way).values(wave(*x).reshape(shape))
    expected = wave(*(each + moved for each, moved in zip(x, way, strict=True))).reshape(shape)
    np.testing.assert_allclose(found, expected, atol=2e-6)
    still = DisplacedNodes(0.0 * way).values(expected)
    np.testing.assert_allclose(still, expected, atol=1e-14)


@pytest.mark.parametrize("shape", SHAPES)
def test_forces_handed_back_do_the_work_of_those_on_the_nodes(shape):
    rng = np.random.default_rng(1)
    nodes = DisplacedNodes(0.1 * rng.normal(size=(len(shape), *shape)))
    forces, field = rng.normal(size=shape), rng.normal(size=shape)
    assert np.sum(forces * nodes.values(field)) == pytest.approx(np.sum(nodes.handed_back(forces) * field))
    assert nodes.handed_back(forces).sum() == pytest.approx(forces.sum())
