"""A hand that leans on a joint of the arm on a board like a spring, and lets go; with untuned and tuned controllers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np

from greywhale.arm.plants import plant_row
from greywhale.base.types import Floats
from greywhale.files import controller
from greywhale.files.arm import default_arm
from greywhale.files.paper_tables import paper_table
from greywhale.protocol.table import ParameterTable
from greywhale.tune import tune
from greywhale.tune.model import Model
from tools.attack.arm_faults import tuned_travel
from tools.attack.arm_on_board import SLICE_S, ArmOnBoard

UNTUNED, TUNED = "untuned", "tuned"
ROLL = 3  # carries little, so a hand that holds it is softer, too
SOFT_START_MS = 100
LEANS_WITHIN_S = 0.5
SPEED_SLICES = 16  # over which a speed is taken, 4 ms


@dataclass(frozen=True)
class Hand:
    """A hand at a joint: where it wants the joint to be (rad, from where that stands), and how it holds it."""

    joint: int
    way: float
    stiffness: float  # N m/rad
    damping: float  # N m s/rad


def hands(joint: int) -> list[Hand]:
    """From a soft hand to one like a vice, without damping and with some, to both sides."""
    stiffness, damping = ((3.0, 10.0, 20.0), 0.1) if joint == ROLL else ((20.0, 60.0, 150.0, 400.0), 2.0)
    return [Hand(joint, *one) for one in product((0.3, -0.5), stiffness, (0.0, damping))]


@cache
def raw_set(name: str) -> dict[str, int]:
    """Raw values of the paper's controllers before tuning, or of those that the tuner finds for the default arm."""
    if name == UNTUNED:
        return {key: int(raw) for key, raw in controller.load(paper_table("before_tuning")).raw_values().items()}
    arm, table = default_arm(), ParameterTable.defaults()
    exact = Model("the default arm", arm, table, plant_row(arm)[None], (), "", "")
    return table.with_controllers(tune(exact, threads=1).after).changes() | tuned_travel()


class ArmAndHand(ArmOnBoard):
    """An arm that nobody leads, at a pose, and somebody's hand at it."""

    def __init__(self, board: str, name: str, pose: Floats, seed: int) -> None:
        super().__init__(board, lambda seconds: pose, seed)
        self.run_set(raw_set(name) | {"soft_start_ms": SOFT_START_MS})
        self.start()
        self.wait(1000)

    def lean(self, hand: Hand, seconds: float) -> bool:
        """True while the motors stay on; the hand comes to its place within half a second."""
        begin = last = float(self.angles[hand.joint])
        for time_s in SLICE_S * np.arange(round(seconds / SLICE_S)):
            place = float(self.angles[hand.joint])
            wanted = begin + hand.way * min(1.0, time_s / LEANS_WITHIN_S)
            self._push(hand.joint, hand.stiffness * (wanted - place) - hand.damping * (place - last) / SLICE_S)
            last = place
            self.slice()
            if not self.motors_on:
                return False
        return True

    def let_go(self, joint: int, seconds: float) -> float:
        """The joint's greatest speed afterwards, rad/s."""
        self._push(joint, 0.0)
        fastest = 0.0
        for _ in range(round(seconds / SLICE_S / SPEED_SLICES)):
            before = self.angles[joint]
            for _ in range(SPEED_SLICES):
                self.slice()
            fastest = max(fastest, abs(float(self.angles[joint] - before)) / (SPEED_SLICES * SLICE_S))
        return fastest

    def _push(self, joint: int, torque_nm: float) -> None:
        self.arm.set_load(torque_nm * (np.arange(4) == joint))
