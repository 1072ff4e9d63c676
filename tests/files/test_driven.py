"""Rows that show motors at work, and the words about a log or a joint that lacks its voltage."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from greywhale.files.log import Log
from greywhale.files.log.driven import driven_rows, following_rows, tell_off, tell_powerless, tell_undriven, undriven
from greywhale.files.log.layout import Origin
from greywhale.protocol.joints import ALL, Joints

RATE = 100  # rows a second


def log_of(
    states: Sequence[str],
    volts: float | Sequence[float] = 4.0,
    *,
    powered: slice = slice(None),
    joints: Joints = ALL,
    motion: float = 0.5,
) -> Log:
    """A second of each state, in which all joints move; `powered` seconds have voltages, the others 0 V."""
    time = np.arange(len(states) * RATE) / RATE
    angle = motion * np.sin(2.0 * time)[:, None] * np.isin(np.arange(4), joints)
    voltage = np.zeros_like(angle)
    rows = slice(*(None if end is None else end * RATE for end in (powered.start, powered.stop)))
    voltage[rows] = (np.asarray(volts) * np.cos(2.0 * time)[:, None] * np.isin(np.arange(4), joints))[rows]
    return Log("log", Origin(joints=joints), time, angle, angle.copy(), voltage, np.repeat(states, RATE), 0, True)


@pytest.mark.parametrize(
    ("states", "cause"),
    [
        (["disabled"] * 8, "motors were off in all 7.99 s (state disabled, 0 V)"),
        (["boot"] * 8, "(state boot, 0 V), so it does not show how voltages move the arm; record with"),
        (["fault"] * 8, "(state fault, 0 V), so it does not show how voltages move the arm; `greywhale info` names"),
        (["boot", "disabled", "fault"], "the motors were off in all 2.99 s (state boot and disabled and fault, 0 V)"),
        (["following"] * 8, "no motor's voltage changes in all 7.99 s (state following, 0 V)"),
        (
            ["disabled", "following"],
            "(state following, 0 V), so it does not show how voltages move the arm; check that",
        ),
    ],
)
@pytest.mark.parametrize("joints", [ALL, (0, 1)])
def test_a_log_without_any_voltage_is_told_with_its_states_and_a_remedy(
    states: list[str], cause: str, joints: Joints
) -> None:
    log = log_of(states, 0.0, joints=joints)
    assert cause in tell_off(log)
    assert tell_powerless(log) == [tell_off(log)]


@pytest.mark.parametrize("word", ["disabled", "following"])
def test_noise_or_a_voltage_that_never_changes_is_no_voltage(word: str) -> None:
    assert tell_off(log_of([word] * 5, 0.01))
    log = log_of([word] * 5)
    log.voltage[:] = 9.0
    assert "no motor's voltage changes" in tell_off(log)
    assert "9 V" in tell_off(log)


@pytest.mark.parametrize("word", ["disabled", "boot", "following"])
@pytest.mark.parametrize("volts", [0.1, 12.0, [4.0, 0.0, 0.0, 0.0]])
def test_a_log_with_voltages_is_not_off_whatever_its_states_say(word: str, volts: float | list[float]) -> None:
    """Another tool knows no states of the board."""
    log = log_of([word] * 5, volts)
    assert tell_off(log) == ""
    assert driven_rows(log).all()


@pytest.mark.parametrize("joint", range(4))
def test_a_joint_without_voltage_that_moved_or_was_led_is_named(joint: int) -> None:
    log = log_of(["following"] * 5, [0.0 if one == joint else 4.0 for one in range(4)])
    assert undriven(log, driven_rows(log)) == (joint,)
    assert list(tell_undriven(log, driven_rows(log))) == [joint]
    assert f"joint {joint} had 0 V in every row, while its leader moved by 1 rad" in tell_powerless(log)[0]
    log.follower[:, joint] = 0.0
    assert "its follower by 0 rad" in tell_powerless(log)[0]
    log.leader[:, joint] = 0.05
    assert tell_powerless(log) == [], "a joint that rests needs no voltage"


def test_an_unused_joint_needs_no_voltage() -> None:
    assert tell_powerless(log_of(["following"] * 5, joints=(0, 2))) == []


def test_of_a_log_without_states_only_what_is_near_a_voltage_counts() -> None:
    log = log_of(["disabled"] * 20, powered=slice(8, 12))
    rows = log.time[driven_rows(log)]
    assert rows[0] == pytest.approx(7.0, abs=0.1)
    assert rows[-1] == pytest.approx(13.0, abs=0.1)
    assert following_rows(log).all()


def test_where_motors_followed_their_rest_counts_too() -> None:
    log = log_of(["disabled", *["following"] * 9], powered=slice(1, 3))
    assert driven_rows(log).sum() == following_rows(log).sum() == 9 * RATE
