"""Work beside the main thread: silent until somebody waits, and interrupted when nobody will."""

from __future__ import annotations

from threading import Event

import pytest

from greywhale.base.errors import UserError
from greywhale.base.side_job import SideJob
from greywhale.base.types import NotedProgress, show_no_progress


def test_its_progress_is_seen_once_somebody_waits() -> None:
    told: list[str] = []
    begun = Event()

    def work(report: NotedProgress) -> str:
        report("early", 0.0)
        begun.set()
        while not told:
            report("late", 0.5)
        return "done"

    def tell(what: str, fraction: float, note: str = "") -> None:
        told.append(what)

    with SideJob(work, tell) as job:
        begun.wait()
        assert told == []
        assert job.result() == "done"
    assert told == ["late"]


def test_an_error_of_the_main_thread_interrupts_it() -> None:
    begun = Event()
    ends: list[str] = []

    def work(report: NotedProgress) -> None:
        try:
            while True:
                report("working", 0.0)
                begun.set()
        except KeyboardInterrupt:
            ends.append("interrupted")

    with pytest.raises(UserError, match="the arm stopped"), SideJob(work, show_no_progress):
        begun.wait()
        raise UserError("the arm stopped.")
    assert ends == ["interrupted"]


def test_its_error_comes_with_its_result() -> None:
    def work(report: NotedProgress) -> None:
        raise UserError("the log shows no motion.")

    with SideJob(work, show_no_progress) as job, pytest.raises(UserError, match="no motion"):
        job.result()
