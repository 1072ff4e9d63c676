"""Records although the port goes away in between: waits for it, opens it again, and goes on after a stated gap.

The motors stay off: nothing here can start them. A port that comes back is a board that has restarted, so its clock
begins anew; this machine's own clock measures the gap.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable
from pathlib import Path

from greywhale.base.errors import UserError
from greywhale.base.types import Progress, show_no_progress
from greywhale.board.device import Device
from greywhale.board.record import Recording, check_request, origin_of, write_samples
from greywhale.board.stream import stream
from greywhale.board.upload import read_parameters
from greywhale.files.log.writer import LogWriter
from greywhale.protocol.ports import lasting_name
from greywhale.protocol.transport import PortLostError

Open = Callable[[str], Device]


def record_through_losses(
    port: str,
    path: str | Path,
    seconds: float,
    every: int = 1,
    report: Progress = show_no_progress,
    open_device: Open = Device,
) -> Recording:
    """Record `seconds` of samples with the motors off; time goes on while the port is away.

    Where it does not come back until then, or with another board or other parameters, the log ends there and says so.
    """
    check_request(seconds, every, enable=False)
    name, length = lasting_name(port), round(seconds * 1000)
    device = open_device(port)
    try:
        origin = origin_of(device, read_parameters(device, report), every)
    except BaseException:
        device.close()
        raise
    with LogWriter(path, origin, gaps=True) as log:
        away_s: float | None = None  # since when, on this machine's clock
        rows = 0  # when it went away
        while True:
            try:
                with device:
                    duration = _write(device, log, away_s, length, every, report)
                    device.telemetry(0)
                return Recording(Path(path), log.rows, log.dropped, duration, gaps=tuple(log.gaps))
            except PortLostError as lost:
                if away_s is None or log.rows > rows:
                    away_s, rows = time.monotonic(), log.rows
                device = _come_back(name, lost, away_s + length / 1000 - log.last_s, report, open_device)


def _write(device: Device, log: LogWriter, away_s: float | None, length: int, every: int, report: Progress) -> float:
    """Fill the log to its end, after a gap where the port was away since `away_s`, and return its duration in s."""
    if away_s is not None:
        _require_same(device, log)
    received = stream(device, every)
    first = next(received)
    begin = 0 if away_s is None else _state_gap(log, away_s)
    return write_samples(device, log, itertools.chain((first,), received), length, False, report, begin)


def _come_back(name: str, lost: PortLostError, until_s: float, report: Progress, open_device: Open) -> Device:
    """Wait for the port and open it; raise the loss after `until_s` on the monotonic clock."""
    last = lost.message
    while time.monotonic() < until_s:
        report("waiting for the port", 0.0)
        try:
            return open_device(name)
        except UserError as error:
            last = error.message
        time.sleep(0.2)  # it may not let itself be opened at once: its owner and its group come a moment later
    raise UserError(f"{lost.message} It did not come back before the recording's end: {last}") from None


def _require_same(device: Device, log: LogWriter) -> None:
    """Refuse to go on with what another board says."""
    now = origin_of(device, read_parameters(device), log.origin.every_ticks or 1)
    if now != log.origin:
        raise UserError(
            f"{device.port}: the board that came back is another one, or runs other parameters; record anew."
        )


def _state_gap(log: LogWriter, away_s: float) -> int:
    """Note the gap since `away_s`, and return the time of the next sample in ms."""
    gap_s = time.monotonic() - away_s
    log.gap(gap_s)
    return round(1000 * (log.last_s + gap_s)) + 1
