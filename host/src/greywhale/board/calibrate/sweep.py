"""One joint of one arm turned by hand to both ends, the positive one first: what its potentiometer shows, and mistakes.

Counts are those of the 10-bit converter, a row a millisecond, columns leader 0..3 and follower 0..3.
"""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.base.types import Floats
from greywhale.board.calibrate.rules import ask


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
    (direction, low, high), mistake = ask("sweep", pot, counts)
    return Sweep(pot, int(direction), float(low), float(high), (mistake,) if mistake else ())
