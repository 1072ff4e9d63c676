"""Work in a process beside this one: silent until somebody waits, and ended when nobody will."""

from __future__ import annotations

import os
import subprocess
import sys
from functools import partial
from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.base.study.side_job import side_jobs
from greywhale.base.types import NotedProgress, show_no_progress


def work_until_heard(begun: Path, heard: Path, report: NotedProgress) -> int:
    """Report late, once the reader of a pipe knows that early was reported; it ends when late was heard."""
    report("early", 0.0)
    begun.write_text("begun")
    while not heard.exists():
        report("late", 0.5, "a note")
    return os.getpid()


def fail(report: NotedProgress) -> None:
    raise UserError("the log shows no motion.")


def end(report: NotedProgress) -> None:
    os._exit(1)


def work_for_ever(begun: Path, report: NotedProgress) -> None:
    begun.write_text(str(os.getpid()))
    while True:
        report("working", 0.0)


@pytest.fixture
def pipe(tmp_path: Path) -> Path:
    """Reading it waits until a process has begun."""
    path = tmp_path / "begun"
    os.mkfifo(path)
    return path


def test_its_progress_is_seen_once_somebody_waits_and_its_process_does_the_next_job(pipe: Path, tmp_path: Path) -> None:
    told: list[tuple[str, float, str]] = []
    heard = tmp_path / "heard"

    def tell(what: str, fraction: float, note: str = "") -> None:
        told.append((what, fraction, note))
        heard.touch()

    with side_jobs(tell) as jobs:
        job = jobs.begin(partial(work_until_heard, pipe, heard))
        assert pipe.read_text() == "begun"
        assert told == []
        process = job.result()
        assert {*told} == {("late", 0.5, "a note")}
        assert process != os.getpid()
        heard.unlink()
        told.clear()
        second = jobs.begin(partial(work_until_heard, pipe, heard))
        assert pipe.read_text() == "begun"
        assert told == [], "nobody waits for this one yet"
        assert second.result() == process


def test_an_error_of_this_process_ends_it_at_once(pipe: Path) -> None:
    def leave() -> int:
        with side_jobs(show_no_progress) as jobs:
            jobs.begin(partial(work_for_ever, pipe))
            process.append(int(pipe.read_text()))
            raise UserError("the arm stopped.")

    process: list[int] = []
    with pytest.raises(UserError, match="the arm stopped"):
        leave()
    with pytest.raises(ProcessLookupError):
        os.kill(process[0], 0)


def test_its_errors_come_with_its_result() -> None:
    with side_jobs(show_no_progress) as jobs:
        with pytest.raises(UserError, match="no motion"):
            jobs.begin(fail).result()
        with pytest.raises(UserError, match="the process that learns beside the motion was ended"):
            jobs.begin(end).result()


def test_a_script_that_leads_an_arm_at_once_is_not_run_again(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(
        "from greywhale.base.study.side_job import side_jobs\n"
        "print('leads')\n"
        "with side_jobs(print) as jobs:\n"
        "    print(jobs.begin(bool).result())\n"
    )
    ran = subprocess.run([sys.executable, script], check=True, capture_output=True, text=True)
    assert ran.stdout.split() == ["leads", "True"]
