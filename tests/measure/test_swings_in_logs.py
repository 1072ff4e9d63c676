"""Hunting: what counts as it, its size and frequency, and what is said of a model that does not predict it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greywhale.base.types import Floats
from greywhale.identify.judge import CHANGED, FIT, Following, LogVerdict, doubts_of
from greywhale.measure.swings_in_logs import FIT_IT, PROVE, Swings, describe_difference, swings_of

ROW_S = 5e-3
TIME = np.arange(0.0, 20.0, ROW_S)
REST = Swings((1e-3,) * 4, (0.0,) * 4, (False,) * 4)


def moves() -> Floats:
    """A leader that rests two seconds, moves one, and so on; the same for all joints."""
    phase = np.mod(TIME, 6.0)
    where = np.interp(phase, [0.0, 2.0, 3.0, 5.0, 6.0], [0.0, 0.0, 0.6, 0.6, 0.0])
    return np.tile(where[:, None], (1, 4))


def with_noise(angles: Floats) -> Floats:
    found: Floats = angles + 1e-3 * np.random.default_rng(1).standard_normal(angles.shape)
    return found


def test_swing_is_found_with_its_size_and_frequency_also_beside_a_moving_leader() -> None:
    leader = moves()
    follower = with_noise(leader)
    follower[:, 1] += 0.02 * np.sin(2 * np.pi * 7.0 * TIME)
    follower[:, 2] += 0.004 * np.sin(2 * np.pi * 7.0 * TIME)
    found = swings_of(follower, leader, ROW_S)
    assert found.hunts == (False, True, False, False)
    assert found.rms[1] == pytest.approx(
        0.02 / np.sqrt(2), rel=0.25
    )  # the average of 0.2 s does not take off a swing of 7 Hz exactly
    assert found.frequency[1] == pytest.approx(7.0, rel=0.1)
    assert found.rms[0] < 2e-3


@pytest.mark.parametrize("lag_s", [0.02, 0.1])
def test_lag_and_jumps_of_the_leader_are_no_hunting(lag_s: float) -> None:
    leader = moves()
    leader[TIME > 8.0] += 0.5
    late = np.vstack([np.tile(leader[:1], (round(lag_s / ROW_S), 1)), leader])[: len(leader)]
    assert swings_of(with_noise(late), leader, ROW_S).hunts == (False,) * 4


def test_one_kick_is_no_hunting() -> None:
    leader = np.zeros((len(TIME), 4))
    follower = with_noise(leader)
    follower[1000:1040] += 0.05
    assert swings_of(follower, leader, ROW_S).hunts == (False,) * 4


def test_sentences_name_the_joint_and_what_may_be_missing() -> None:
    hunts = Swings((1e-3, 1e-3, 0.018, 1e-3), (0.0, 0.0, 7.0, 0.0), (False, False, True, False))
    small = Swings((1e-3, 1e-3, 0.006, 1e-3), (0.0, 0.0, 7.0, 0.0), (False, False, True, False))
    missed = describe_difference("log3.csv", hunts, REST, (0, 1, 2, 3))
    assert len(missed) == 1
    assert missed[0].startswith("log3.csv: joint 2 (wrist pitch) hunts by 18.0 mrad rms at 7.0 Hz, but the model rests")
    assert "play" in missed[0]
    assert "the model hunts" in describe_difference("log3.csv", REST, hunts, (2,))[0]
    assert "but the model by 6.0 mrad" in describe_difference("log3.csv", hunts, small, (2,))[0]
    for log, model in ((hunts, REST), (REST, hunts), (hunts, small)):
        (unseen,), (fitted,) = (describe_difference("log3.csv", log, model, (2,), fitted=one) for one in (False, True))
        assert FIT_IT in unseen
        assert fitted.endswith(f": {PROVE}."), "to fit a log that is fitted leads in a circle"
    assert describe_difference("log3.csv", hunts, hunts, (0, 1, 2, 3)) == []
    near = replace(small, rms=(1e-3, 1e-3, 0.010, 1e-3), hunts=(False,) * 4)
    assert describe_difference("log3.csv", hunts, near, (2,)) == [], "it just does not hunt"
    assert describe_difference("log3.csv", near, hunts, (2,)) == []
    assert describe_difference("log3.csv", hunts, REST, (0, 1, 3)) == []


def verdict(role: str, left: float) -> LogVerdict:
    errors = (1e-4,) * 4
    following = Following((1e-3,) * 4, (left, 1e-8, 1e-8, 1e-8), errors, REST, REST)
    return LogVerdict("log.csv", role, "closed loop", (1e-3,) * 4, (1e-8,) * 4, following)


def test_model_that_fails_with_a_changed_controller_only_is_doubted() -> None:
    own, good, bad = verdict(FIT, 2e-6), verdict(CHANGED, 4e-6), verdict(CHANGED, 8e-5)
    assert doubts_of([own, good], range(4)) == ()
    sentences = doubts_of([own, bad], range(4))
    assert len(sentences) == 1
    assert (
        "joint 0 (base yaw) follows otherwise than the model by 9 mrad rms, 80 % of its tracking error" in sentences[0]
    )
    assert doubts_of([own, bad], (1, 2, 3)) == ()
