"""Two calibrations beside each other, in words and units, joint by joint."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from greywhale.arm.parameters import JOINT_NAMES
from greywhale.board.pots import COUNT14_PER_COUNT, FULL_SCALE
from greywhale.protocol import schema
from greywhale.protocol.firmware import JOINTS

Values = Mapping[str, int]  # raw values by name


def differences(before: Values, after: Values) -> list[str]:
    """A sentence's part for each joint that differs, angles in degrees; none where the calibrations are equal."""
    return [
        f"joint {joint} ({JOINT_NAMES[joint]}): {', '.join(found)}"
        for joint in range(JOINTS)
        if (found := [*_pots(before, after, joint), *_joint(before, after, joint)])
    ]


def _pots(before: Values, after: Values, joint: int) -> Iterator[str]:
    for side in ("leader", "follower"):
        zero, scale = f"{side}{joint}.zero", f"{side}{joint}.scale"
        was, now = (COUNT14_PER_COUNT * FULL_SCALE * _physical(values, scale) for values in (before, after))
        if not was or not now:
            if was or now:
                yield f"the {side} is {'now' if now else 'no longer'} in use"
            continue
        if was * now < 0:
            yield f"the {side} reads the other way"
        if abs(was) != abs(now):
            yield f"the {side}'s track {math.degrees(abs(was)):.1f} to {math.degrees(abs(now)):.1f} degrees"
        if before[zero] != after[zero]:
            share = (after[zero] - before[zero]) / (COUNT14_PER_COUNT * FULL_SCALE)
            yield f"the {side}'s zero by {math.degrees(share * now):+.1f} degrees"


def _joint(before: Values, after: Values, joint: int) -> Iterator[str]:
    was, now = (_range(values, joint) for values in (before, after))
    if was != now:
        yield f"limits {was} to {now} degrees"
    sign = f"joint{joint}.motor_sign"
    if before[sign] != after[sign]:
        yield "the motor the other way round"


def _range(values: Values, joint: int) -> str:
    low, high = (_physical(values, f"joint{joint}.{end}") for end in ("limit_min", "limit_max"))
    return f"{math.degrees(low):.1f}..{math.degrees(high):.1f}"


def _physical(values: Values, name: str) -> float:
    return schema.PARAMETER_BY_NAME[name].to_physical(values[name])
