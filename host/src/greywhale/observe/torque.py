"""Outside torques from a model and a log, or sample by sample; C++ (host/native/observe) does the work.

A value is what acted about 30 ms before (three low-passes of 9 ms, and the board's), with half the width of an
interval that holds 90 %: the spread over arms that the identification allows as well, the noise of the potentiometers,
and doubts about friction and motor. Sources: De Luca and Mattone 2003 (the observer); Linderoth et al., IROS 2013
(friction is known in motion alone).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

from greywhale import _native
from greywhale.arm import ArmParameters
from greywhale.base.limits import numbers_in
from greywhale.base.types import Floats
from greywhale.files.log import Log
from greywhale.files.log.driven import driven_rows
from greywhale.measure.runs import stretches
from greywhale.observe.limits import TORQUE_LIMITS, TorqueLimits
from greywhale.protocol.firmware import CONVERSIONS, JOINTS, TICK_S
from greywhale.protocol.table import ParameterTable

ARMS = 12  # that could have made the log; more would only take longer


class Sight(IntEnum):
    """Answers to whether a torque can be told; numbers as in observe/observer.h."""

    TOLD = 0
    TURNING = 1  # just began to move, turned or struck
    RESTING = 2  # friction holds up to the breakaway torque
    IN_GAP = 3  # the motor does not touch its joint
    AT_STOP = 4
    UNUSED = 5
    OFF = 6  # the motors do not follow


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
        self._observer = _native.TorqueObserver(
            plants, numbers_in(limits), reading_noise(arm, filter_shift, spacing_s).tolist(), delay
        )

    def restart(self) -> None:
        """Forget the samples so far: the motors were off."""
        self._observer.restart()

    def feed(
        self, time: Floats, follower: Floats, voltage: Floats
    ) -> tuple[Floats, Floats, NDArray[np.uint8], NDArray[np.bool_]]:
        """Torques and half widths (n, 4) N m, sights and contacts of samples at (n,) s with (n, 4) rad and V."""
        rows = (np.ascontiguousarray(one, dtype=np.float64) for one in (follower + self._zero, voltage))
        return self._observer.feed(np.ascontiguousarray(time, dtype=np.float64), *rows)


def estimate_external_torque(log: Log, model: ArmParameters, limits: TorqueLimits = TORQUE_LIMITS) -> ExternalTorque:
    """Estimate the torques that acted on the follower from outside, in every row of a log.

    `model` is a model.toml of `greywhale identify`; UserError for another arm file. Nothing is told where the motors do
    not follow.
    """
    table = log.origin.table or ParameterTable.defaults()
    live = LiveTorque(model, table["filter_shift"], float(np.median(np.diff(log.time))), limits)
    shape = log.follower.shape
    torque, half = np.zeros(shape), np.zeros(shape)
    sight, contact = np.full(shape, Sight.OFF, dtype=np.uint8), np.zeros(shape, dtype=bool)
    for start, stop in stretches(driven_rows(log)):
        live.restart()
        rows = slice(start, stop)
        told = live.feed(log.time[rows], log.follower[rows], log.voltage[rows])
        torque[rows], half[rows], sight[rows], contact[rows] = told
    contacts = [
        _contact(joint, log.time, torque[:, joint], first, behind)
        for joint in log.joints_in_use
        for first, behind in stretches(contact[:, joint])
    ]
    return ExternalTorque(model.name, torque, half, sight, tuple(sorted(contacts, key=lambda one: one.time)))


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
    from greywhale.identify.data import COUNTS  # slow to import

    pots = arm.follower_pots
    volts = np.array([pot.noise / pots.supply for pot in pots.joint])
    tracks = np.array([pot.track for pot in pots.joint])
    conversion = tracks**2 * (volts**2 + 1.0 / (12.0 * COUNTS**2)) / CONVERSIONS
    share = 1.0 / (1 << filter_shift)
    noise: Floats = conversion * max(TICK_S, spacing_s * share / (2.0 - share))
    return noise
