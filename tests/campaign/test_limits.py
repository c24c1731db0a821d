"""Levels, surfaces and exponents of limits: what a campaign file may say of them, and what a run chooses."""

import pytest
from pydantic import ValidationError

from gfmd_numba.campaign.limits import (
    MOST,
    FixedExponents,
    Limits,
    Realisations,
    finer_levels,
    first_levels,
    first_realisations,
    limits_around,
    nodes_of,
)

# as 1 / eps_c, 1 / eps_f and 1 / eps_t
PROFILE, COARSER, COARSEST = (2, 64, 4), (2, 16, 4), (2, 4, 4)


def levels(*inverse):
    return [tuple(1 / each for each in level) for level in inverse]


@pytest.mark.parametrize(
    ("given", "limit", "step", "added"),
    [
        ((PROFILE, COARSER, COARSEST), "eps_c", 4.0, [(4, 64, 4), (4, 16, 4)]),
        ((PROFILE, COARSEST, COARSER, (8, 64, 4)), "eps_c", 4.0, [(16, 64, 4), (16, 16, 4)]),
        ((PROFILE, COARSER), "eps_t", 4.0, [(2, 64, 8), (2, 16, 8)]),
        ((PROFILE,), "eps_t", 4.0, [(2, 64, 8)]),
        ((PROFILE, (2, 256, 4)), "eps_c", 4.0, [(4, 64, 4)]),  # finer ones cost more, and tell no more
        ((PROFILE, COARSER), "eps_f", 4.0, [(2, 256, 4)]),
        ((PROFILE, COARSER), "eps_f", 2.0, [(2, 128, 4)]),
        ((PROFILE, (2, 64, 2)), "eps_f", 4.0, [(2, 256, 4), (2, 256, 2), (2, 64, 8)]),
        ((PROFILE, (2, 64, 8)), "eps_f", 4.0, [(2, 256, 4), (2, 256, 8)]),
    ],
)
def test_finer_levels(given, limit, step, added):
    """In the direction of a limit, at the reference and one level coarser in eps_f; a finer eps_f is the reference."""
    found = finer_levels(levels(*given), limit, step)
    assert set(found) - set(levels(*given)) == set(levels(*added))
    assert len(found) == len(given) + len(added)
    assert found[0] == levels(added[0] if limit == "eps_f" else PROFILE)[0]


@pytest.mark.parametrize(
    ("dimension", "anisotropy", "layer", "reference"),
    [
        (1, 1.0, float("inf"), (2, 1024, 4)),
        (2, 1.0, float("inf"), (2, 32, 2)),
        (2, 2.0, float("inf"), (2, 32, 4)),  # waves that are twice as long along y go once around at 2 eps_t
        (2, 2.1, float("inf"), (2, 32, 8)),
        (2, 1.0, 0.01, (2, 32, 2)),  # layers are thin on maps, too, but finer ones too dear
        (1, 1.0, 1 / 4, (2, 1024, 4)),
        (1, 1.0, 0.2, (2, 1024, 8)),
        (1, 1.0, 1 / 1000, (2, 1024, 64)),
    ],
)
def test_first_reference(dimension, anisotropy, layer, reference):
    found = first_levels(dimension, anisotropy, layer)
    assert found[0] == levels(reference)[0]
    assert len(set(found)) == len(found) == 11
    assert max(level[2] for level in found) * anisotropy <= 1.0


def test_levels_around_a_reference_are_those_of_a_campaign_file():
    found = limits_around(*levels(PROFILE), levels(COARSER, (4, 64, 4), (4, 64, 2), COARSEST))
    assert (found.eps_c, found.eps_f, found.eps_t) == ((1 / 4,), (1 / 16, 1 / 4), None)
    assert found.crossed == ({"eps_c": 1 / 4, "eps_t": 1 / 2},)
    assert found.varied == {"eps_c", "eps_f", "eps_t"}
    assert Limits(eps_f=[1 / 4]).varied == {"eps_f"}


def test_cheap_levels_begin_with_more_surfaces():
    """In proportion to the power 2/3 of their cost, at most 400 but for a pilot that needs more of each."""
    given = levels((2, 64, 4), (2, 8, 4), (2, 64, 32), (1, 1, 1))
    assert [nodes_of(level, 1) for level in given] == pytest.approx([1024, 128, 8192, 2])
    assert nodes_of(given[1], 2) == 128**2
    assert first_realisations(given, 1) == [80, 320, 20, 400]
    assert first_realisations(given[:2], 1) == [20, 80]
    assert first_realisations(given[:2], 2) == [20, 320]
    assert first_realisations(given[:2], 1, fewest=30) == [30, 120]
    assert first_realisations(given[:2], 1, fewest=500) == [500, 500]


@pytest.mark.parametrize("given", [1, 0.5, [0.5, 2], (1, 1), [0.5, 1e3]])
def test_an_exponent_is_known_or_lies_in_a_range(given):
    found = FixedExponents(eps_f=given).eps_f
    assert found == (tuple(given) if isinstance(given, list | tuple) else given)
    assert all(type(each) is float for each in (found if isinstance(found, tuple) else (found,)))


@pytest.mark.parametrize("given", [0, -1.0, True, "1", [1], [1, 2, 3], [2, 1], [0, 1], [1, float("inf")], [1, True]])
def test_what_is_no_exponent_is_refused(given):
    with pytest.raises(ValidationError, match="a finite number above 0, or the range it lies in"):
        FixedExponents(eps_f=given)


@pytest.mark.parametrize(("given", "found"), [(1, [1, 1]), (MOST, [MOST] * 2), ([3, 0], [3, 0]), (None, [7, 7])])
def test_levels_have_surfaces_of_their_own_or_those_of_the_reference(given, found):
    numbers = Realisations(reference=7, eps_f=given)
    assert [numbers.of("eps_f", level) for level in (0, 1)] == found


@pytest.mark.parametrize("given", [0, MOST + 1, True, 2.0, [], [-1], [True], [MOST + 1], "3"])
def test_what_is_no_number_of_surfaces_is_refused(given):
    with pytest.raises(ValidationError, match="a whole number from 1 to 1000000, or a list of such"):
        Realisations(reference=7, eps_f=given)
