"""False readings that a potentiometer may give; each is injected at a joint of the arm on a board."""

from __future__ import annotations

from collections.abc import Callable

from greywhale.base.types import Floats
from greywhale.files.arm import default_arm
from tools.attack.arm_on_board import ArmOnBoard

NOISE_MV = 2.4
_POTS = default_arm().leader_pots  # the follower's are the same
MIDDLE_MV = 500.0 * _POTS.supply
MV_PER_RAD = 1000.0 * _POTS.supply / _POTS.joint[0].track

Inject = Callable[[ArmOnBoard, int], None]  # does it to a joint of the arm


def at_rail(millivolts: float, follower: bool, pattern: tuple[int, int] | None = None) -> Inject:
    """A pot at a rail, all the time or so many ms of so many."""

    def inject(arm: ArmOnBoard, joint: int) -> None:
        pot = joint + 4 * follower

        def fault(volts: Floats, since: float) -> None:
            if pattern is None or since * 1000 % pattern[1] < pattern[0] - 1e-9:
                volts[pot] = millivolts

        arm.pot_fault = fault

    return inject


def show(reading: Callable[[ArmOnBoard, float, float, float], float]) -> Inject:
    """The follower's potentiometer shows another voltage (mV) than it should: by the arm, what it should, what it
    should have when this began, and the time since then (s).
    """

    def inject(arm: ArmOnBoard, joint: int) -> None:
        begun: list[float] = []

        def fault(volts: Floats, since: float) -> None:
            right = float(volts[4 + joint])
            if not begun:
                begun.append(right)
            volts[4 + joint] = reading(arm, right, begun[0], since)

        arm.pot_fault = fault

    return inject


# The wiper slips on its shaft: it stays where it is, with the noise of any reading.
freeze = show(lambda arm, right, begun, since: begun + arm.random.normal(0.0, NOISE_MV))
# It turns the other way about the place where it is now.
reverse = show(lambda arm, right, begun, since: 2 * begun - right)


def read_neighbour(arm: ArmOnBoard, joint: int) -> None:
    other = 4 + (joint + int(arm.random.integers(1, 4))) % 4

    def fault(volts: Floats, since: float) -> None:
        volts[4 + joint] = volts[other]

    arm.pot_fault = fault
    arm.board.set_joined(1 << 4 + joint | 1 << other, 1)


def touch_neighbour(arm: ArmOnBoard, joint: int) -> None:
    """The wires of two wipers touch: both inputs read the mean, as with two equal potentiometers near their middle."""
    both = [4 + joint, 4 + (joint + int(arm.random.integers(1, 4))) % 4]

    def fault(volts: Floats, since: float) -> None:
        volts[both] = volts[both].mean()

    arm.pot_fault = fault
    arm.board.set_joined(1 << both[0] | 1 << both[1], 2)


def leave_floating(follower: bool) -> Inject:
    """The wiper's wire is off, and nothing pulls the pin down."""

    def inject(arm: ArmOnBoard, joint: int) -> None:
        arm.board.set_floating(1 << (joint + 4 * follower))

    return inject


def _away(volts: Floats, pot: int) -> float:
    """The sign of a lie that has room on the track."""
    return -1.0 if volts[pot] > MIDDLE_MV else 1.0


def shift(pots: Callable[[int], list[int]], way_rad: Callable[[float], float]) -> Inject:
    """Readings of some pots of a joint that are wrong by a way (rad) of the time since (s), to where there is room."""

    def inject(arm: ArmOnBoard, joint: int) -> None:
        signs: dict[int, float] = {}

        def fault(volts: Floats, since: float) -> None:
            for pot in pots(joint):
                sign = signs.setdefault(pot, _away(volts, pot))
                volts[pot] += sign * MV_PER_RAD * way_rad(since)

        arm.pot_fault = fault

    return inject


def leader(joint: int) -> list[int]:
    return [joint]


def two_leaders(joint: int) -> list[int]:
    return [joint, (joint + 1) % 4]


def jump(way_rad: float, takes_s: float = 0.0) -> Callable[[float], float]:
    """At once, or evenly within a time."""
    return lambda since: way_rad * (min(1.0, since / takes_s) if takes_s else 1.0)


def to_and_fro(way_rad: float, stays_s: float) -> Callable[[float], float]:
    return lambda since: way_rad * (1 - int(since / stays_s) % 2)


def leave_range(arm: ArmOnBoard, joint: int) -> None:
    """The leader jumps to the end of its track: not to a rail, but beyond the joint's limits."""

    def fault(volts: Floats, since: float) -> None:
        volts[joint] = MIDDLE_MV + _away(volts, joint) * 0.98 * MIDDLE_MV

    arm.pot_fault = fault
