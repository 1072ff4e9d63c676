"""An arm on its board for trials, simulated in a moment by the native loop: it offers what a Rig offers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.parameters import with_usual_noise
from greywhale.arm.plants import plant_row
from greywhale.board.stream import Received
from greywhale.commission.motions import Room
from greywhale.commission.rig import Played
from greywhale.commission.watch import Hunting, Watch
from greywhale.errors import UserError
from greywhale.files.log import LogWriter, read_log
from greywhale.files.log.layout import Origin
from greywhale.firmware import ANGLE_LSB, JOINTS, TICK_S, pwm_steps
from greywhale.loop.closed_loop import ClosedLoop, known_readings
from greywhale.loop.controllers import controllers_of
from greywhale.protocol import schema
from greywhale.table import ParameterTable
from greywhale.trajectory import Trajectory

POSE = np.array([0.0, 0.4, 0.0, 0.0])
ROOM = Room(POSE, POSE - 0.9, POSE + 0.9)
WAIT = 300  # ticks at the first pose
EVERY = 4  # ticks from one row of a log to the next


class SimulatedRig:
    """Plays as a Rig does. `played` lists the tables of its motions in order; `stored` is what the board keeps."""

    def __init__(self, arm: ArmParameters, before: ParameterTable | None = None) -> None:
        self.arm = with_usual_noise(arm)
        self.before = before or ParameterTable.defaults()
        self.stored = self.before
        self.played: list[ParameterTable] = []
        self.at_play: Callable[[int], None] = lambda number: None
        self.report: Callable[[str, float], None] = lambda what, fraction: None

    def pose(self) -> np.ndarray:
        return POSE

    def play(
        self, motion: Trajectory, path: Path, table: ParameterTable, *, patient: bool = False, watched: bool = True
    ) -> Played:
        self.at_play(len(self.played))
        self.report("recording", 0.0)
        self.played.append(table)
        leader = motion.at(np.arange(round(motion.duration_s / TICK_S), dtype=np.float64) * TICK_S)
        reference = np.vstack([np.tile(leader[:1], (WAIT, 1)), leader])
        loop = ClosedLoop(
            table,
            known_readings(reference),
            self.arm.follower_pots,
            seed=3,
            home=reference[0].tolist(),
            gap=[0.0] * JOINTS,
            weight_s=np.zeros(len(reference)),
        )
        result = loop.run(controllers_of(table)[None], plant_row(self.arm)[None], substeps=2, every=EVERY)
        volts = result.duties[0] / np.array(pwm_steps(table.board)) * table.supply_v
        follower = result.angles[0].astype(np.float64)
        stopped = _write(path, table, reference[::EVERY], follower, volts, Watch() if watched else None)
        return Played(read_log(path), "" if stopped is None else f"joint {stopped} hunted", stopped)

    def keep(self, table: ParameterTable) -> None:
        self.stored = self.before = table

    @contextmanager
    def connected(
        self, port: str, before: ParameterTable | None, progress: Callable[[str, float], None]
    ) -> Iterator[SimulatedRig]:
        """In the place of greywhale.commission.rig.connected."""
        self.report = progress
        if before is not None and before.crc != self.stored.crc:
            raise UserError(f"{port}: the board runs another set.")
        yield self


def _write(
    path: Path, table: ParameterTable, leader: np.ndarray, follower: np.ndarray, volts: np.ndarray, watch: Watch | None
) -> int | None:
    """The log of the traces; the joint for which the watch stopped it."""
    counts = np.round(np.stack([leader, follower]) / ANGLE_LSB).astype(int)
    origin = Origin("0.1.0", table.board.key, table.crc, table.period_ms, EVERY, joints=table.joints_in_use)
    with LogWriter(path, origin) as log:
        for row in range(len(leader)):
            tick = EVERY * row
            log.append(tick / 1000, leader[row], follower[row], volts[row], "following")
            if watch is None:
                continue
            one, other = (tuple(map(int, values[row])) for values in counts)
            sample = schema.Sample(tick, schema.State.FOLLOWING, schema.Fault.NONE, one, other, (0, 0, 0, 0))  # type: ignore[arg-type]
            try:
                watch(Received(sample, tick, 0))
            except Hunting as hunting:
                return hunting.joint
    return None
