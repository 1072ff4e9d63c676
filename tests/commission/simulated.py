"""An arm on its board for trials, simulated in a moment by the native loop: it offers what a Rig offers.

The same arm with the same controllers does the same on the same motion: each is simulated once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.arm.parameters import with_usual_noise
from greywhale.arm.plants import plant_row
from greywhale.base.errors import UserError
from greywhale.base.study.side_job import side_jobs
from greywhale.base.types import show_no_progress
from greywhale.board.hunting_stop import Hunting, HuntingStop
from greywhale.board.stream import Received
from greywhale.commission import CommissioningRequest, foresee, learn, run
from greywhale.commission.arm_on_port import PlayedMotion
from greywhale.commission.motions import JointRange
from greywhale.commission.search import CheckOnModel
from greywhale.files.log import LogWriter, read_log
from greywhale.files.log.layout import Origin
from greywhale.files.trajectory import Trajectory
from greywhale.loop import multi_steps
from greywhale.loop.closed_loop import ClosedLoop, known_readings
from greywhale.loop.controllers import controllers_of
from greywhale.protocol import schema
from greywhale.protocol.firmware import ANGLE_LSB, JOINTS, TICK_S, pwm_steps
from greywhale.protocol.table import CONTROLLER_COLUMNS, ParameterTable
from greywhale.tune import TuningResult
from greywhale.tune.model import Model
from tests.tune.models import tuned, write_model

POSE = np.array([0.0, 0.4, 0.0, 0.0])
ROOM = JointRange(POSE, POSE - 0.9, POSE + 0.9)
WAIT = 300  # ticks at the first pose
EVERY = 4  # ticks from one row of a log to the next
KP, KD, KI = (CONTROLLER_COLUMNS.index(name) for name in ("kp", "kd", "ki"))


class SimulatedRig:
    """Plays as a Rig does. `played` lists the tables of its motions in order; `stored` is what the board keeps."""

    def __init__(self, arm: ArmParameters, before: ParameterTable | None = None) -> None:
        self.arm = with_usual_noise(arm)
        self.before = before or ParameterTable.defaults()
        self.stored = self.before
        self.played: list[ParameterTable] = []
        self.at_play: Callable[[int], None] = lambda number: None
        self.report: Callable[[str, float], None] = show_no_progress

    def pose(self) -> np.ndarray:
        return POSE

    def play(
        self, motion: Trajectory, path: Path, table: ParameterTable, *, patient: bool = False, watched: bool = True
    ) -> PlayedMotion:
        self.at_play(len(self.played))
        self.report("recording", 0.0)
        self.played.append(table)
        log, stopped = _recorded(self.arm, motion, table, watched)
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


def options_in(folder: Path) -> Callable[..., CommissioningRequest]:
    """Makes the options of a short commissioning in a folder; it begins with a model of the default arm."""
    model = write_model(folder / "model.toml")

    def make(**changes: Any) -> CommissioningRequest:
        given: dict[str, Any] = {
            "port": "port",
            "out": folder / "out",
            "model": model,
            "rounds": 1,
            "trials": 4,
            "budget": 12,
        }
        return CommissioningRequest(**given | changes)

    return make


def in_no_time(rig: SimulatedRig, patch: pytest.MonkeyPatch) -> None:
    """No board; controllers are found at once, twice as stiff, and too stiff for joint 2; few steps are foreseen; what
    failed on the arm comes back half as stiff.
    """

    def tune(model: Model, *, start: np.ndarray, **options: object) -> TuningResult:
        rows = start.copy()
        rows[:, [KP, KI]] *= 2
        rows[:, KD] = np.rint(1.4 * rows[:, KD])
        rows[2, KP] *= 10
        return tuned(model, start, rows)

    def search(check: CheckOnModel, begin: np.ndarray, vary: np.ndarray, *options: object) -> np.ndarray:
        rows = begin.copy()
        rows[vary, KP] //= 1 if vary.all() else 2
        return rows

    patch.setattr(run, "connected", rig.connected)
    patch.setattr(run, "side_jobs", partial(side_jobs, here=True))  # another process knows of no patch
    patch.setattr(learn, "tune", tune)
    patch.setattr(CheckOnModel, "search", search)
    steps = multi_steps()
    few = Trajectory(steps.time_s[steps.time_s < 4.0], steps.angles[steps.time_s < 4.0])
    patch.setattr(foresee, "multi_steps", lambda: few)


_known: dict[tuple[object, ...], tuple[bytes, int | None]] = {}


def _recorded(arm: ArmParameters, motion: Trajectory, table: ParameterTable, watched: bool) -> tuple[bytes, int | None]:
    """The log, and the joint for which the watch stopped it."""
    key = arm.model_dump_json(), motion.time_s.tobytes(), motion.angles.tobytes(), table, watched
    if key not in _known:
        with TemporaryDirectory() as folder:
            path = Path(folder) / "log.csv"
            stopped = _record(arm, motion, table, path, HuntingStop() if watched else None)
            _known[key] = path.read_bytes(), stopped
    return _known[key]


def _record(
    arm: ArmParameters, motion: Trajectory, table: ParameterTable, path: Path, watch: HuntingStop | None
) -> int | None:
    leader = motion.at(np.arange(round(motion.duration_s / TICK_S), dtype=np.float64) * TICK_S)
    reference = np.vstack([np.tile(leader[:1], (WAIT, 1)), leader])
    loop = ClosedLoop(
        table,
        known_readings(reference),
        arm.follower_pots,
        seed=3,
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
    leader: np.ndarray,
    follower: np.ndarray,
    volts: np.ndarray,
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
