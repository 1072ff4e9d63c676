"""The running step is in sight, in a terminal of any size and in a pipe."""

from __future__ import annotations

import io

import pytest
from rich.console import Console
from rich.live import Live

from greywhale.cli.display import LINE_EVERY_S, Frame, Lines, Running

ERASE = "\x1b[2K"
STEPS = [f"round {number}: {what}" for number in range(1, 11) for what in ("recording", "global search", "tuning")]
LONG = "round 2: least squares from several starts"


class Time:
    """A clock that stands until it is set."""

    def __init__(self) -> None:
        self.now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


def terminal(width: int, height: int) -> Console:
    return Console(
        file=io.StringIO(), force_terminal=True, width=width, height=height, color_system=None, legacy_windows=False
    )


def last_frame(console: Console) -> str:
    """The text that stands on the terminal now, as one line."""
    assert isinstance(console.file, io.StringIO)
    return " ".join(console.file.getvalue().rpartition(ERASE)[2].split())


@pytest.mark.parametrize(("width", "height"), [(80, 24), (40, 12), (30, 5)])
def test_a_terminal_shows_the_running_step_alone_also_after_many(width: int, height: int) -> None:
    console, time = terminal(width, height), Time()
    running = Running(time)
    with Live(Frame(running), console=console, auto_refresh=False) as live:
        for what in (*STEPS, LONG):
            running(what, 0.0)
            time.now_s += 300.0
            running(what, 0.75, "cost 0.125, trial 11 of 16")
            live.refresh()
            seen = last_frame(console)
            assert seen.startswith(f"{what} ")
            assert " 75 %, 5:00 so far" in seen
            assert not any(other in seen for other in STEPS if other != what)
            assert ("1:40 left" in seen) == (width >= 40)
            assert ("cost 0.125" in seen) == (width >= 80)


def test_the_time_left_counts_down_between_reports_and_counts_what_was_done_here_alone() -> None:
    time = Time()
    running = Running(time)
    running("tuning", 0.5)
    assert running.step is not None
    assert running.step.state(10.0) == "50 %, 0:10 so far"
    time.now_s = 60.0
    running("tuning", 0.75, "cost 2")
    assert running.step.state(60.0) == "75 %, 1:00 so far, 1:00 left, cost 2"
    assert running.step.state(90.0) == "75 %, 1:30 so far, 0:30 left, cost 2"
    assert running.step.state(999.0) == "75 %, 16:39 so far, cost 2"


def test_a_pipe_gets_a_line_for_each_step_and_one_every_30_s() -> None:
    time, said = Time(), list[str]()
    lines = Lines(said.append, Running(time))
    lines.look()
    lines("recording", 0.0)
    lines("recording", 0.5)
    time.now_s = 3.0
    lines("tuning", 0.0)
    time.now_s = 3.0 + LINE_EVERY_S - 1.0
    lines("tuning", 0.25, "cost 2")
    lines.look()
    time.now_s += 1.0
    lines.look()
    lines.look()
    time.now_s += LINE_EVERY_S
    lines.look()
    assert said == [
        " 0:00  recording",
        " 0:03  tuning",
        " 0:33  tuning: 25 %, 0:30 so far, 1:26 left, cost 2",
        " 1:03  tuning: 25 %, 1:00 so far, 0:56 left, cost 2",
    ]


def test_nothing_that_a_terminal_would_obey_is_shown() -> None:
    said = list[str]()
    running = Running(Time())
    Lines(said.append, running)("\x1b[31mred.csv", 0.0, "\x07")
    console = terminal(80, 24)
    console.print(Frame(running))
    assert not any("\x1b[31m" in text or "\x07" in text for text in (*said, last_frame(console)))
