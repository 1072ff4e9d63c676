"""The search on the arm: restless joints are softened until calm, calm ones varied, what helps is tried again."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from greywhale.commission.judge import TrialVerdict
from greywhale.commission.search import KD, KI, KP, MOST_SOFTER, JointSearch
from greywhale.simulate import CONTROLLER_COLUMNS, default_controller
from greywhale.simulate.controllers import check_controllers

BEFORE = default_controller()[0]
TUNED = BEFORE.copy()
TUNED[[KP, KD, KI]] = 65536 * np.array([1, 1, 100])
Row = np.ndarray


def verdict(
    score: float, *, restless: bool = False, chatters: bool = False, worse: bool = False, excess: float = 3.0
) -> TrialVerdict:
    faults = (("restless",) if restless or chatters else ()) + (("worse",) if worse else ())
    return TrialVerdict(
        0, faults, restless or chatters, chatters and not restless, excess, score, 0.25, True, not faults
    )


def begun() -> JointSearch:
    search = JointSearch(0, 1)
    search.add(BEFORE, verdict(1.0), "before")
    search.begin()
    return search


def after_trial(found: TrialVerdict) -> JointSearch:
    """Of the tuned controller."""
    search = begun()
    search.add(TUNED, found, "trial-1")
    return search


def proposal(search: JointSearch, promises: Callable[[Row], bool] = lambda row: True) -> Row:
    row = search.propose(promises)
    assert row is not None
    return row


def run(judge: Callable[[Row], TrialVerdict], trials: int = 20) -> JointSearch:
    """Play the search against an arm of which `judge` says how it does."""
    search, row = begun(), TUNED
    for number in range(trials):
        search.add(row, judge(row), f"trial-{number}")
        proposed = search.propose()
        if proposed is None:
            return search
        row = proposed
    return search


def test_a_joint_that_hunts_gets_softer_until_it_rests() -> None:
    limit = 0.3 * 65536
    search = run(lambda row: verdict(0.1, restless=bool(row[KP] > limit), excess=5.0))
    assert search.best.row[KP] <= limit
    first, second = search.tried[2].row, search.tried[3].row
    assert first[KP] == TUNED[KP] // 2
    assert first[KI] < TUNED[KI] / 5
    assert first[KD] / first[KP] > TUNED[KD] / TUNED[KP], "relatively more damping"
    assert second[KP] == TUNED[KP] // 4


@pytest.mark.parametrize(("excess", "kept"), [(1.1, 0.78), (2.0, 0.71), (4.0, 0.5)])
def test_the_less_a_joint_hunts_the_less_it_is_softened(excess: float, kept: float) -> None:
    row = proposal(after_trial(verdict(0.1, restless=True, excess=excess)))
    assert row[KP] / TUNED[KP] == pytest.approx(kept, abs=0.01)


def test_what_can_be_borne_is_softened_a_little_and_then_varied_like_what_passed() -> None:
    borne = TrialVerdict(0, ("restless",), True, False, 1.05, 0.2, 0.25, True, True)
    search = after_trial(borne)
    for number in range(MOST_SOFTER):
        row = proposal(search)
        assert row[KP] > 0.7 * search.tried[-1].row[KP]
        search.add(row, verdict(0.8, worse=True) if number else borne, f"trial-{number + 2}")
    row = proposal(search)
    better = min(search.tried[1:], key=lambda one: one.verdict.value).row
    assert np.count_nonzero(row != better) <= 2, "one step from the best that can be borne"


def test_a_joint_that_only_chatters_gets_less_damping_and_keeps_its_stiffness() -> None:
    search = after_trial(verdict(0.1, chatters=True))
    row = proposal(search)
    assert row[KD] < TUNED[KD]
    assert row[KP] == TUNED[KP]


def test_what_helped_is_tried_again() -> None:
    """An arm on which only more integral part helps, up to a point."""
    weak = TUNED.copy()
    weak[KI] = 65536
    search, row = begun(), weak
    for number in range(6):
        score = 0.9 - 0.1 * np.log(row[KI] / 65536)
        search.add(row, verdict(float(score)), f"trial-{number}")
        proposed = search.propose()
        if proposed is None:
            break
        row = proposed
    assert search.best.row[KI] > 100 * 65536


def test_a_step_that_follows_better_but_is_hardly_too_much_is_made_half_as_far() -> None:
    stiff = TUNED.copy()
    stiff[KI] = 300 * 65536  # no more integral part: the first step makes it stiffer
    search = begun()
    search.add(stiff, verdict(0.5), "trial-1")
    wider = proposal(search)
    search.add(wider, verdict(0.3, restless=True, excess=2.4), "trial-2")
    half = proposal(search)
    assert float(half[KP] / stiff[KP]) ** 2 == pytest.approx(wider[KP] / stiff[KP], rel=1e-3)
    assert float(half[KD] / stiff[KD]) ** 2 == pytest.approx(wider[KD] / stiff[KD], rel=1e-3)
    search.add(half, verdict(0.35, restless=True, excess=1.1), "trial-3")
    quarter = proposal(search)
    assert float(quarter[KP] / stiff[KP]) ** 4 == pytest.approx(wider[KP] / stiff[KP], rel=1e-3)
    search.add(quarter, verdict(0.4), "trial-4")
    following = proposal(search)
    assert following[KP] == quarter[KP], "the same step is not made again"


@pytest.mark.parametrize(("score", "excess"), [(0.6, 1.1), (0.3, 3.0)])
def test_a_step_that_follows_worse_or_is_far_too_much_is_not_halved(score: float, excess: float) -> None:
    search = after_trial(verdict(0.5))
    wider = proposal(search)
    search.add(wider, verdict(score, restless=True, excess=excess), "trial-2")
    following = proposal(search)
    assert np.flatnonzero(following != TUNED).tolist() != np.flatnonzero(wider != TUNED).tolist()


def test_nothing_is_tried_twice_and_it_ends() -> None:
    search = run(lambda row: verdict(0.5), trials=100)
    assert len(search.tried) < 30
    assert len({one.row.tobytes() for one in search.tried}) == len(search.tried)
    assert search.propose() is None


def test_where_nothing_passes_the_controller_from_before_is_the_best() -> None:
    search = run(lambda row: verdict(2.0, restless=True, worse=True))
    assert np.array_equal(search.best.row, BEFORE)


def test_a_joint_that_follows_worse_is_varied_from_the_better_of_the_two() -> None:
    search = after_trial(verdict(1.5, worse=True))
    row = proposal(search)
    sets = [place for place, name in enumerate(CONTROLLER_COLUMNS) if name not in ("kp", "kd", "ki")]
    assert np.array_equal(row[sets], BEFORE[sets])


def test_a_joint_without_a_score_is_never_the_better_one() -> None:
    """It failed in the first part, and another joint then ended the trial."""
    search = after_trial(verdict(float("nan"), worse=True))
    assert search.propose() is not None
    assert search.best.trial == "before"


def test_every_proposal_is_one_that_the_firmware_takes() -> None:
    extreme = TUNED.copy()
    extreme[[KP, KD, KI]] = 2**20, 1, 1
    for start in (TUNED, extreme):
        for restless in (True, False):
            search = begun()
            search.add(start, verdict(0.2, restless=restless), "trial-1")
            for number in range(12):
                row = search.propose()
                if row is None:
                    break
                check_controllers(np.tile(row, (4, 1)))
                search.add(row, verdict(0.2, restless=restless), f"trial-{number + 2}")


def test_a_step_that_promises_nothing_is_left_out() -> None:
    search = after_trial(verdict(0.5))
    first = search.propose()
    other = after_trial(verdict(0.5))
    assert first is not None
    second = proposal(other, lambda row: not np.array_equal(row, first))
    assert not np.array_equal(second, first)
    assert other.propose(lambda row: False) is None
    restless = after_trial(verdict(0.5, restless=True))
    assert restless.propose(lambda row: False) is not None, "it gets softer whatever that promises"
