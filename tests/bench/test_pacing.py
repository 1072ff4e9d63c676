"""The rules of simulated against wall-clock time, with a clock that the test moves."""

from __future__ import annotations

import pytest

from greywhale_sim.pacing import GIVE_UP_S, Pacer, wants_real_time


class Clock:
    """Wall time; waiting is the only thing that moves it, besides the test."""

    def __init__(self) -> None:
        self.now = 100.0
        self.waits: list[float] = []

    def __call__(self) -> float:
        return self.now

    def wait(self, seconds: float) -> None:
        self.waits.append(seconds)
        self.now += seconds


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def pacer(clock: Clock) -> Pacer:
    return Pacer(clock, clock.wait)


def test_real_time_waits_for_the_wall_clock(clock: Clock, pacer: Pacer) -> None:
    for millisecond in range(1001):
        pacer.pace(5.0 + millisecond / 1000, real_time=True)
        clock.now += 0.0001  # the work itself
    assert clock.now == pytest.approx(101.0001, abs=1e-6)
    assert pacer.lag_s == 0.0


def test_slow_motion_takes_as_much_longer(clock: Clock, pacer: Pacer) -> None:
    pacer.pace(0.0, real_time=True)
    pacer.pace(0.010, real_time=True)
    pacer.rate = 0.1
    pacer.pace(0.010, real_time=True)
    pacer.pace(0.020, real_time=True)
    pacer.rate = 1.0
    pacer.pace(0.020, real_time=True)
    pacer.pace(0.030, real_time=True)
    assert sum(clock.waits) == pytest.approx(0.010 + 0.100 + 0.010)


def test_a_short_lag_is_made_up_for_a_long_one_is_counted(clock: Clock, pacer: Pacer) -> None:
    pacer.pace(0.0, real_time=True)
    clock.now += 0.8 * GIVE_UP_S
    pacer.pace(0.001, real_time=True)
    pacer.pace(GIVE_UP_S, real_time=True)
    assert clock.now == pytest.approx(100.0 + GIVE_UP_S)
    clock.now += 3.0
    pacer.pace(GIVE_UP_S, real_time=True)
    assert pacer.lag_s == pytest.approx(3.0)
    waited = len(clock.waits)
    pacer.pace(GIVE_UP_S + 0.001, real_time=True)
    assert clock.waits[waited:] == pytest.approx([0.001]), "no catching up after a long lag"


@pytest.mark.parametrize(
    ("fast", "connected", "in_bootloader", "host_baud", "silent_s", "expected"),
    [
        (False, True, False, 1e6, 0.0, True),  # speed 1 is real time, whatever happens
        (True, True, False, 1e6, 9.0, False),
        (True, False, False, 1e6, 0.0, True),  # nobody there: idle without burning the processor
        (True, True, True, 115200.0, 9.0, True),  # each waits for the other by the clock
        (True, True, True, 115200.0, 0.04, False),  # a page is on its way, or is being written
        (True, True, True, 1e6, 9.0, False),  # the bootloader times out unheard while our host waits
        (True, True, False, 115200.0, 9.0, False),  # a firmware at the bootloader's speed
    ],
)
def test_when_real_time_is_kept(
    fast: bool, connected: bool, in_bootloader: bool, host_baud: float, silent_s: float, expected: bool
) -> None:
    assert wants_real_time(fast, connected, in_bootloader, host_baud, 115200.0, silent_s) is expected
