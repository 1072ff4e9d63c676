"""One joint of one arm turned by hand to both ends, the positive one first: what its potentiometer shows, and mistakes.

Counts are those of the 10-bit converter, a row a millisecond, columns leader 0..3 and follower 0..3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy  # loads a part of itself when it is first used

from greywhale.base.types import Floats
from greywhale.board.pots import FULL_SCALE, POTS
from greywhale.board.refusal import pot_name, upper_first

SMOOTH_TICKS = 9  # a reading that differs from its neighbours for less time is a jump
LEAST_COUNTS = 40.0  # 12 degrees of a usual track: less is no sweep
OTHERS_SHARE = 0.5  # of the sweep: another reading that moves as far is moved as well
RAIL_COUNTS = 4.0  # from the end of the converter's range
CROSSED_FROM_COUNTS, CROSSED_SPAN_COUNTS = (
    0.88 * FULL_SCALE,
    0.12 * FULL_SCALE,
)  # a pull-down of some ten times the track
DEAD_ZONE_COUNTS = 300.0  # a jump so far, from near one end to near the other, crosses the gap of the track
JUMP_COUNTS, MOST_JUMPS = 15.0, 2


@dataclass(frozen=True)
class Sweep:
    """A sweep of potentiometer `pot`: how its reading goes with the joint, its ends, and what is wrong."""

    pot: int
    direction: int  # 1 where the reading grows towards the positive end
    low: float  # counts
    high: float
    mistakes: tuple[str, ...]


def judge_sweep(counts: Floats, pot: int) -> Sweep:
    """Judge counts (rows, 8) from a sweep of `pot`; each mistake is a sentence with its remedy."""
    smooth = scipy.ndimage.median_filter(counts, size=(SMOOTH_TICKS, 1), mode="nearest")
    own, name = smooth[:, pot], upper_first(pot_name(pot))
    low, high = float(own.min()), float(own.max())
    direction = 1 if int(np.argmax(own)) < int(np.argmin(own)) else -1
    mistakes = _wiring(smooth, pot)
    if not mistakes:
        mistakes = _contact(counts[:, pot], own, name)
    return Sweep(pot, direction, low, high, tuple(mistakes))


def _wiring(smooth: Floats, pot: int) -> list[str]:
    """A sentence for the mistake if another potentiometer moved, or this one did not; none if it moved alone."""
    spans = np.ptp(smooth, axis=0)
    name, span = upper_first(pot_name(pot)), float(spans[pot])
    others = [other for other in range(len(POTS)) if other != pot and spans[other] >= LEAST_COUNTS]
    if span >= LEAST_COUNTS:
        also = [other for other in others if spans[other] > OTHERS_SHARE * span]
        across = [other for other in also if _jumps_across(smooth[:, other])]
        if across:  # it stands at an end of its track, and noise alone makes it jump
            return [_dead_zone(upper_first(pot_name(across[0])))]
        if also:
            return [
                f"{name} moved, and so did {pot_name(also[0])}: turn one joint at a time, or if only one was turned, "
                "look for a wire that touches both."
            ]
        return []
    reading = _reading(smooth[:, pot])
    if not others and _is_crossed(smooth[:, pot]):
        return [_crossed(name, reading)]
    if others:
        moved = max(others, key=lambda other: float(spans[other]))
        swapped = "the two arms are swapped" if moved % 4 == pot % 4 else "their wires are swapped"
        return [
            f"{name} reads {reading} and did not move, but {pot_name(moved)} did: {swapped}, or the other joint was "
            "turned; exchange the wires at the board's pins, or do it again."
        ]
    if smooth[:, pot].max() <= RAIL_COUNTS or smooth[:, pot].min() >= FULL_SCALE - RAIL_COUNTS:
        return [
            f"{name} reads {reading}, at a rail: check its wiper and its 5V wire (an open wire or a short to ground "
            "reads 0), or its ground wire (1023)."
        ]
    return [
        f"{name} reads {reading} and did not move: check that its shaft turns with the joint (a slipping coupling, a "
        "loose screw) and that its wiper's wire is connected."
    ]


def _contact(raw: Floats, own: Floats, name: str) -> list[str]:
    """A sentence for the mistake if the track ends or breaks where the joint goes, or its contact is bad; else none."""
    if _is_crossed(own):
        return [_crossed(name, _reading(own))]
    if _jumps_across(own):
        return [_dead_zone(name)]
    if own.min() <= RAIL_COUNTS or own.max() >= FULL_SCALE - RAIL_COUNTS:
        return [
            f"{name} reaches an end of its track ({_reading(own)}) within the joint's range: turn its "
            "shaft in its coupling so that mid-range reads about 512, and begin anew."
        ]
    away = np.abs(raw - own) > JUMP_COUNTS
    jumps = int(np.count_nonzero(np.diff(away.astype(np.int8)) == 1))
    if jumps > MOST_JUMPS:
        return [
            f"{name} jumped {jumps} times while the joint was turned: a loose wire, or a worn track; check its three "
            "wires, else replace it."
        ]
    return []


def _jumps_across(own: Floats) -> bool:
    return float(np.abs(own[8:] - own[:-8]).max(initial=0.0)) > DEAD_ZONE_COUNTS


def _dead_zone(name: str) -> str:
    return (
        f"{name} jumps from one end of its track to the other within the joint's range: its dead zone lies there; "
        "turn its shaft by half a turn in its coupling and begin anew."
    )


def _is_crossed(own: Floats) -> bool:
    """True if it stays near 5 V but is at no rail: a pull-down makes that of an end of the track on the pin."""
    low, high = float(own.min()), float(own.max())
    return (
        low > CROSSED_FROM_COUNTS and high < FULL_SCALE - RAIL_COUNTS and RAIL_COUNTS < high - low < CROSSED_SPAN_COUNTS
    )


def _crossed(name: str, reading: str) -> str:
    return (
        f"{name} reads {reading} and hardly changes near 5 V: its wiper's wire and an end's are exchanged; the wiper "
        "is mostly the middle one of the three. Change them: near an end of the track this shorts 5 V to ground."
    )


def _reading(counts: Floats) -> str:
    return f"{round(float(counts.min()))} to {round(float(counts.max()))} of {FULL_SCALE}"
