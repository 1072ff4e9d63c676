"""Torques from outside for a page: an identified model tells them of the board's samples as they come."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypedDict

import numpy as np

from greywhale.arm.parameters import ArmParameters
from greywhale.base.errors import BadUsage, cut
from greywhale.base.types import Floats
from greywhale.observe import Contact, Sight, Told, contacts_in, live_torque
from greywhale.protocol import schema
from greywhale.protocol.firmware import TICK_S
from greywhale.protocol.frames import FrameDecoder
from greywhale.protocol.joints import ALL


class JointNow(TypedDict):
    torque_nm: float
    half_width_nm: float  # of the 90 % interval
    why: str  # it cannot be told; "" where it can
    contact: bool
    share: float  # of the motor's stall torque, without its sign


class ContactNow(TypedDict):
    joint: int
    tick: int  # at which it was seen
    torque_nm: float  # the largest so far
    lasted_s: float
    lasts: bool


class TorqueNow(TypedDict):
    joints: list[JointNow]
    contact: ContactNow | None  # the last one to begin


class PagesTorque:
    """Torques for one page, from when it asks on. Raises UserError where the arm is no identified model."""

    def __init__(self, arm: ArmParameters, filter_shift: int) -> None:
        self._live = live_torque(arm, filter_shift)
        self._stall = np.array([arm.actuator(joint).torque_per_volt * arm.drive.supply for joint in ALL])
        self._decoder = FrameDecoder()
        self._lasting: dict[int, Contact] = {}
        self._last: Contact | None = None

    def take(self, frames: bytes) -> TorqueNow | None:
        """Tell what is known after these frames of samples; None where they hold none."""
        samples = [schema.Sample.unpack(frame.payload) for frame in self._decoder.feed(frames)]
        if not samples:
            return None
        told = self._live.feed_samples(samples)
        self._note(TICK_S * np.array([one.tick for one in samples]), told)
        return {"joints": [self._joint(joint, told) for joint in ALL], "contact": self._contact()}

    def _note(self, time: Floats, told: Told) -> None:
        lasting = {}
        for one in contacts_in(time, told, ALL):
            now, before = one, self._lasting.get(one.joint)
            if before is not None and one.time == time[0]:  # it goes on
                now = max(before, one, key=lambda each: abs(each.torque))
                now = Contact(one.joint, before.time, now.torque, one.time + one.lasted - before.time)
            if now is one or before is self._last:
                self._last = now
            if told.contact[-1, one.joint]:
                lasting[one.joint] = now  # the joint's last one is
        self._lasting = lasting

    def _joint(self, joint: int, told: Told) -> JointNow:
        torque, half_width, sight, contact = (rows[-1, joint] for rows in told)
        return {
            "torque_nm": float(torque),
            "half_width_nm": float(half_width),
            "why": Sight(sight).words,
            "contact": bool(contact),
            "share": float(abs(torque) / self._stall[joint]),
        }

    def _contact(self) -> ContactNow | None:
        if (last := self._last) is None:
            return None
        return {
            "joint": last.joint,
            "tick": round(last.time / TICK_S),
            "torque_nm": last.torque,
            "lasted_s": last.lasted,
            "lasts": self._lasting.get(last.joint) is last,
        }


def filter_shift_in(asked: Mapping[str, str]) -> int:
    """The board's low-pass of its readings, as a page names it."""
    text, declared = asked.get("filter_shift", ""), schema.PARAMETER_BY_NAME["filter_shift"]
    shifts = {str(shift): shift for shift in range(declared.minimum, declared.maximum + 1)}
    if text not in shifts:
        raise BadUsage(f"filter_shift is {cut(text)}; it must be one of {', '.join(shifts)}.")
    return shifts[text]
