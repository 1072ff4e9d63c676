"""A person at work with an arm that changes, simulated in a moment by the native loop, stretch by stretch.

Every piece of work begins and ends at a rest of the leader, which is where sets and arms change: the controllers begin
anew there, and at no other place.
"""

from __future__ import annotations

import numpy as np

from greywhale.adapt.decide import Adaptation
from greywhale.adapt.stretch import ROWS, Stretch
from greywhale.arm import ArmParameters
from greywhale.arm.parameters import USUAL_TRACK_RAD, with_usual_noise
from greywhale.arm.plants import plant_row
from greywhale.base.types import Floats
from greywhale.files.arm import default_arm
from greywhale.loop import human_reaches
from greywhale.loop.closed_loop import ClosedLoop, known_readings
from greywhale.loop.controllers import controllers_of
from greywhale.protocol.firmware import ANGLE_LSB, JOINTS, TICK_S, pwm_steps
from greywhale.protocol.table import ParameterTable

PIECE_S = 6  # of work, then a rest
REST_S = 1
READING_RAD = 7e-4  # noise of a reading


class Work:
    """`arm` may be another one from piece to piece."""

    def __init__(self, arm: ArmParameters, seed: int = 1) -> None:
        self.arm = arm
        self.time_s = 0.0
        self._seed = seed
        self._joined = False
        self._stands: Floats | None = None  # where the follower was when the last run began, rad
        self._run: list[Floats] = []  # the leader since then, piece by piece
        self._runs_with: tuple[ParameterTable, ArmParameters] | None = None
        self._last: Floats | None = None  # where the follower is, rad

    def cut(self) -> None:
        """The set changed: what comes is not joined to what was."""
        self._joined = False

    def piece(self, table: ParameterTable) -> list[Stretch]:
        """The next seconds of work with a set: one stretch each."""
        self._seed += 1
        if self._runs_with != (table, self.arm):
            self._runs_with, self._run, self._stands = (table, self.arm), [], self._last
        self._run.append(self._leader())
        rows = len(self._run[-1])
        parts = [part[-rows:] for part in self.follow(table, np.concatenate(self._run))]
        self._last = parts[1][-1]
        made = [
            Stretch(self.time_s + number, self._joined or number > 0, *(one[number * ROWS :][:ROWS] for one in parts))
            for number in range(rows // ROWS)
        ]
        self.time_s += len(made)
        self._joined = True
        return made

    def _leader(self) -> Floats:
        path = human_reaches(self._seed, float(PIECE_S))
        time_s = np.arange((PIECE_S + REST_S) * ROWS, dtype=np.float64) * TICK_S - 0.5 * REST_S
        middle = path.angles[0]
        angles = path.at(time_s)
        late = np.clip((time_s - path.time_s[-1]) / 0.4, 0.0, 1.0)[:, None]  # back to the middle
        share: Floats = late**3 * (10.0 - late * (15.0 - 6.0 * late))
        found: Floats = angles + share * (middle - angles)
        return found

    def follow(self, table: ParameterTable, leader: Floats, seed: int = 1) -> tuple[Floats, Floats, Floats]:
        """Leader, follower (rad) and voltage (V) as the board tells them, (rows, 4) each."""
        arm = with_usual_noise(self.arm)
        loop = ClosedLoop(
            table,
            known_readings(leader),
            arm.follower_pots,
            seed=seed,
            home=(leader[0] if self._stands is None else self._stands).tolist(),
            gap=[0.0] * JOINTS,
            weight_s=np.zeros(len(leader)),
        )
        result = loop.run(controllers_of(table)[None], plant_row(arm)[None], substeps=2, every=1)
        volts = result.duties[0] / np.array(pwm_steps(table.board)) * table.supply_v
        tracks = np.array([pot.track for pot in arm.follower_pots.joint])  # the board takes each for a usual one
        read = result.angles[0] * USUAL_TRACK_RAD / tracks + np.random.default_rng(seed).normal(
            0.0, READING_RAD, leader.shape
        )
        return np.round(leader / ANGLE_LSB) * ANGLE_LSB, np.round(read / ANGLE_LSB) * ANGLE_LSB, volts


def with_gain(joint: int, gain: float) -> ArmParameters:
    """A follower's potentiometer turns so much of the joint's way."""
    arm = default_arm()
    pots = list(arm.follower_pots.joint)
    pots[joint] = pots[joint].model_copy(update={"track": pots[joint].track / gain})
    return arm.model_copy(update={"follower_pots": arm.follower_pots.model_copy(update={"joint": tuple(pots)})})


def work_for(adaptation: Adaptation, work: Work, pieces: int) -> None:
    """Let a person work for so many pieces; what is wished for comes after each. Fits during a trial find the model as
    it was.
    """
    for _ in range(pieces):
        for stretch in work.piece(adaptation.running):
            adaptation.take(stretch)
            task = adaptation.task() if adaptation.on_trial else None
            if task is not None:
                assert task.budget == 0
                adaptation.answer(task.live)
        if adaptation.wish is not None:
            adaptation.changed()
            work.cut()
