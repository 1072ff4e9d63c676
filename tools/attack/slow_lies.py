"""Lies of a potentiometer that begin slowly or as nobody would see, and two faults at once, each by name."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from greywhale.base.types import Floats
from tools.attack.arm_faults import block, reverse_motor
from tools.attack.arm_on_board import SLICE_S, ArmOnBoard, PotFault
from tools.attack.pot_lies import MIDDLE_MV, Inject, freeze, jump, leader, reverse, shift, show

ALIKE_MV = 5.0  # one count of the converter


def follower(joint: int) -> list[int]:
    return [4 + joint]


def drift(rad_per_s: float) -> Callable[[float], float]:
    return lambda since: rad_per_s * since


def lose_gain(gain: float, takes_s: float) -> Inject:
    """The follower's reading turns about the middle of its track by less and less."""

    def reading(arm: ArmOnBoard, right: float, begun: float, since: float) -> float:
        now = 1.0 - (1.0 - gain) * min(1.0, since / takes_s)
        return MIDDLE_MV + now * (right - MIDDLE_MV)

    return show(reading)


def turn_less(gain: float) -> Inject:
    """From where it is the follower's reading goes only a share of the joint's way."""
    return show(lambda arm, right, begun, since: begun + gain * (right - begun))


# The reading stays as it is, without any noise.
hold_still = show(lambda arm, right, begun, since: begun)


def come_late(seconds: float) -> Inject:
    def inject(arm: ArmOnBoard, joint: int) -> None:
        coming: deque[float] = deque(maxlen=round(seconds / SLICE_S))

        def fault(volts: Floats, since: float) -> None:
            coming.append(volts[4 + joint])
            volts[4 + joint] = coming[0]

        arm.pot_fault = fault

    return inject


def exchange(other: Callable[[int], int]) -> Inject:
    """Two plugs are exchanged, from the moment on at which both potentiometers read alike."""

    def inject(arm: ArmOnBoard, joint: int) -> None:
        pots, done = [4 + joint, other(joint)], [False]

        def fault(volts: Floats, since: float) -> None:
            done[0] |= abs(volts[pots[0]] - volts[pots[1]]) < ALIKE_MV
            if done[0]:
                volts[pots] = volts[pots[::-1]]

        arm.pot_fault = fault

    return inject


def both(*injects: tuple[Inject, int]) -> Inject:
    """Several faults at once, each at a joint so many after the one in question."""

    def inject(arm: ArmOnBoard, joint: int) -> None:
        faults: list[PotFault] = []
        for one, further in injects:
            arm.pot_fault = None
            one(arm, (joint + further) % 4)
            if arm.pot_fault is not None:
                faults.append(arm.pot_fault)

        def all_of_them(volts: Floats, since: float) -> None:
            for fault in faults:
                fault(volts, since)

        arm.pot_fault = all_of_them

    return inject


def slow_lies() -> dict[str, Inject]:
    """All of them by name."""
    found: dict[str, Inject] = {
        "nothing wrong, for comparison": lambda arm, joint: None,
        "held by a hand, for comparison": block,
    }
    found |= {f"follower drifts by {rate:g} rad/s": shift(follower, drift(rate)) for rate in (0.05, 0.2, 0.5, 1.0)}
    found |= {
        "follower's gain falls to 0.5 in 2 s": lose_gain(0.5, 2.0),
        "follower turns by a fifth from here on": turn_less(0.2),
        "follower late by 60 ms": come_late(0.060),
        "follower late by 150 ms": come_late(0.150),
        "follower creeps 1 rad at 3 rad/s": shift(follower, jump(1.0, 1.0 / 3.0)),
        "follower creeps 1 rad at 20 rad/s": shift(follower, jump(1.0, 1.0 / 20.0)),
        "follower exchanged with the next": exchange(lambda joint: 4 + (joint + 1) % 4),
        "follower exchanged with its leader": exchange(lambda joint: joint),
        "follower frozen without noise": hold_still,
        "leader drifts by 0.2 rad/s": shift(leader, drift(0.2)),
        "follower frozen, motor reversed": both((freeze, 0), (reverse_motor, 0)),
        "follower and motor reversed": both((reverse, 0), (reverse_motor, 0)),
        "follower frozen, and the next": both((freeze, 0), (freeze, 1)),
        "follower frozen, leader drifts by 0.2 rad/s": both((freeze, 0), (shift(leader, drift(0.2)), 0)),
    }
    return found
