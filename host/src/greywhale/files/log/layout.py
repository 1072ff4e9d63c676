"""What a log looks like: its columns and the facts in its commented header."""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.firmware import JOINTS

TITLE = "greywhale log 1"
STATES = ("boot", "disabled", "soft_start", "following", "fault")
COLUMNS = (
    "time_s",
    *(f"leader_{joint}" for joint in range(JOINTS)),
    *(f"follower_{joint}" for joint in range(JOINTS)),
    *(f"voltage_{joint}" for joint in range(JOINTS)),
    "state",
)
HEADING = ",".join(COLUMNS)

# How a recording ended, as the header says it.
COMPLETE = "complete"
INTERRUPTED = "interrupted"
UNFINISHED = "unfinished"
ENDINGS = (COMPLETE, INTERRUPTED, UNFINISHED)


@dataclass(frozen=True)
class Origin:
    """Where a log comes from: known when recording starts, None where another tool wrote the file without saying."""

    firmware: str | None = None
    board: str | None = None
    param_crc: int | None = None
    period_ms: int | None = None
    every_ticks: int | None = None
