"""How long the arm takes for one step of 250 us, as the bench calls it."""

from __future__ import annotations

import timeit

import numpy as np

from greywhale.arm import Arm, Potentiometers
from greywhale.files.arm import default_arm
from tools.benchmarks.figure import Figure

CALLS = 20_000
REPEATS = 5
STEP_S = 250e-6


def run() -> list[Figure]:
    parameters = default_arm()
    arm = Arm(parameters)
    pots = Potentiometers(parameters.follower_pots)
    volts, out = np.array([4.0, 1.0, -2.0, 3.0]), np.zeros(4)

    def microseconds(call: object, inner: int = 1) -> float:
        best = min(timeit.repeat(call, number=CALLS // inner, repeat=REPEATS))  # type: ignore[arg-type]
        return best / CALLS * 1e6

    fresh = microseconds(lambda: arm.step(volts, STEP_S))
    reused = microseconds(lambda: arm.step(volts, STEP_S, out))
    inside = microseconds(lambda: arm.step(volts, 100 * STEP_S), inner=100)
    reading = microseconds(lambda: pots.millivolts(out, out))
    return [
        Figure("arm, one 250 us step from Python", fresh, "us", "<= 3 us", fresh <= 3),
        Figure("arm, one 250 us step into a given array", reused, "us", "<= 3 us", reused <= 3),
        Figure("arm, one 250 us step inside C++", inside, "us"),
        Figure("four potentiometers into a given array", reading, "us"),
    ]
