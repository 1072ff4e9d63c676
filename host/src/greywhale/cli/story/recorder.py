"""Records on the bench: the person there takes up a motion, the board its controllers, and the follower follows."""

from __future__ import annotations

import shlex
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from greywhale.base.bench_process import RunningBench
from greywhale.base.errors import UserError
from greywhale.base.types import Floats, Progress, show_no_progress
from greywhale.board.device import Device
from greywhale.board.record import Recording, record
from greywhale.board.refusal import RefusedError
from greywhale.board.stream import OF_THE_MOTION, stream
from greywhale.board.upload import read_parameters, upload_controller
from greywhale.files.leader import load_leader
from greywhale.files.log import Log, read_evidence
from greywhale.protocol import schema
from greywhale.protocol.joints import Joints

SETTLE_S = 1.0  # recorded after the leader's last movement
LEAD_S = 0.5  # between the end of the soft start and the leader's first movement
READY_RAD = 0.05  # both arms are back at the start within this


class StoppedError(UserError):
    """The board stopped a recording because of how the arm moved with these controllers, and can go on with others."""


@dataclass(frozen=True)
class Recorded:
    """A log, the CRC of its parameters, what the link lost of it, and the wall time of the upload."""

    path: Path
    param_crc: int
    samples: int
    dropped: int
    upload_s: float

    def log(self) -> Log:
        return read_evidence(self.path)


def record_motion(
    bench: RunningBench,
    leader: Path,
    log: Path,
    controller: Path | None = None,
    report: Progress = show_no_progress,
) -> Recorded:
    """Let the follower follow the whole motion of the file `leader` into `log`; upload `controller` first, if given.

    The log begins LEAD_S before the leader's first movement and ends SETTLE_S after its last. Raises StoppedError where
    the board stopped the arm for how it moved; the fault is cleared then.
    """
    length = LEAD_S + load_leader(leader).duration_s + SETTLE_S
    play = partial(record, path=log, seconds=length, enable=True, progress=report)
    return record_with(bench, leader, controller, report, play)


def record_with(
    bench: RunningBench,
    leader: Path,
    controller: Path | None,
    report: Progress,
    play: Callable[[Device], Recording],
) -> Recorded:
    """Give the person the motion `leader` and the board the controller, and record."""
    bench.command(f"leader {shlex.quote(str(leader.resolve()))}")
    started = time.monotonic()
    with Device(bench.port) as device:
        if controller is not None:
            upload_controller(device, controller, report)
        uploaded = time.monotonic()
        running = read_parameters(device)
        _wait_for_the_arms(bench, device, leader, running.joints_in_use)
        try:
            recording = play(device)
        except UserError as error:
            if device.status().fault not in OF_THE_MOTION:
                raise
            device.telemetry(0)
            try:
                device.ask(schema.ClearFaultRequest())
            except RefusedError:
                raise error from None
            raise StoppedError(error.message) from None
    return Recorded(recording.path, running.crc, recording.rows, recording.dropped, uploaded - started)


def _wait_for_the_arms(bench: RunningBench, device: Device, leader: Path, joints: Joints) -> None:
    """Wait until the person at the bench has brought both arms to the start of the motion, in the joints in use."""
    scale, used = schema.Sample.LSB["leader"], list(joints)
    home = load_leader(leader).angles[0]
    for one in stream(device, 10):
        arms = np.array([one.sample.leader, one.sample.follower]) * scale
        if np.abs(arms - home)[:, used].max() < READY_RAD:
            device.telemetry(0)
            return
        if one.elapsed > 20_000:
            raise _not_there(bench, leader, joints, arms)


def _not_there(bench: RunningBench, leader: Path, joints: Joints, seen: Floats) -> UserError:
    """The error of arms that are not at the start of the motion, or not seen there; `seen` is (2, 4) rad."""
    home, truth = load_leader(leader).angles[0], bench.command("status")
    for joint in joints:
        if abs(truth["follower"][joint] - home[joint]) > READY_RAD:
            return UserError(
                f"{leader}: the motion begins with joint {joint} at {home[joint]:.2f} rad, but the follower's stops "
                f"let it get only to {truth['follower'][joint]:.2f} rad; begin between its stops."
            )
    worst = max(joints, key=lambda joint: float(np.abs(seen[:, joint] - home[joint]).max()))
    leads, follows = seen[:, worst]
    return UserError(
        f"joint {worst} of both arms stands at {home[worst]:.2f} rad, but the board reads {leads:.2f} rad at the "
        f"leader and {follows:.2f} rad at the follower: it does not know these potentiometers. Leave [leader_pots] and "
        "[follower_pots] out of the arm file; without --arm it is a fault of the bench, please report it."
    )
