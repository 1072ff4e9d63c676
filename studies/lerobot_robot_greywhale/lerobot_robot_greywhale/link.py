"""The link to one board, which robot and teleoperator share: a thread reads the samples and renews the motors' lease.

The motors go off when the robot disconnects, when the thread ends for whatever reason, and, by the board itself, half a
second after this process died.
"""

from __future__ import annotations

import math
import os
import threading
import time
from contextlib import ExitStack
from enum import Enum
from typing import ClassVar

import numpy as np

from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.board.device import Device
from greywhale.board.lead import Leading, leadable
from greywhale.board.limits import RECORDING
from greywhale.board.stream import Received, stream, why_stopped
from greywhale.board.upload import read_parameters
from greywhale.files.exchange.lerobot_frames import names_of
from greywhale.protocol import schema
from greywhale.protocol.firmware import ANGLE_LSB, POINT_S
from greywhale.protocol.joints import Joints, require_same
from greywhale.protocol.ports import choose_port

# A sample every so many ticks: the rarest by which a board can be led.
EVERY_TICKS = 4
# Points that the board has ahead: so late it hears of an action, and so late this process may be (64 ms).
AHEAD_POINTS = 4
# Within so many ticks of their start the samples must show that the motors are on.
_START_TICKS = 1000
_LOOK_S = 0.1  # between two looks of a caller who waits
_STALE_S = 1.0  # an older sample says nothing of the arm


class Motors(Enum):
    OFF = "off"
    FOLLOW = "follow"  # the follower follows the leader arm
    LEAD = "lead"  # actions lead it
    END = "end"  # and so does the link


class Goal:
    """A reference that goes to the goal of the moment, no faster than a speed."""

    end = math.inf

    def __init__(self, start: Floats, speed: float) -> None:
        """`start` (4,) in rad, `speed` in rad/s."""
        self.wanted = start
        self._now, self._place, self._step = start, 0.0, speed * POINT_S

    def at(self, place: float) -> Floats:
        most = (place - self._place) * self._step
        self._place = place
        self._now = self._now + np.clip(self.wanted - self._now, -most, most)
        return self._now


class Link:
    """Use `join` and `leave`. What ended the thread is raised by every later call but `leave`."""

    _open: ClassVar[dict[str, Link]] = {}

    def __init__(self, port: str) -> None:
        self.device = Device(port)
        with ExitStack() as undo:
            undo.callback(self.device.close)
            self.table = read_parameters(self.device)
            self.limits = leadable(np.array(self.table.limits_raw()) * ANGLE_LSB)
            undo.pop_all()
        self.speed = 0.0  # of what actions lead, rad/s
        self.given: dict[str, float] | None = None  # the teleoperator's last action
        self._users = 0
        self._changed = threading.Condition()
        self._wanted, self._now, self._following = Motors.OFF, Motors.OFF, False
        self._began = 0
        self._goal: Goal | None = None
        self._leading: Leading | None = None
        self._newest: schema.Sample | None = None
        self._heard_s = 0.0
        self._error: BaseException | None = None
        self._thread = threading.Thread(target=self._run, name="greywhale-lerobot", daemon=True)
        self._thread.start()

    @classmethod
    def join(cls, port: str | None, joints: Joints) -> Link:
        """The link to a board, which is opened for the first user; UserError where it does not use these joints."""
        chosen = choose_port(port)
        key = os.path.realpath(chosen)
        link = cls._open.get(key) or cls(chosen)
        cls._open[key] = link
        link._users += 1
        try:
            require_same("--robot.joints or --teleop.joints", joints, chosen, link.table.joints_in_use)
        except BaseException:
            link.leave()
            raise
        return link

    def leave(self) -> None:
        """End the use; the last one turns the motors off and closes the port."""
        self._users -= 1
        if self._users:
            return
        Link._open = {key: link for key, link in Link._open.items() if link is not self}
        self._wanted = Motors.END
        self._thread.join()
        self.device.close()

    @property
    def works(self) -> bool:
        return self._error is None

    @property
    def motors(self) -> Motors:
        return self._now

    def turn(self, motors: Motors) -> None:
        """Turn the motors off or on, and wait until the board has done it; on is after the soft start."""
        self._wanted = motors
        with self._changed:
            while self._now is not motors or (motors is not Motors.OFF and not self._following):
                self._raise()
                self._changed.wait(_LOOK_S)

    def sample(self) -> schema.Sample:
        """The newest sample; UserError where that is old."""
        with self._changed:
            while self._newest is None or self._error is not None:
                self._raise()
                self._changed.wait(_LOOK_S)
            if time.monotonic() > self._heard_s + _STALE_S:
                raise UserError(
                    f"{self.device.port}: no sample came for {_STALE_S:g} s, so the motors go off by themselves; check "
                    "cable and supply, and connect again."
                )
            return self._newest

    def given_now(self, joints: Joints) -> dict[str, float]:
        """The leader's angles as an action, rad."""
        leader = self.sample().leader
        angles = [leader[joint] * ANGLE_LSB for joint in joints]
        return dict(zip(names_of(joints, "pos"), angles, strict=True))

    def lead_to(self, goal: Floats) -> None:
        """Let actions lead to `goal` (4,), rad within `limits`."""
        self._raise()
        assert self._goal is not None
        self._goal.wanted = goal

    def _raise(self) -> None:
        if self._error is not None:
            raise self._error

    # --- the thread -------------------------------------------------------------------------------------------------

    def _run(self) -> None:
        try:
            with ExitStack() as motors:
                for one in stream(self.device, EVERY_TICKS):
                    if self._wanted is not self._now:
                        self._switch(motors, self._wanted, one)
                    if self._now is Motors.END:
                        self.device.telemetry(0)
                        return
                    self._look(one)
                    with self._changed:
                        self._newest, self._heard_s = one.sample, time.monotonic()
                        self._changed.notify_all()
        except BaseException as error:
            with self._changed:
                self._error = error
                self._changed.notify_all()

    def _switch(self, motors: ExitStack, wanted: Motors, one: Received) -> None:
        motors.close()
        self._goal = self._leading = None
        self._following, self._began = False, one.elapsed
        if wanted is Motors.FOLLOW:
            motors.enter_context(self.device.enabled(RECORDING.lease_ms))
        elif wanted is Motors.LEAD:
            begun = motors.enter_context(self.device.leading(RECORDING.lease_ms))
            self._goal = Goal(np.array(begun.reference) * ANGLE_LSB, self.speed)
            limit = self.table.physical("tracking_limit")
            self._leading = Leading(self.device, begun, self._goal, limit, AHEAD_POINTS)
        self._now = wanted

    def _look(self, one: Received) -> None:
        """Keep the board led, and end where its motors went off by themselves."""
        state = one.sample.state
        if self._now is Motors.OFF:
            return
        if state in (schema.State.SOFT_START, schema.State.FOLLOWING):
            self._following = state is schema.State.FOLLOWING
            self._began = -_START_TICKS  # from now on they are on, or were turned off
            if self._leading is not None:
                self._leading.keep_ahead(one.elapsed, one.sample)
        elif state is schema.State.FAULT or one.elapsed - self._began > _START_TICKS:
            raise why_stopped(self.device)
