"""Questions to the rules of a calibration, and what they answer as Python has them compiled."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from greywhale.board.calibrate.motors import pulse_table
from greywhale.board.calibrate.rules import ask
from greywhale.protocol.table import ParameterTable
from tests.board.calibrate.test_sweep import MISTAKES, swept

Question = tuple[str, *tuple[Any, ...]]  # a rule, and its numbers as scalars and arrays
ALL = [1.0] * 4  # joints in use


def calibrations() -> dict[str, Any]:
    """Questions with their answers, and the set with which a motor gets its pulses."""
    told = []
    for rule, *given in (*sweeps(), *poses(), *motors(), ("pulse", 2, 2.5), ("turn_asked", 2), ("ready_asked",)):
        numbers, words = ask(rule, *given)
        flat = [float(number) for one in given for number in np.ravel(np.asarray(one))]
        told.append({"rule": rule, "given": flat, "numbers": numbers.tolist(), "words": words})
    assert {one["rule"] for one in told if one["words"]} >= {
        "sweep",
        "held",
        "solve",
        "slipped",
        "apart",
        "raw",
        "motor",
    }
    return {"asked": told, "pulse_set": pulse_table(ParameterTable.defaults(), 2, 2.5).raw}


def sweeps() -> Iterator[Question]:
    """Recordings of sweeps, right and with each mistake."""
    for pot, counts, _ in [(1, swept(1), ""), (6, swept(6, -250.0), ""), *MISTAKES]:
        yield "sweep", pot, counts


def poses() -> Iterator[Question]:
    """Of arms whose potentiometers are mounted anyhow, and of some that contradict themselves."""
    chance = np.random.default_rng(1)
    scale = np.radians(chance.uniform(260, 340, 8)) / 1023 * chance.choice([-1, 1], 8)
    zero, second = chance.uniform(400, 600, 8), chance.choice([-0.8, 0.8], 4)
    other = zero + np.tile(second, 2) / scale
    ends = np.sort(zero[:, None] + chance.uniform(1.0, 1.4, (8, 2)) * [-1, 1] / scale[:, None], axis=1)
    still = zero + chance.normal(0.0, 0.5, (500, 8))
    yield "counts", np.where(np.arange(8) == 2, 0, 5367), np.full(8, 8184), chance.integers(-9000, 9000, (3, 8))
    for way in (0.0, 9.0):
        yield "held", still + np.linspace(0.0, way, 500)[:, None]
    for pose in (second, second / 4, -second):
        yield "solve", ALL, np.sign(scale), ends.T, np.zeros(4), zero, pose, other
    yield "solve", ALL, np.sign(scale), ends.T, np.zeros(4), zero, 5.0
    yield "match", ALL, np.sign(scale), ends.T, zero, scale, np.zeros(4), zero, other
    for by in (7.0, 9.0):
        yield "slipped", zero, zero + by
    for by in (3.0, 90.0):
        yield "apart", ALL, zero, scale, other + by * np.eye(8)[5]
    for value, within in ((0.7, 0), (7.0, 0), (7.0, 1)):
        yield "raw", value, -25723, 25723, 1 / 4096, within


def motors() -> Iterator[Question]:
    """A motor that moves its joint, the other way, another joint, none; and remarks on four motors."""
    own, other = (0.3 * np.outer([1, -1, -1, 1], np.eye(4)[joint]) for joint in (0, 2))
    for moved in (own[:0], own[:1], own[:3], own, -own, other, 0 * own[:2], np.zeros((8, 4))):
        yield "motor", 0, 15.0, moved
    for supply in (9.0, 15.0):
        yield "remarks", supply, [[0, 2.0, 0.3], [1, 2.0, 0.05], [2, 5.0, 0.1], [3, 2.0, 0.25]]
