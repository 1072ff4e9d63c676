"""What a long piece of work reports to a progress bar."""

from __future__ import annotations

from typing import Protocol


class Report(Protocol):
    """Takes what is being done, the share of it that is done, and a note such as the best cost."""

    def __call__(self, what: str, fraction: float, note: str = "") -> None: ...


def report_nothing(what: str, fraction: float, note: str = "") -> None:
    """Report nothing: nobody looks."""
