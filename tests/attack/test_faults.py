"""Sensors that lie, motors that do not obey, hangs, lost lines, on the real images with an arm: motors off in time."""

from __future__ import annotations

import pytest

from tools.attack.arm_faults import CHATTER, faults, leader_jumps
from tools.attack.part import add_up
from tools.attack.parts.faults import run

RAILS = {"open": "pot_low", "shorted": "pot_high"}
# What the board may say of each; a joint that nobody moves shows nothing.
REPORTED = {
    "stop request": {"none"},
    "emergency stop pressed": {"estop"},
    "lease of 20 ms runs out": {"none"},
    "flood of 80 bytes a ms": {"flood"},
    "hang, interrupts on": {"watchdog"},
    "hang, interrupts off": {"watchdog"},
    "bit of the running set flips": {"memory", "estop"},
    "supply sinks by 0.1 V a ms": {"none"},
    "leader floats": {"pot_low", "leader_jump"},
    "follower floats": {"pot_low", "speed"},
    "motor dead": {"tracking", "runaway", "motors stayed on"},
    "motor reversed": {"runaway", "motors stayed on"},
    "follower pot reversed": {"runaway", "speed", "motors stayed on"},
    "joint blocked": {"tracking", "motors stayed on"},
} | {
    f"{side} {state}" + (f" {pattern[0]} of {pattern[1]} ms" if pattern else ""): {code}
    for side in ("leader", "follower")
    for state, code in RAILS.items()
    for pattern in (None, *CHATTER)
}
REPORTED |= {name: {"leader_jump"} for name in leader_jumps()}


@pytest.mark.slow
@pytest.mark.parametrize(("board", "seed"), [("mega", 2), ("nano", 3)])
def test_every_fault_turns_the_motors_off_in_time_and_is_named(board: str, seed: int) -> None:
    rows = add_up(run({"board": board, "seed": seed, "trials": 1, "faults": list(REPORTED)}))
    assert [row.tried for row in rows] == [f"{board}: {name}" for name in faults() if name in REPORTED]
    for row in rows:
        assert row.violations == 0, row
        assert set(row.counts) <= REPORTED[row.tried.partition(": ")[2]], row


@pytest.mark.slow
def test_a_follower_that_reads_its_neighbour_is_told_at_once_where_the_two_differ() -> None:
    """If the two read alike, it is a frozen pot: docs/firmware.md says what that costs."""
    row = run({"board": "nano", "seed": 2, "trials": 4, "faults": ["follower reads neighbour"]})
    found = add_up(row)[0]
    assert set(found.counts) <= {"speed", "runaway", "tracking", "motors stayed on"}
    assert found.counts["speed"] >= 2


@pytest.mark.slow
def test_each_fault_of_motion_is_found_when_the_joint_moves() -> None:
    names = ["motor reversed", "follower pot reversed"]
    for row in add_up(run({"board": "nano", "seed": 0, "trials": 4, "faults": names})):
        assert row.counts["runaway"] >= 2, row


@pytest.mark.slow
def test_what_tune_knows_of_the_arm_has_a_row_of_its_own() -> None:
    rows = [run({"board": "mega", "seed": seed, "trials": 1, "faults": ["follower frozen"]})[0] for seed in (4, 5)]
    assert [row.tried.partition(", ")[2] for row in rows] == ["travel unknown", "travel known"]
