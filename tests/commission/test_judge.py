"""A joint is judged against what it did before: each fault has its own sentence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greywhale.commission.judge import Limits, TrialVerdict, judge
from greywhale.commission.measures import Measures
from greywhale.commission.motions import PARTS

SHAPE = (len(PARTS), 4)
KEPT = np.zeros(4, dtype=bool)
BEFORE = Measures(
    error=np.full(SHAPE, 1e-3),
    unrest=np.full(SHAPE, 0.001),
    rattle=np.full(SHAPE, 0.0012),
    chatter=np.full(SHAPE, 3.0),
    ripple=np.full(SHAPE, 0.2),
    voltage=np.full(SHAPE, 1.0),
    overshoot=np.full(SHAPE, 5.0),
    settling=np.full(SHAPE, 0.3),
)
QUIET = ("", "", "", "")
QUIET_V = 0.45


def with_joint(name: str, joint: int, value: float, part: int = 1) -> Measures:
    values = getattr(BEFORE, name).copy()
    values[part, joint] = value
    return replace(BEFORE, **{name: values})


def verdict(measured: Measures, joint: int, kept: np.ndarray = KEPT, guilty: tuple[str, ...] = QUIET) -> TrialVerdict:
    return judge(measured, BEFORE, Limits.of(BEFORE, kept, QUIET_V), guilty)[joint]


def test_what_was_there_before_passes_with_a_score_of_one() -> None:
    for one in judge(BEFORE, BEFORE, Limits.of(BEFORE, KEPT, QUIET_V), QUIET):
        assert one.passed
        assert one.score == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("name", "passes", "fails", "says"),
    [
        ("unrest", 0.00149, 0.00151, "hunts at rest"),
        ("rattle", 0.0029, 0.0031, "rattles"),
        ("chatter", 49.0, 51.0, "chatters"),
        ("ripple", 0.44, 0.46, "hisses at rest"),
        ("error", 1.05e-3, 1.06e-3, "moves worse than before"),
    ],
)
def test_each_fault_has_its_limit_and_its_sentence(name: str, passes: float, fails: float, says: str) -> None:
    assert verdict(with_joint(name, 2, passes), 2).passed
    failed = verdict(with_joint(name, 2, fails), 2)
    assert not failed.passed
    assert says in failed.faults[0]
    assert failed.restless == (name != "error")
    assert failed.hunts == (name == "unrest")
    assert verdict(with_joint(name, 2, fails), 1).passed, "the other joints are not blamed"
    assert (1.0 < failed.excess < 1.2) == (name != "error")


def test_a_joint_that_is_led_slowly_may_stick_and_slip() -> None:
    slow = PARTS.index("slow motion")
    assert verdict(with_joint("rattle", 2, 0.0049, slow), 2).passed
    assert not verdict(with_joint("rattle", 2, 0.0051, slow), 2).passed


def test_an_arm_that_was_restless_before_may_stay_as_it_was_but_no_more() -> None:
    restless = replace(BEFORE, unrest=np.full(SHAPE, 0.008))
    limits = Limits.of(restless, KEPT, QUIET_V)
    assert limits.unrest == pytest.approx(np.full(SHAPE, 0.008), rel=0.06)
    assert Limits.of(replace(BEFORE, ripple=np.full(SHAPE, 2.0)), KEPT, QUIET_V).ripple == pytest.approx(2.2)
    quiet = replace(BEFORE, unrest=np.full(SHAPE, 0.0002))
    holding = PARTS.index("holding still")
    seen = Limits.of(quiet, KEPT, QUIET_V).unrest
    assert np.delete(seen, holding, axis=0) == pytest.approx(0.0015), "nobody sees so little"
    assert seen[holding] == pytest.approx(0.003), "there its neighbours push it"


def test_an_arm_that_was_tuned_before_may_differ_by_what_recordings_do() -> None:
    """Two recordings with the same controllers differ by 4 % or 0.8 mrad rms; a tuned joint's error is 3 mrad."""
    reaches = PARTS.index("reaches")
    tuned, far = (replace(BEFORE, error=np.full(SHAPE, rad**2)) for rad in (0.003, 0.1))
    assert Limits.of(tuned, KEPT, QUIET_V).error[reaches] == pytest.approx(0.0038**2)
    assert Limits.of(far, KEPT, QUIET_V).error[reaches] == pytest.approx(1.04 * 0.1**2)


def test_a_joint_that_keeps_its_controller_may_feel_its_neighbours() -> None:
    """A tenth of its error, or two milliradians."""
    kept = np.array([False, False, False, True])
    seen = np.sqrt(1e-3) + 0.002
    assert not verdict(with_joint("error", 3, 1.09e-3), 3).passed
    assert verdict(with_joint("error", 3, (seen - 1e-4) ** 2), 3, kept).passed
    assert not verdict(with_joint("error", 3, (seen + 1e-4) ** 2), 3, kept).passed
    far = replace(BEFORE, error=np.full(SHAPE, 1e-2))
    assert Limits.of(far, kept, QUIET_V).error[1, 3] == pytest.approx(1.1e-2, rel=1e-3)


def test_a_joint_that_keeps_its_controller_may_rest_less_quietly() -> None:
    kept = np.array([False, False, False, True])
    restless = replace(BEFORE, unrest=np.tile([0.001, 0.002, 0.002, 0.002], (len(PARTS), 1)))
    limits = Limits.of(restless, kept, QUIET_V)
    noise, beyond = 0.001**2, 0.002**2 - 0.001**2
    assert limits.unrest[:-1, 2] == pytest.approx(np.sqrt(noise + 1.5**2 * beyond))
    assert limits.unrest[-1, 2] == pytest.approx(limits.unrest[-1, 3]), "as does one whose neighbours push it"
    assert limits.unrest[:, 3] == pytest.approx(np.sqrt(noise + 2.0**2 * beyond))


def test_a_joint_that_neighbours_push_while_it_holds_still_must_rest_after_its_own_moves() -> None:
    holding, moves = PARTS.index("holding still"), PARTS.index("moves")
    before = with_joint("unrest", 2, 0.0065, holding)
    limits = Limits.of(before, KEPT, QUIET_V)
    assert judge(before, before, limits, QUIET)[2].passed
    restless = before.unrest.copy()
    restless[moves, 2] = 0.0023
    hunts = judge(replace(before, unrest=restless), before, limits, QUIET)[2]
    assert hunts.faults == ("it hunts at rest (2.3 mrad rms, at most 1.5)",)
    assert hunts.excess == pytest.approx(2.3 / 1.5)


@pytest.mark.parametrize(
    ("name", "little", "much"),
    [
        ("unrest", 0.00172, 0.00173),
        ("rattle", 0.00344, 0.00346),
        ("chatter", 57.0, 58.0),
        ("ripple", 0.517, 0.518),
    ],
)
def test_only_one_kind_of_unrest_and_only_a_little_can_be_borne(name: str, little: float, much: float) -> None:
    assert verdict(BEFORE, 2).passes_at_a_price
    hardly = with_joint(name, 2, little)
    assert verdict(hardly, 2).passes_at_a_price
    assert not verdict(hardly, 2).passed
    assert 1.85 < verdict(hardly, 2).ranking_cost / verdict(hardly, 2).score < 2.0
    assert verdict(with_joint(name, 2, much), 2).ranking_cost == np.inf
    assert not verdict(with_joint(name, 2, much), 2).passes_at_a_price
    second = "chatter" if name != "chatter" else "unrest"
    both = replace(
        hardly, **{second: with_joint(second, 2, {"chatter": 51.0, "unrest": 0.00151}[second]).__dict__[second]}
    )
    assert not verdict(both, 2).passes_at_a_price, "two at once"
    error = BEFORE.error.copy()
    error[1, 2] = 1.1e-3
    assert not verdict(replace(hardly, error=error), 2).passes_at_a_price, "it follows worse too"
    error[1:] = np.nan
    assert not verdict(replace(hardly, error=error), 2).passes_at_a_price, "it was not seen to the end"


def test_a_joint_that_ended_the_trial_failed_and_the_others_are_not_judged() -> None:
    error = BEFORE.error.copy()
    error[1:] = np.nan
    stopped = replace(BEFORE, error=error)
    guilty = ("", "joint 1 hunted", "", "")
    assert verdict(stopped, 1, guilty=guilty).faults == ("joint 1 hunted",)
    assert verdict(stopped, 1, guilty=guilty).hunts
    other = verdict(stopped, 0, guilty=guilty)
    assert not other.known
    assert not other.passed
    assert np.isnan(other.score)


def test_the_score_is_the_error_in_what_a_hand_leads_relative_to_before() -> None:
    better = replace(BEFORE, error=BEFORE.error * np.array([0.5, 0.5, 0.1, 0.3, 0.5])[:, None])
    assert verdict(better, 0).score == pytest.approx(0.2)
    assert verdict(better, 0).share == pytest.approx(0.25)


@pytest.mark.parametrize(("name", "unseen"), [("small moves", 0.002), ("holding still", 0.006)])
def test_a_joint_that_hardly_moves_may_stay_where_friction_leaves_it(name: str, unseen: float) -> None:
    part = PARTS.index(name)
    seen = np.sqrt(BEFORE.error[part, 2]) + unseen
    assert verdict(with_joint("error", 2, (seen - 1e-4) ** 2, part), 2).passed
    assert name in verdict(with_joint("error", 2, (seen + 1e-4) ** 2, part), 2).faults[0]
