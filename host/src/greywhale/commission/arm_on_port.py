"""The arm on its board: plays motions with controllers on trial, and always gives the controllers from before back.

Controllers on trial run, but are not stored. So whatever happens (a lost port, a power cut, this program killed), the
board runs those from before again after its next start; opening its port restarts an Arduino. Only `keep` stores.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from greywhale.arm import ArmParameters
from greywhale.base.errors import UserError
from greywhale.base.types import Floats, Progress
from greywhale.board.device import Device, hold_ctrl_c
from greywhale.board.hunting_stop import Hunting, HuntingStop
from greywhale.board.limits import RECORDING
from greywhale.board.record import pose_of, record_led
from greywhale.board.stream import OF_THE_MOTION, LeaseLostError
from greywhale.board.upload import read_parameters, run_set, upload_set
from greywhale.commission.sinking import describe_sinking
from greywhale.files.log import Log, read_evidence
from greywhale.files.trajectory import Trajectory
from greywhale.measure.swings import VIOLENT, turns_at_end
from greywhale.protocol import schema
from greywhale.protocol.table import ParameterTable

# A motion is led so often where this computer was too busy to lead it to its end.
TRIES = 3

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class PlayedMotion:
    """A log, and why it ended early: `joint` is the one that the board or this host stopped for, None where unknown;
    `swung` is True where it did what a joint does whose swings grow.
    """

    log: Log
    stopped: str = ""
    joint: int | None = None
    swung: bool = False


class ArmOnPort:
    """A board on an open port that runs the table `before`, with an arm that is about the `nominal` one."""

    def __init__(self, device: Device, before: ParameterTable, nominal: ArmParameters, progress: Progress) -> None:
        self.device = device
        self.before = before
        self.nominal = nominal
        self._progress = progress
        self._running = before

    def pose(self) -> Floats:
        """The follower's angles now, (4,) rad."""
        return pose_of(self.device)

    def play(
        self, motion: Trajectory, path: Path, table: ParameterTable, *, patient: bool = False, watched: bool = True
    ) -> PlayedMotion:
        """Lead the arm along a motion with the controllers of a table, and put those from before back.

        A `patient` arm waits for a follower that lags; a `watched` arm is stopped when a joint hunts. What this
        computer itself spoilt, because it was busy, says nothing about the arm: it is led again, a few times.
        """
        try:
            self._run(table)
            played = self._lead(motion, path, table, patient, watched)
        except BaseException as error:
            self._put_back(error)
            raise
        self._run(self.before)
        return played

    def keep(self, table: ParameterTable) -> None:
        """Run and store the controllers of a table."""
        if table.crc != self.before.crc:
            upload_set(self.device, table, self._progress)
        self.before = self._running = table

    def _put_back(self, error: BaseException) -> None:
        """Run the controllers from before after an error or Ctrl-C; the motors are off by now."""
        with hold_ctrl_c():
            try:
                self._run(self.before)
            except UserError:
                error.add_note("The board runs the controllers from before again after its next start.")

    def _run(self, table: ParameterTable) -> None:
        if self._running.crc != table.crc:
            run_set(self.device, table, self._progress)
            self._running = table

    def _lead(
        self, motion: Trajectory, path: Path, table: ParameterTable, patient: bool, watched: bool
    ) -> PlayedMotion:
        for attempt in range(2, TRIES + 1):
            try:
                return self._record(motion, path, table, patient, HuntingStop() if watched else None)
            except LeaseLostError as late:
                logger.info("%s", late.message)
                self._progress(f"this computer was too busy: once more, attempt {attempt} of {TRIES}", 0.0)
        try:
            return self._record(motion, path, table, patient, HuntingStop() if watched else None)
        except LeaseLostError as late:
            late.add_note(f"It was tried {TRIES} times.")
            raise

    def _record(
        self, motion: Trajectory, path: Path, table: ParameterTable, patient: bool, watch: HuntingStop | None
    ) -> PlayedMotion:
        path.unlink(missing_ok=True)
        try:
            record_led(
                self.device, path, motion, progress=self._progress, table=table, patient=patient, watch=watch,
                lease_ms=RECORDING.busy_lease_ms,
            )  # fmt: skip
        except Hunting as hunting:
            self.device.telemetry(0)
            return PlayedMotion(read_evidence(path), f"joint {hunting.joint} hunted", hunting.joint, swung=True)
        except UserError:
            status = self._status()
            if status is None or status.fault not in OF_THE_MOTION or not path.exists():
                raise
            self.device.telemetry(0)
            self.device.ask(schema.ClearFaultRequest())
            where = status.fault_where if status.fault_where < len(table.controllers) else None
            whose = "" if where is None else f" (joint {where})"
            told = f"the board stopped: {status.fault.description}{whose}"
            log = read_evidence(path)
            swung = where is not None and _swung(status.fault, log, where)
            sinking = "" if where is None or swung else describe_sinking(log, where, self.nominal)
            return PlayedMotion(log, told + sinking, where, swung)
        return PlayedMotion(read_evidence(path))

    def _status(self) -> schema.StatusReply | None:
        """The board's state after an error; None where it does not answer any more."""
        try:
            return self.device.status()
        except UserError:
            return None


def _swung(fault: schema.Fault, log: Log, joint: int) -> bool:
    """True where a fault ended growing swings. Unrest is swings; the others may be a wire, too, so the log must show
    that the joint turned.
    """
    if fault in (schema.Fault.SPEED, schema.Fault.RUNAWAY):
        return bool(turns_at_end(log.time, log.leader, log.follower)[joint] >= VIOLENT.turns)
    return fault is schema.Fault.UNREST


@contextmanager
def connected(
    port: str, before: ParameterTable | None, nominal: ArmParameters, progress: Progress
) -> Iterator[ArmOnPort]:
    """Open the port; the board must run the table `before`, where it is known. Leaving turns the motors off."""
    with Device(port) as device:
        running = read_parameters(device, progress)
        if before is not None and running.crc != before.crc:
            raise UserError(
                f"{port}: the board runs parameter set {running.crc:#06x}, but this commissioning began with "
                f"{before.crc:#06x}; connect that board, or begin anew in another folder."
            )
        yield ArmOnPort(device, running, nominal, progress)
