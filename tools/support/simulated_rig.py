"""An arm on its board for trials, simulated in a moment by the native loop: it offers what a Rig offers.

The same arm with the same controllers does the same on the same motion: each is simulated once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.parameters import with_usual_noise
from greywhale.arm.plants import plant_row
from greywhale.base.errors import UserError
from greywhale.base.types import Floats, show_no_progress
from greywhale.board.hunting_stop import Hunting, HuntingStop
from greywhale.board.stream import Received
from greywhale.commission.arm_on_port import PlayedMotion
from greywhale.commission.motions import JointRange
from greywhale.files.log import LogWriter, read_log
from greywhale.files.log.layout import Origin
from greywhale.files.trajectory import Trajectory
from greywhale.loop.closed_loop import ClosedLoop, known_readings
from greywhale.loop.controllers import controllers_of
from greywhale.protocol import schema
from greywhale.protocol.firmware import ANGLE_LSB, JOINTS, TICK_S, pwm_steps
from greywhale.protocol.table import ParameterTable

POSE = np.array([0.0, 0.4, 0.0, 0.0])
ROOM = JointRange(POSE, POSE - 0.9, POSE + 0.9)
WAIT = 300  # ticks at the first pose
EVERY = 4  # ticks from one row of a log to the next


class SimulatedRig:
    """Plays as a Rig does. `played` lists the tables of its motions in order; `stored` is what the board keeps."""

    def __init__(self, arm: ArmParameters, before: ParameterTable | None = None, seed: int = 3) -> None:
        self.arm, self.seed = with_usual_noise(arm), seed  # of the noise
        self.before = before or ParameterTable.defaults()
        self.stored = self.before
        self.played: list[ParameterTable] = []
        self.at_play: Callable[[int], None] = lambda number: None
        self.report: Callable[[str, float], None] = show_no_progress

    def pose(self) -> Floats:
        return POSE

    def play(
        self, motion: Trajectory, path: Path, table: ParameterTable, *, patient: bool = False, watched: bool = True
    ) -> PlayedMotion:
        self.at_play(len(self.played))
        self.report("recording", 0.0)
        self.played.append(table)
        log, stopped = _recorded(self.arm, motion, table, watched, self.seed)
        path.write_bytes(log)
        return PlayedMotion(read_log(path), "" if stopped is None else f"joint {stopped} hunted", stopped)

    def keep(self, table: ParameterTable) -> None:
        self.stored = self.before = table

    @contextmanager
    def connected(
        self, port: str, before: ParameterTable | None, nominal: ArmParameters, progress: Callable[[str, float], None]
    ) -> Iterator[SimulatedRig]:
        """In the place of greywhale.commission.arm_on_port.connected."""
        self.report = progress
        if before is not None and before.crc != self.stored.crc:
            raise UserError(f"{port}: the board runs another set.")
        yield self


_known: dict[tuple[object, ...], tuple[bytes, int | None]] = {}


def _recorded(
    arm: ArmParameters, motion: Trajectory, table: ParameterTable, watched: bool, seed: int
) -> tuple[bytes, int | None]:
    """The log, and the joint for which the watch stopped it."""
    key = arm.model_dump_json(), motion.time_s.tobytes(), motion.angles.tobytes(), table, watched, seed
    if key not in _known:
        with TemporaryDirectory() as folder:
            path = Path(folder) / "log.csv"
            stopped = _record(arm, motion, table, path, HuntingStop() if watched else None, seed)
            _known[key] = path.read_bytes(), stopped
    return _known[key]


def _record(
    arm: ArmParameters, motion: Trajectory, table: ParameterTable, path: Path, watch: HuntingStop | None, seed: int
) -> int | None:
    leader = motion.at(np.arange(round(motion.duration_s / TICK_S), dtype=np.float64) * TICK_S)
    reference = np.vstack([np.tile(leader[:1], (WAIT, 1)), leader])
    loop = ClosedLoop(
        table,
        known_readings(reference),
        arm.follower_pots,
        seed=seed,
        home=reference[0].tolist(),
        gap=[0.0] * JOINTS,
        weight_s=np.zeros(len(reference)),
    )
    result = loop.run(controllers_of(table)[None], plant_row(arm)[None], substeps=2, every=EVERY)
    volts = result.duties[0] / np.array(pwm_steps(table.board)) * table.supply_v
    return _write(path, table, reference[::EVERY], result.angles[0].astype(np.float64), volts, watch)


def _write(
    path: Path,
    table: ParameterTable,
    leader: Floats,
    follower: Floats,
    volts: Floats,
    watch: HuntingStop | None,
) -> int | None:
    """The log of the traces; the joint for which the watch stopped it."""
    counts = np.round(np.stack([leader, follower]) / ANGLE_LSB).astype(int).tolist()
    origin = Origin("0.1.0", table.board.key, table.crc, table.period_ms, EVERY, joints=table.joints_in_use)
    with LogWriter(path, origin) as log:
        for row, columns in enumerate(zip(leader.tolist(), follower.tolist(), volts.tolist(), strict=True)):
            tick = EVERY * row
            log.append(tick / 1000, *columns, "following")
            if watch is None:
                continue
            one, other = (tuple(angles[row]) for angles in counts)
            sample = schema.Sample(tick, schema.State.FOLLOWING, schema.Fault.NONE, one, other, (0, 0, 0, 0))
            try:
                watch(Received(sample, tick, 0))
            except Hunting as hunting:
                return hunting.joint
    return None
