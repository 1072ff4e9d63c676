"""Says what is wrong with a set-up and how to mend it: port, board, parameters, potentiometers, link."""

from __future__ import annotations

from greywhale.board.doctor.examine import examine
from greywhale.board.doctor.finding import Finding, Verdict, worst

__all__ = ["Finding", "Verdict", "examine", "worst"]
