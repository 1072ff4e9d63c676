"""One joint's controller as the board stores it, and why a board would refuse one."""

from __future__ import annotations

from dataclasses import astuple, dataclass, fields
from fractions import Fraction
from pathlib import Path
from typing import Self

from greywhale import _native
from greywhale.files.controller import JointController, load
from greywhale.protocol.schema import Refusal

# Raw numbers of the firmware for 1: of a corner of a set, of a factor, and of a rad.
SET_UNIT = 1 << 14
GAIN_UNIT = 1 << 16
ANGLE_UNIT = 1 << 12

LEAST_WIDTH = 164  # 0.01, rounded up
LARGEST_K = 64 * GAIN_UNIT
LARGEST_KI = 1000 * GAIN_UNIT
LARGEST_KI_PERIOD = 1 << 28
LARGEST_KU_MV = 30_000
KD_SPAN_MS = 20
MOST_CE_TICKS = 20


@dataclass(frozen=True)
class JointSettings:
    """Sets in q14, gains in q16, Ku in mV; kd belongs to 20 ms. The names are the paper's and the firmware's."""

    ne_c: int
    ze_a: int
    ze_c: int
    pe_b: int
    nce_c: int
    zce_a: int
    zce_c: int
    pce_b: int
    kp: int
    kd: int
    ki: int
    ku_mv: int
    ce_ticks: int = 1  # control periods that the change of error spans

    @classmethod
    def of(cls, joint: JointController) -> Self:
        """The nearest values that the board can store."""
        raw = {parameter.name.partition(".")[2]: parameter.to_raw(value) for _, parameter, value in joint.parameters()}
        return cls(**raw)

    def set_values(self) -> dict[str, Fraction]:
        """The sets as exact numbers in [-1, 1]."""
        return {field.name: Fraction(getattr(self, field.name), SET_UNIT) for field in fields(self)[:8]}

    def native(self) -> _native.FuzzySettings:
        """The firmware's structure."""
        settings = _native.FuzzySettings()
        for field in fields(self):
            setattr(settings, field.name, getattr(self, field.name))
        return settings

    def controller(self, period_ms: int) -> _native.FuzzyController:
        """The firmware's controller, compiled for this machine."""
        return _native.FuzzyController(self.native(), period_ms)

    def refusal(self, period_ms: int) -> Refusal:
        """The reason why a board would refuse these settings: compile() of the firmware says it."""
        return Refusal(_native.fuzzy_refusal(self.native(), period_ms))

    def as_tuple(self) -> tuple[int, ...]:
        """The values in the firmware's order."""
        return astuple(self)


def load_joints(path: str | Path) -> tuple[JointSettings, ...]:
    """The four joints of a controller file."""
    return tuple(JointSettings.of(joint) for joint in load(path).joint)
