"""Outside torques from a model and a log, or sample by sample; C++ (host/native/observe) does the work.

A value is what acted about 30 ms before (three low-passes of 9 ms, and the board's), with half the width of an
interval that holds 90 %: the spread over arms that the identification allows as well, the noise of the potentiometers,
and doubts about friction and motor. Sources: De Luca and Mattone 2003 (the observer); Linderoth et al., IROS 2013
(friction is known in motion alone).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Any, NamedTuple, TypedDict

import numpy as np
from numpy.typing import NDArray

from greywhale import _native
from greywhale.arm import ArmParameters
from greywhale.base.limits import numbers_in
from greywhale.base.types import Floats
from greywhale.files.log import Log
from greywhale.files.log.driven import driven_rows
from greywhale.files.log.held import Numbers
from greywhale.measure.runs import stretches
from greywhale.observe.limits import TORQUE_LIMITS, TorqueLimits
from greywhale.protocol import schema
from greywhale.protocol.firmware import CONVERSIONS, CONVERTER_COUNTS, JOINTS, TICK_S
from greywhale.protocol.joints import Joints
from greywhale.protocol.table import ParameterTable

LIVE_EVERY_TICKS = 4  # between samples that are looked at live: each tick would tell much the same
ARMS = 12  # that could have made the log; more would only take longer
# Rows that are observed at once, so that a log of an hour needs little memory.
_PART = 1 << 16


class Sight(IntEnum):
    """Answers to whether a torque can be told; numbers as in observe/observer.h."""

    TOLD = 0
    TURNING = 1  # just began to move, turned or struck
    RESTING = 2  # friction holds up to the breakaway torque
    IN_GAP = 3  # the motor does not touch its joint
    AT_STOP = 4
    UNUSED = 5
    OFF = 6  # the motors do not follow

    @property
    def words(self) -> str:
        """The reason why a torque cannot be told, in words for people; "" where it can."""
        return _WORDS.get(self, "")


_WORDS = {
    Sight.TURNING: "turning",
    Sight.RESTING: "at rest",
    Sight.IN_GAP: "in its gap",
    Sight.AT_STOP: "at a stop",
    Sight.UNUSED: "not in use",
    Sight.OFF: "motors off",
}


class ContactFacts(TypedDict):
    joint: int
    time_s: float  # when it was seen
    torque_nm: float  # the largest while it lasted
    lasted_s: float


class JointTorqueFacts(TypedDict):
    rms_nm: float | None  # of what can be told; null where nothing can
    lowest_nm: float | None
    highest_nm: float | None
    half_width_nm: float | None  # of the 90 % interval, median
    not_told: dict[str, float]  # shares of the following rows in which it cannot be told, by reason


class TorqueFacts(TypedDict):
    model: str
    joints: list[JointTorqueFacts]
    contacts: list[ContactFacts]


@dataclass(frozen=True)
class Contact:
    """Something pushed a joint by `torque` (N m, the largest), seen at `time` (s) for so long (s)."""

    joint: int
    time: float
    torque: float
    lasted: float

    def as_dict(self) -> ContactFacts:
        return {"joint": self.joint, "time_s": self.time, "torque_nm": self.torque, "lasted_s": self.lasted}


@dataclass(frozen=True)
class ExternalTorque:
    """Torques (rows, 4) N m from outside, half widths of their 90 % intervals, sights (`Sight`), and contacts."""

    model: str
    torque: Floats
    half_width: Floats
    sight: NDArray[np.uint8]
    contacts: tuple[Contact, ...]

    @property
    def told(self) -> NDArray[np.bool_]:
        """True (rows, 4) where a torque can be told."""
        known: NDArray[np.bool_] = self.sight == Sight.TOLD
        return known

    def as_dict(self) -> TorqueFacts:
        return {
            "model": self.model,
            "joints": [self._facts(joint) for joint in range(JOINTS)],
            "contacts": [one.as_dict() for one in self.contacts],
        }

    def _facts(self, joint: int) -> JointTorqueFacts:
        sight = self.sight[:, joint]
        known = sight == Sight.TOLD
        torque = self.torque[known, joint]
        shown = (np.sqrt(np.mean(torque**2)), torque.min(), torque.max()) if torque.size else (None,) * 3
        rms, lowest, highest = (None if one is None else float(one) for one in shown)
        followed = max(1, int(np.count_nonzero(sight != Sight.OFF)))
        shares = {
            one.name.lower(): float(np.count_nonzero(sight == one)) / followed
            for one in Sight
            if one not in (Sight.TOLD, Sight.OFF) and (sight == one).any()
        }
        half = float(np.median(self.half_width[known, joint])) if torque.size else None
        return {
            "rms_nm": rms,
            "lowest_nm": lowest,
            "highest_nm": highest,
            "half_width_nm": half,
            "not_told": shares,
        }


class Told(NamedTuple):
    """Torques from outside and half widths of their intervals, N m, sights (`Sight`) and contacts: (n, 4) each."""

    torque: Floats
    half_width: Floats
    sight: NDArray[np.uint8]
    contact: NDArray[np.bool_]


class LiveTorque:
    """Torques of samples as they come. Raises UserError where the arm is no identified model."""

    def __init__(
        self, arm: ArmParameters, filter_shift: int, spacing_s: float, limits: TorqueLimits = TORQUE_LIMITS
    ) -> None:
        """`filter_shift` is the board's; `spacing_s` that of the samples."""
        from greywhale.identify import sampled_plants  # slow to import
        from greywhale.identify.data import CONVERSION_S

        plants = np.ascontiguousarray(sampled_plants(arm, ARMS))
        delay = CONVERSION_S + TICK_S * ((1 << filter_shift) - 1)
        self._zero = zero_angles(arm)
        self._driven = False  # at the last sample
        self._observer = _native.TorqueObserver(
            plants, numbers_in(limits), reading_noise(arm, filter_shift, spacing_s).tolist(), delay
        )

    def feed(self, time: Floats, follower: Numbers, voltage: Numbers, driven: NDArray[np.bool_]) -> Told:
        """Tell the torques of samples at (n,) s with (n, 4) rad and V; `driven` (n,) is true where the motors follow.

        Whenever they begin to, the samples before are forgotten.
        """
        shape = follower.shape
        told = Told(np.zeros(shape), np.zeros(shape), np.full(shape, Sight.OFF, np.uint8), np.zeros(shape, bool))
        for start, stop in stretches(driven):
            if start or not self._driven:
                self._observer.restart()
            for begin in range(start, stop, _PART):
                rows = slice(begin, min(begin + _PART, stop))
                samples = (time[rows], follower[rows] + self._zero, voltage[rows])
                found = self._observer.feed(*(np.ascontiguousarray(one, np.float64) for one in samples))
                told.torque[rows], told.half_width[rows], told.sight[rows], told.contact[rows] = found
        self._driven = bool(driven[-1])
        return told

    def feed_samples(self, samples: Sequence[schema.Sample]) -> Told:
        """Tell the torques of some samples of a board, one at least."""
        follower, voltage = (
            np.array([getattr(one, name) for one in samples]) * schema.Sample.LSB[name]
            for name in ("follower", "voltage")
        )
        driven = np.array([one.state is schema.State.FOLLOWING for one in samples])
        return self.feed(TICK_S * np.array([one.tick for one in samples]), follower, voltage, driven)


def live_torque(model: ArmParameters, filter_shift: int) -> LiveTorque:
    """Begin to tell the torques of a board's samples, each `LIVE_EVERY_TICKS`; UserError as `LiveTorque`.

    Where one was lost, all begins anew: nobody knows the voltages meanwhile, and a torque would stand for them.
    """
    spacing_s = LIVE_EVERY_TICKS * TICK_S
    missed = replace(TORQUE_LIMITS, restart_s=1.5 * spacing_s)  # a sample was lost
    return LiveTorque(model, filter_shift, spacing_s, missed)


def estimate_external_torque(log: Log, model: ArmParameters, limits: TorqueLimits = TORQUE_LIMITS) -> ExternalTorque:
    """Estimate the torques that acted on the follower from outside, in every row of a log.

    `model` is a model.toml of `greywhale identify`; UserError for another arm file. Nothing is told where the motors do
    not follow.
    """
    table = log.origin.table or ParameterTable.defaults()
    live = LiveTorque(model, table["filter_shift"], float(np.median(np.diff(log.time))), limits)
    told = live.feed(log.time, log.held("follower"), log.held("voltage"), driven_rows(log))
    contacts = contacts_in(log.time, told, log.joints_in_use)
    return ExternalTorque(model.name, told.torque, told.half_width, told.sight, contacts)


def contacts_in(time: Floats, told: Told, joints: Joints) -> tuple[Contact, ...]:
    """The contacts of these joints in what was told of samples at (n,) s, in the order in which they began."""
    contacts = [
        _contact(joint, time, told.torque[:, joint], first, behind)
        for joint in joints
        for first, behind in stretches(told.contact[:, joint])
    ]
    return tuple(sorted(contacts, key=lambda one: one.time))


def _contact(joint: int, time: Floats, torque: Floats, first: int, behind: int) -> Contact:
    during = torque[first:behind]
    largest = float(during[np.argmax(np.abs(during))])
    return Contact(joint, float(time[first]), largest, float(time[behind - 1] - time[first]))


def zero_angles(arm: ArmParameters) -> Floats:
    """By how much (4,) rad the joints are beyond what the potentiometers read, as the identification found it."""
    tables: list[dict[str, Any]] = (arm.identification or {}).get("parameter", [])
    found = {str(one.get("name")): float(one["value"]) for one in tables}
    return np.array([found.get(f"joint{joint}.offset", 0.0) for joint in range(JOINTS)])


def reading_noise(arm: ArmParameters, filter_shift: int, spacing_s: float) -> Floats:
    """Noise of the readings (4,), rad² s: variance times spacing. Of slow samples each is behind the board's filter."""

    pots = arm.follower_pots
    volts = np.array([pot.noise / pots.supply for pot in pots.joint])
    tracks = np.array([pot.track for pot in pots.joint])
    conversion = tracks**2 * (volts**2 + 1.0 / (12.0 * CONVERTER_COUNTS**2)) / CONVERSIONS
    share = 1.0 / (1 << filter_shift)
    noise: Floats = conversion * max(TICK_S, spacing_s * share / (2.0 - share))
    return noise
