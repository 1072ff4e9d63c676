"""Says what is wrong with a set-up and how to mend it: port, board, parameters, potentiometers, link."""

from __future__ import annotations

from greywhale.board.doctor.examine import Options, examine
from greywhale.board.doctor.finding import Finding, Verdict, worst

__all__ = ["Finding", "Options", "Verdict", "examine", "worst"]
