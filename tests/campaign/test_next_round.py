"""What a run does next, where errors follow from numbers of surfaces in closed form."""

from dataclasses import replace
from math import inf, nan

import numpy as np
import pytest

from gfmd_numba.analysis import UnusableDataError
from gfmd_numba.campaign import next_round
from gfmd_numba.campaign.limits import finer_levels, nodes_of
from gfmd_numba.campaign.next_round import Judgement, after, decide, judge
from gfmd_numba.campaign.rounds import Round, TargetError
from support.closed_form_rounds import HELD, LEVELS, VALUE, Pilot, fitted, known, state

pytestmark = pytest.mark.usefixtures("in_closed_form")


@pytest.fixture
def in_closed_form(monkeypatch):
    monkeypatch.setattr(next_round, "Pilot", Pilot)


MET = Judgement(error=0.1, sampling=0.1, factor=1.0, predicted=0.1)
MISSED = Judgement(error=0.16, sampling=0.16, factor=1.0, predicted=0.1)
HARD = {"exponents": 0.08, "scatter": 2.0}


# target, price allowed and what else is so; then surfaces of each case (least, most), whether the round is to be the
# last one, and the surfaces by which the target is expected. An error of e needs 1 / e^2 surfaces
@pytest.mark.parametrize(
    ("target", "most", "given", "surfaces", "is_last", "expected"),
    [
        (0.08, inf, {}, (157, 157), True, 157),
        (0.05, inf, {}, (400, 400), True, 400),  # four times the price of all before, and no more at once
        (0.02, inf, {}, (385, 400), False, 2500),
        (0.02, 300 / HELD, {}, (290, 300), True, 2500),  # all that the budget allows
        (0.06, 300 / HELD, {}, (278, 278), True, 278),
        (0.095, inf, {}, (125, 155), True, ...),  # no round is smaller than a quarter of all before
        (0.08, inf, {"group": {"caution": 1.25, "steps": 2}}, (157, 157), True, 157),
        (0.08, inf, {"found": MISSED, "after_pilot": True}, (157, 157), True, 157),
        (0.08, inf, {"found": MISSED}, (400, 400), True, 400),  # 1.6 times what was expected, and so may be the next
        (0.08, inf, {"found": replace(MISSED, predicted=0.2)}, (157, 157), True, 157),
        (0.06, inf, {"found": MISSED}, (385, 400), True, 712),  # of which 400 may do
        (0.2, inf, {"found": MISSED}, (125, 155), True, ...),
        (0.08, inf, {"found": replace(MISSED, error=inf)}, (157, 157), True, 157),
        (0.075, inf, {"group": HARD}, (249, 249), False, None),  # twice the target is all that can be promised
        (0.075, inf, {"group": HARD | {"scatter": 5.0}}, (385, 400), False, None),
        (0.06, inf, {"groups": ({}, {"scatter": 0.5})}, ((278, 100), (278, 100)), True, 378),
        (0.05, inf, {"groups": ({}, {"scatter": 0.5, "twin": 0})}, ((400, 400), (400, 400)), True, 400),
    ],
)
def test_a_round_has_as_many_surfaces_as_the_target_needs(target, most, given, surfaces, is_last, expected):
    found = known(given.get("groups", (given.get("group", {}),)))
    spent = found.whole_price(found.held)
    each = spent / HELD / len({group.problems for group in found.groups})
    judged, first = given.get("found", MET), given.get("after_pilot", False)
    another = decide(found, judged, target, most * spent, after_pilot=first)
    least, largest = (np.repeat(end, len(another.realisations) // np.size(end)) for end in surfaces)
    assert (least <= another.realisations).all()
    assert (another.realisations <= largest).all()
    assert another.is_last is is_last
    assert another.price == pytest.approx(found.whole_price(np.array(another.realisations)))
    assert another.predicted_error == max(one.error for one in found.predictions(np.array(another.realisations)))
    if expected is not ...:
        assert another.target_price == (None if expected is None else pytest.approx(expected * each))


def test_a_round_that_hardly_adds_is_none():
    found = known()
    spent = found.whole_price(found.held)
    assert decide(found, MET, 0.05, 1.2 * spent) is None
    assert decide(found, MET, 0.05, 1.26 * spent) is not None


@pytest.mark.parametrize(
    ("target", "group", "why"),
    [
        (0.0007, {}, r"it would take more than 1000000 realisations of a level; .*further from the reference"),
        (0.01, {"interactions": 0.05}, r"leave an error of 5%, as no cross level tells"),
        (0.01, {"exponents": 0.05}, r"leave an error of 5%, as the exponents are not known better than that"),
        (
            0.01,
            {"exponents": 0.05, "steps": 2},
            r"leave an error of 5%, as the exponents are not known better than that",
        ),
        (0.07, {"exponents": 0.08}, r"leave an error of 8%, as the exponents"),  # and twice the target is nothing new
        (0.01, {"exponents": 0.04, "interactions": 0.03}, r"as the exponents are not known"),
        (0.01, {"exponents": 0.03, "interactions": 0.04}, r"as no cross level tells"),
        (
            0.01,
            {"scatter": 50.0, "exponents": 0.02},
            r"leave an error of 5.4%; .*, or levels further from the reference",
        ),
    ],
)
def test_a_target_out_of_reach_says_why(target, group, why):
    with pytest.raises(UnusableDataError, match=why):
        decide(known((group,)), MET, target)


def test_the_group_whose_target_is_out_of_reach_is_named():
    groups = ({"hurst": 0.3}, {"hurst": 0.8, "exponents": 0.05})
    for found, said in ((known(groups), "^hurst = 0.8: 1000000 real"), (known(groups[1:]), "^1000000 real")):
        with pytest.raises(UnusableDataError, match=said):
            decide(found, MET, 0.01)


@pytest.mark.parametrize(
    ("fixed", "advised"),
    [
        ({}, r"in our campaigns, `fit: \{fixed: \{eps_f: \[0.3, 2\]\}\}`$"),
        ({"eps_t": 1.0}, r"in our campaigns, `fit: \{fixed: \{eps_f: \[0.3, 2\]\}\}`$"),
        ({"eps_f": (0.3, 2.0)}, r"or narrower ranges under `fit: \{fixed: ...\}`$"),
    ],
)
def test_ranges_of_exponents_are_advised_where_none_are_given(fixed, advised):
    with pytest.raises(UnusableDataError, match=advised):
        decide(known(({"exponents": 0.05, "hurst": 0.8},), fixed=fixed), MET, 0.01)


@pytest.mark.parametrize(
    ("errors", "sampling", "factor", "worst"),
    [
        ((0.04, 0.05), (0.04, 0.05), 1.2, (0.05, 0.06, 1.2)),  # all from surfaces: the factor holds for all of it
        ((0.05, 0.05), (0.03, 0.0), 1.2, (0.05, np.sqrt(0.05**2 + 0.44 * 0.03**2), None)),
        ((0.05, nan), (0.03, nan), 1.2, (inf, inf, 1.2)),  # refused
        ((0.0,), (0.0,), 1.2, (0.0, 0.0, 1.2)),
    ],
)
def test_an_error_that_holds_counts_that_of_surfaces_with_its_factor(errors, sampling, factor, worst):
    found = known(({"factor": factor},) * len(errors))
    judged = judge(fitted(found, errors, sampling=sampling))
    assert (judged.error, judged.sure_error) == pytest.approx(worst[:2])
    assert judged.sure_factor == pytest.approx(worst[2] or judged.sure_error / judged.error)
    assert judged.predicted == 0.1


LEVELS_OF = {limit: finer_levels(LEVELS, limit, 4.0) for limit in ("eps_c", "eps_f", "eps_t")}
LEVELS_OF["half eps_f"] = finer_levels(LEVELS, "eps_f", 2.0)
BOTH = {"errors": (0.06, 0.06), "groups": ({}, {})}


def told(target=0.05, errors=(0.04,), groups=({},), laws=None, may_refine=False, rounds=1, budget=None, **more):
    """What a run does after a round: errors of 4 %, where 100 surfaces of two levels lead to expect 10 %.

    `laws` is what the distance in each limit leaves open, the budget is in prices of the round.
    """
    planned = {"is_last": more.pop("is_last", False)}
    found = known(groups, fixed={"eps_f": 0.7} if "contradiction" in more else None)
    spent = found.whole_price(found.held)
    texts = {name: np.full(len(errors), more.pop(name), object) for name in ("fit_status", "message") if name in more}
    if "n_stretches" in more:
        texts["n_stretches"] = np.full(len(errors), more.pop("n_stretches"))
    if "misfit" in more:
        texts["misfit"] = np.broadcast_to(more.pop("misfit"), len(errors))
    if "contradiction" in more:
        texts["contradiction"] = np.outer(np.broadcast_to(more.pop("contradiction"), len(errors)) * VALUE, [0, 1, 0])
    given = fitted(found, errors, bridged=laws, **texts, **more)
    before = state(found, {"kappa": target}, (LEVELS,) * len(groups), budget and budget * spent, rounds, **planned)
    return after(before, [given], may_refine)


def so(**given):
    return given


@pytest.mark.parametrize(
    ("given", "next_one"),
    [
        (so(is_last=True), "reached"),
        (so(target=0.1), "reached"),
        (so(), 400),  # luck, which a round has to confirm
        (so(target=0.099, errors=(0.104,)), 125),
        (so(laws={"eps_f": 0.02}, is_last=True), "reached"),
        (so(target=0.03, laws={"eps_f": 0.04, "eps_t": 0.03}), "leaves 5.00% open, mostly that of eps_f, however many"),
        (so(target=0.03, laws={"eps_f": 0.01, "eps_t": 0.03}), "leaves 3.16% open, mostly that of eps_t, however many"),
        (so(target=0.03, rivals=0.04, laws={"eps_f": 0.03}), "leaves 5.00% open, mostly that of eps_f"),
        (so(laws={"eps_f": (0.01, 0.05)}, **BOTH), "leaves 5.00% open, mostly that of eps_f"),
        (so(laws={"eps_f": 0.06}, misfit=(1.0, 2.0), **BOTH), "leaves 6.00% open, mostly that of eps_f"),
        (so(target=0.1, errors=(0.11,), laws={"eps_f": 0.06}), (157, 0.1)),  # 8 % of surfaces, with 6 % of laws
        (so(target=0.1, errors=(0.11,) * 2, laws={"eps_f": (0.01, 0.06)}, groups=({}, {})), (157, 0.1)),
        (so(target=0.1, errors=(0.13,), sampling=0.1, laws={"eps_f": 0.06}, rounds=2), (157, 0.1)),
        (so(target=0.1, errors=(0.13,), laws={"eps_f": 0.08}), (157, 0.113)),  # no better than the laws
        (so(target=0.08, errors=(0.1,), groups=({"factor": 1.5},)), (157, 0.08)),
        (
            so(target=0.08, errors=(0.1,), groups=({"factor": 1.5},), rounds=2),
            (352, 0.0533),
        ),  # to make up for the factor
        (so(misfit=1.6, is_last=True), "no law of the limits describes the means; gfmd needs finer levels"),
        (
            so(misfit=(1.6, 1.0), is_last=True, errors=(0.04, 0.04), groups=({}, {})),
            "no law of the limits describes the means",
        ),
        (so(misfit=1.6, target=0.1), (205, 0.122)),  # laws may fit better where the means are known better: to 7 %
        (so(misfit=1.4, is_last=True), "reached"),
        (so(misfit=9.0, residual=0.01, is_last=True), "reached"),  # many surfaces tell of what does not matter
        (so(misfit=9.0, residual=0.02, is_last=True), "no law of the limits describes the means"),
        (so(fit_status="refused", message="no exponent\nno idea", is_last=True), "refused, no exponent; no idea"),
        (so(fit_status="refused", message="no exponent", target=0.1), (205, 0.122)),
        (so(contradiction=-0.04), "contradict the fixed eps_f: 0.7; gfmd allows the range"),
        (so(contradiction=(0.0, 0.04), **BOTH), "contradict the fixed eps_f: 0.7; gfmd allows the range"),
        (so(contradiction=0.03), 400),
        (so(errors=(0.6,), rounds=3), "the limit of kappa is 0 within two standard errors"),
        (so(errors=(0.6,), rounds=3, laws={"eps_f": 0.55}), "too far from the finest levels, above all that of eps_f"),
        (
            so(fit_status="refused", message="one hill", n_stretches=2.0),
            "not reached: one hill",
        ),  # surfaces do not help
        (so(errors=(0.6,), rounds=2), 400),
        (so(errors=(0.4,), rounds=3), 400),
        (so(errors=(nan,), rounds=3), 400),
        (so(rounds=11), "10 rounds did not suffice"),
        (so(rounds=10), 400),
        (so(rounds=11, is_last=True), "reached"),
        (so(budget=1.2), "the budget is too small for another round"),
        (so(target=0.005, groups=({"exponents": 0.05},)), "`fit: {fixed: {eps_f: [0.45, 2]}}`$"),
        (so(target=0.005, groups=({"interactions": 0.05},)), "under `limits: {cross: ...}`$"),
    ],
)
def test_a_run_with_levels_of_the_user(given, next_one):
    """Surfaces of each case, also with the error that they are to bring, or how the run ends."""
    done = told(**given)
    if isinstance(next_one, str):
        assert done.ended.startswith("reached" if next_one == "reached" else "not reached: ")
        assert next_one.strip("$") in done.ended
        assert done.ended.endswith(next_one.strip("$")) or not next_one.endswith("$")
        return
    assert done.now.levels == done.rounds[0].levels
    surfaces, error = next_one if isinstance(next_one, tuple) else (next_one, done.now.predicted_error)
    assert (done.ended, len(done.rounds)) == ("", given.get("rounds", 1) + 1)
    assert surfaces <= min(done.now.realisations) == max(done.now.realisations) <= 1.25 * surfaces
    assert done.now.predicted_error == pytest.approx(error, rel=5e-3)


@pytest.mark.parametrize(
    ("given", "next_one"),
    [
        (so(), "reached"),  # whatever was planned: levels are no luck
        (so(errors=(0.06,), laws={"eps_f": 0.04}), "half eps_f"),
        (so(errors=(0.09,), laws={"eps_f": 0.08}), "eps_f"),  # half of it is above 70 % of the target
        (so(errors=(0.06,), laws={"eps_c": 0.04, "eps_f": 0.03}), "eps_c"),
        (so(errors=(0.06,), laws={"eps_t": 0.04, "eps_f": 0.03}), "eps_t"),
        (so(errors=(0.06,), laws={"eps_t": 0.03}, rivals=0.04), "eps_f"),  # which fits differ in, however fine
        (so(misfit=2.0), "eps_f"),
        (so(misfit=2.0, residual=0.01), "reached"),
        (so(misfit=2.0, residual=0.01, groups=({"factor": 1.2},)), "eps_f"),
        (so(fit_status="refused", is_last=True), "eps_f"),
        (so(fit_status="refused", n_stretches=2.0), "eps_t"),
        (
            so(fit_status="refused", n_stretches=2.0, message="one hill", budget=1.1),
            "one hill: the budget is too small",
        ),
        (so(errors=(0.11,), laws={"eps_c": 0.03}), "eps_c"),  # for less than half of the surfaces' price
        (so(target=0.1, errors=(0.11,), laws={"eps_c": 0.03}), 125),
        (so(target=0.1, errors=(0.11,)), 125),
        (so(errors=(0.06,), laws={"eps_f": 0.02}, groups=({"exponents": 0.06},)), "eps_f"),  # surfaces do not do alone
        (so(errors=(0.06,), laws={"eps_f": 0.04}, budget=1.1), "too small for the finer levels that the laws need"),
        (so(target=0.1, errors=(0.11,), laws={"eps_c": 0.03}, budget=1.26), 120),
        (so(errors=(0.06,), laws={"eps_f": 0.04}, contradiction=-0.04), "contradict the fixed eps_f"),
        # along a path, the worst step of a group decides
        (so(errors=(0.06,) * 3, laws={"eps_f": (0.01, 0.04, 0.01), "eps_t": (0.03, 0, 0.03)}, steps=3), "half eps_f"),
        (so(errors=(0.06,) * 3, laws={"eps_f": (0.04, 0.01, 0.01), "eps_t": (0, 0.045, 0.03)}, steps=3), "eps_t"),
    ],
)
def test_a_run_that_may_refine(given, next_one):
    """Surfaces of each case, the limit with finer levels, or how the run ends."""
    steps = given.pop("steps", 1)
    done = told(**({"groups": ({"steps": steps},)} | given), may_refine=True)
    if next_one in LEVELS_OF:
        assert done.now.levels == (tuple(LEVELS_OF[next_one]),)
        assert (done.now.is_last, done.now.predicted_error, done.ended) == (False, None, "")
        counts = dict(zip(done.now.cases, done.now.realisations, strict=True))
        assert all(counts[0, level] >= HELD for level in LEVELS)
    elif isinstance(next_one, str):
        assert next_one in done.ended
    else:
        assert (done.now.levels, done.ended) == ((LEVELS,), "")
        assert min(done.now.realisations) >= next_one


def test_each_step_of_a_path_has_the_factor_of_its_group():
    found = known(({"steps": 2, "factor": 1.5}, {"steps": 2, "scatter": 1.2}))
    judged = judge(fitted(found, (0.04, 0.05, 0.04, 0.05)))  # groups at the first step, then the next
    assert (judged.error, judged.sure_error, judged.predicted) == pytest.approx((0.04, 0.06, 0.12))


@pytest.mark.parametrize(
    ("finer", "misfit", "ends"),
    [
        (((0, 1), (0, 1)), (2.0, 1.0), True),
        (((0,), (0,)), (2.0, 2.0), True),
        (((0, 1), (0, 1), ()), (2.0, 1.0), False),
        (((1,), (1,)), (2.0, 1.0), False),
        (((0,), (1,)), (2.0, 1.0), False),
        (((0, 1), (0, 1)), (1.4, 1.0), False),
        (((0, 1),), (2.0, 1.0), False),
    ],
)
def test_levels_of_a_group_that_became_finer_twice_in_vain_end_a_run(finer, misfit, ends):
    """Each of `finer` names the groups whose levels a round has made finer."""
    levels = [(LEVELS, LEVELS)]
    for groups in finer:
        levels.append(tuple((*of_group, *LEVELS[-1:] * (group in groups)) for group, of_group in enumerate(levels[-1])))
    found = known([{"levels": of_group} for of_group in levels[-1]])
    now = state(found, {"kappa": 0.05}, levels[-1])
    rounds = tuple(now.now.model_copy(update={"levels": each}) for each in levels)
    given = fitted(found, (0.06, 0.06), misfit=np.array(misfit))
    ended = after(now.model_copy(update={"rounds": rounds}), [given], may_refine=True).ended
    assert ("no law of the limits describes the means (misfit 2), although the levels became finer" in ended) is ends


def test_finer_levels_are_priced_by_their_grids_and_the_transforms_of_the_reference():
    """Problems that two groups share count once, levels that stay cost what they have cost."""
    of_1024, of_2048, of_256 = (40.0 * (n * np.log2(n) + 2**15) for n in (1024, 2048, 256))
    for groups, one in ((({}, {"twin": 0}), 1), (({}, {}), 2)):
        done = told(errors=(0.06,) * 2, laws={"eps_f": 0.04}, may_refine=True, groups=groups)
        finest, *rest = done.now.realisations[:3]
        assert (finest, rest) == (20, [HELD, HELD])
        assert done.now.price == pytest.approx(one * (20 * of_2048 + HELD * (of_1024 + of_256)))


@pytest.mark.parametrize(
    ("errors", "given", "surfaces"),
    [
        ((0.06, 0.11), {}, (157, 157)),  # 4 % of surfaces, with 3 % of laws
        ((0.06, 0.11), {"rounds": 2}, (310, 320)),  # which have to make up for their factor
        ((0.06, 0.11), {"budget": 1.5}, (157, 157)),
        ((0.06, 0.11), {"budget": 1.25}, (125, 135)),
        ((0.06, 0.11), {"budget": 1.1}, (100, 100)),
        ((0.06, 0.04), {}, (100, 100)),
        ((0.06, inf), {}, (100, 100)),
        ((0.06, 0.11, 0.11), {"laws": (0.04, 0.03, 0.01)}, (157, 157)),
        ((0.06, 0.04, 0.06, 0.11), {"laws": (0.04, 0.03) * 2, "steps": 2}, (157, 157)),
    ],
)
def test_groups_that_keep_their_levels_get_surfaces_in_the_same_round(errors, given, surfaces):
    """As many as leave, with the part of their laws, the target; none for what is met or what no surface mends."""
    budget, steps, rounds = (given.get(name) for name in ("budget", "steps", "rounds"))
    kept = {"steps": steps or 1, "scatter": 0.5, "factor": 1.1}
    groups = ({"steps": steps or 1}, *[kept] * (len(errors) // (steps or 1) - 1))
    laws = {"eps_f": given.get("laws", (0.04, 0.03))}
    done = told(errors=errors, laws=laws, budget=budget, may_refine=True, groups=groups, rounds=rounds or 1)
    assert done.now.levels == (tuple(LEVELS_OF["half eps_f"]), *[LEVELS] * (len(groups) - 1))
    counts = [number for (group, _), number in zip(done.now.cases, done.now.realisations, strict=True) if group]
    assert surfaces[0] <= min(counts) == max(counts) <= surfaces[1]
    assert done.now.price <= (budget or inf) * done.rounds[-2].price
    nodes = np.array([nodes_of(level, 1) for _, level in done.now.cases])
    assert done.now.price == pytest.approx(done.now.realisations @ (40.0 * (nodes * np.log2(nodes) + 2**15)))


def of_variables(targets, errors):
    found = [known(variable=name) for name in targets]
    fits = [fitted(one, (error,), name) for one, name, error in zip(found, targets, errors, strict=True)]
    return after(state(found[0], targets, (LEVELS,)), fits, may_refine=True)


def test_the_target_that_is_furthest_away_decides():
    for first, second in ((0.02, 0.05), (0.05, 0.02)):
        done = of_variables({"kappa": first, "mean_gap": second}, (0.06, 0.06))
        assert done.now.variable == ("kappa" if first < second else "mean_gap")
        assert {name: error.reached for name, error in done.rounds[0].errors.items()} == {
            "kappa": False,
            "mean_gap": False,
        }
    done = of_variables({"kappa": 0.07, "mean_gap": 0.05}, (0.06, 0.06))
    assert {name: error.reached for name, error in done.rounds[0].errors.items()} == {"kappa": True, "mean_gap": False}
    assert done.now.variable == "mean_gap"
    assert of_variables({"kappa": 0.07, "mean_gap": 0.07}, (0.06, 0.06)).ended == "reached"


def test_the_variable_that_ends_a_run_is_named_where_there_are_several():
    groups = ({"exponents": 0.05, "twin": 0},) * 2
    ends = []
    for names in (("kappa",), ("kappa", "mean_gap")):
        found = [known(groups, fixed={"eps_f": (0.5, 1.0)}, variable=name) for name in names]
        budget = {"eps_f": (0.05, 0.0), "eps_t": (0.03, 0.03)}
        fits = [fitted(one, (0.06,) * 2, name, **budget) for one, name in zip(found, names, strict=True)]
        ends.append(after(state(found[0], dict.fromkeys(names, 0.01)), fits).ended)
    assert ends[0].startswith("not reached: hurst = 0: 1000000 realisations")
    assert ends[0].endswith("`fit: {fixed: ...}` (above all that of eps_f)")
    assert ends[1].startswith("not reached: kappa: hurst = 0: 1000000 realisations")


def test_what_a_round_took_is_noted_with_it():
    done = told()
    first = done.rounds[0]
    assert (first.cpu_seconds, first.errors["kappa"].error) == (3.0, pytest.approx(0.04))
    found = known()
    assert first.price == pytest.approx(found.whole_price(found.held))


def test_the_price_of_a_realisation_is_that_of_its_transforms():
    """Those of runs that failed do not count, and a case without any good one costs what others do."""
    transforms = np.array([[10.0, 1e6], [20.0, 40.0], [5.0, 5.0]])
    status = np.array([[0, 5], [0, 0], [5, 5]])
    levels = (*LEVELS, (1 / 2, 1 / 8, 1 / 4))
    dims = ("case", "realisation")
    on_maps = {"nx": ("case", np.array([32, 16, 8])), "dimension": ("case", np.full(3, 2))}
    found = known(levels=levels, n_transforms=(dims, transforms), status=(dims, status), **on_maps)
    of = [n * np.log2(n) + 2**15 for n in (32**2, 16**2, 8**2)]
    assert found.price == pytest.approx([10 * of[0], 30 * of[1], 20 * of[2]])
    with pytest.raises(UnusableDataError, match="you gave no good realisation"):
        known(levels=levels, status=(dims, status + 1)).price  # noqa: B018


@pytest.mark.parametrize("targets", [{"kappa": 0.02}, {"kappa": 0.05, "mean_gap": 0.02}])
def test_results_tell_of_each_target_what_was_expected_and_found(targets):
    """A round is decided for one of them, of the others nothing is expected; the last one has not run."""
    told_of = of_variables(targets, (0.06,) * len(targets)).variables()
    errors = np.reshape(told_of["round_error"][1], (2, -1))
    assert told_of["round_error"][0] == (("round", "target") if len(targets) > 1 else "round")
    np.testing.assert_allclose(errors, [[0.06] * len(targets), [nan] * len(targets)])
    expected = np.reshape(told_of["round_predicted_error"][1], (2, -1))
    assert np.isfinite(expected).tolist() == [[False] * len(targets), [name == [*targets][-1] for name in targets]]
    assert ("target" in told_of) is (len(targets) > 1)
    assert told_of["round_realisations"][1][0] == [HELD] * len(LEVELS)


@pytest.mark.parametrize(
    ("stretches", "earlier", "ended"),
    [(1.1, None, "not reached: one hill"), (2.0, None, ""), (nan, 0.5, "too far from the finest"), (nan, 0.9, "")],
)
def test_levels_become_finer_as_long_as_that_brings_the_limit_nearer(stretches, earlier, ended):
    """Contacts of one hill become those of more, or the error falls by a fifth in two rounds."""
    levels = [LEVELS]
    for _ in range(2):
        levels.append(tuple(finer_levels(levels[-1], "eps_t", 2.0)))
    refused = {"fit_status": ["refused"], "message": ["one hill"]} if earlier is None else {}
    found = known(({"levels": levels[-1]},))
    given = fitted(found, (0.6,), bridged={"eps_t": 0.55}, n_stretches=[stretches], **refused)
    before = state(found, {"kappa": 0.05}, (levels[-1],))
    errors = {"kappa": TargetError(error=earlier, factor=1.0, reached=False)}
    rounds = [
        Round(realisations=(HELD,) * len(each), is_last=False, levels=(each,), variable="kappa", errors=errors)
        for each in levels
    ]
    done = after(before.model_copy(update={"rounds": tuple(rounds)}), [given], may_refine=True)
    assert done.ended.startswith(ended) or ended in done.ended
    assert bool(done.ended) == bool(ended)
