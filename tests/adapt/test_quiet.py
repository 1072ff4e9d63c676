"""Swings beyond those from before are named; a hand's tremor is none."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from greywhale.adapt.limits import ADAPTATION_LIMITS
from greywhale.adapt.quiet import Swings, find_excess
from greywhale.adapt.stretch import ROWS, Stretch

SUPPLY_V = 15.0
TIME_S = np.arange(ROWS * 8) * 1e-3


def record(shake_rad: float = 0.0, hz: float = 15.0, follows_tremor: bool = False, volts: float = 0.0) -> list[Stretch]:
    """Eight seconds at rest; joint 1 of the follower shakes, and of the voltage, at 200 Hz."""
    random = np.random.default_rng(1)
    tremor = 0.003 * np.sin(2 * np.pi * 9.0 * TIME_S)
    leader = np.tile(tremor[:, None], (1, 4))
    follower = leader * follows_tremor + random.normal(0.0, 3e-4, leader.shape)
    follower[:, 1] += shake_rad * np.sin(2 * np.pi * hz * TIME_S)
    voltage = np.zeros_like(leader)
    voltage[:, 1] = volts * np.sin(2 * np.pi * 200.0 * TIME_S)
    parts = (one.reshape(8, ROWS, 4) for one in (leader, follower, voltage))
    return [Stretch(float(k), k > 0, *rows) for k, rows in enumerate(zip(*parts, strict=True))]


def swings(stretches: list[Stretch]) -> Swings:
    found = Swings.of(stretches, SUPPLY_V)
    assert found is not None
    return found


CALM = swings(record())


@pytest.mark.parametrize(
    ("now", "what"),
    [
        (record(follows_tremor=True), ""),
        (record(shake_rad=0.0005), ""),
        (record(shake_rad=0.02, hz=8.0), "joint 1 has .* at rest"),
        (record(volts=0.5), ""),
        (record(volts=1.5), "joint 1 has .* of ripple"),
        (record(volts=14.0), "joint 1 has .* swings of the voltage a second"),
    ],
)
def test_what_is_beyond_its_limit_is_named(now: list[Stretch], what: str) -> None:
    clause = find_excess(swings(now), CALM, SUPPLY_V)
    assert re.fullmatch(f"({what}.*)?" if what else "", clause)
    assert bool(clause) == bool(what)


def test_what_was_there_before_is_allowed() -> None:
    loud = swings(record(volts=3.0))
    assert find_excess(loud, loud, SUPPLY_V) == ""


def test_a_short_record_tells_nothing() -> None:
    assert Swings.of(record()[: ADAPTATION_LIMITS.samples.least_swing_record_s - 1], SUPPLY_V) is None
    parted = [replace(one, joined=False) for one in record()]
    assert Swings.of(parted, SUPPLY_V) is None
