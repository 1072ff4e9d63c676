"""The layout of a log: its columns and the facts in its commented header."""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.files.log.parameters import lines_of
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.joints import ALL, Joints, listed
from greywhale.protocol.table import ParameterTable

TITLE = "greywhale log 1"
STATES = ("boot", "disabled", "soft_start", "following", "fault")
# Each for joint 0..3, and its digits after the point: rad, rad, V.
QUANTITIES = {"leader": 6, "follower": 6, "voltage": 3}
TIME_DIGITS = 6  # of s
# No board sends larger values: 16 bits of 1/4096 rad and of mV. Such values are another tool's degrees or millivolts.
MOST = {"leader": (8.0, "rad"), "follower": (8.0, "rad"), "voltage": (33.0, "V")}
COLUMNS = ("time_s", *(f"{quantity}_{joint}" for quantity in QUANTITIES for joint in range(JOINTS)), "state")
HEADING = ",".join(COLUMNS)

# How a recording ended, as the header says it.
COMPLETE = "complete"
INTERRUPTED = "interrupted"
UNFINISHED = "unfinished"
ENDINGS = (COMPLETE, INTERRUPTED, UNFINISHED)


@dataclass(frozen=True)
class Origin:
    """The origin of a log. A fact is known when recording starts, or None where another tool's file does not state
    it.
    """

    firmware: str | None = None
    board: str | None = None
    param_crc: int | None = None
    period_ms: int | None = None
    every_ticks: int | None = None
    table: ParameterTable | None = None  # that ran
    joints: Joints = ALL  # in use; the columns of the others are 0
    task: str | None = None  # of an episode, in a person's words

    @property
    def facts(self) -> dict[str, str]:
        """The known facts in the header's order, parameters that ran behind them; a header quotes the task."""
        facts = {
            "firmware": self.firmware,
            "board": self.board,
            "parameter_crc": None if self.param_crc is None else f"0x{self.param_crc:04x}",
            "period_ms": self.period_ms,
            "every_ticks": self.every_ticks,
            "joints_in_use": None if self.joints == ALL else listed(self.joints),
            "task": self.task,
        }
        known = {key: str(value) for key, value in facts.items() if value is not None}
        lines = [] if self.table is None else lines_of(self.table)
        return known | dict(line.split(": ", 1) for line in lines)
