"""A verb that runs is always listed, has the board alone, and ends with its page, also in the page's last moment."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from greywhale.base import processes
from greywhale.base.errors import UserError
from greywhale.dashboard.jobs import Jobs
from greywhale.dashboard.limits import JOBS
from greywhale.dashboard.relay import Relay
from greywhale.protocol import schema
from tests.dashboard.shared import Desk, Shared

# A verb that waits for a line where it has the board's, and else has nothing to do.
WAITS = [sys.executable, "-c", "import sys; sys.argv[2] == '-' or input(); print('{}')"]


def test_a_verb_that_runs_is_seen_stopped_and_alone_after_sixty_others(shared: Shared, tmp_path: Path) -> None:
    desk = Desk(shared, tmp_path, WAITS)
    with closing(desk.jobs):
        id = desk.start("record")
        others = []
        for _ in range(60):
            others.append(desk.start("evaluate", logs=["log.csv"]))
            assert desk.wait(others[-1])["state"] == "done"
        assert [one["id"] for one in desk.jobs.facts()] == [id, *others[1 - JOBS.most_kept :]]
        with pytest.raises(UserError, match="another verb uses the board"):
            desk.start("info")
        desk.jobs.stop(id)
        assert desk.wait(id)["state"] == "stopped"
        desk.start("info")


SAYS_NOTHING = {
    "begins": "import time; time.sleep(3600)",  # Ctrl-C ends it as any program of Python
    "ends at once": "import signal; signal.signal(signal.SIGINT, signal.SIG_DFL); signal.pause()",
    "ends as if nothing had been": "import signal; signal.signal(signal.SIGINT, lambda *_: exit(0)); signal.pause()",
    "has begun its answer": "print('{', end='', flush=True); import signal; signal.pause()",
}


@pytest.mark.parametrize("program", SAYS_NOTHING.values(), ids=SAYS_NOTHING)
def test_a_verb_that_was_stopped_and_says_nothing_was_stopped(shared: Shared, tmp_path: Path, program: str) -> None:
    desk = Desk(shared, tmp_path, [sys.executable, "-c", program])
    with closing(desk.jobs):
        id = desk.start("record")
        desk.jobs.stop(id)
        job = desk.wait(id)
    assert (job["state"], job["error"]) == ("stopped", "record was stopped before it had an answer.")


@pytest.mark.parametrize("said", ["", "{", "no JSON"])
def test_a_verb_that_ends_by_itself_without_an_answer_has_failed(shared: Shared, tmp_path: Path, said: str) -> None:
    desk = Desk(shared, tmp_path, [sys.executable, "-c", f"print({said!r}, end=''); exit(3)"])
    with closing(desk.jobs):
        job = desk.run("record")
    assert (job["state"], job["result"]) == ("failed", None)
    assert job["error"] == "record ended without an answer (exit code 3)."


def test_a_verb_gets_no_board_that_another_has(shared: Shared, tmp_path: Path) -> None:
    desk = Desk(shared, tmp_path, WAITS)
    with closing(desk.jobs):
        desk.start("record")
        with pytest.raises(UserError, match="another verb uses the board"):
            Desk.start(desk_beside(desk, tmp_path), "record")


def desk_beside(desk: Desk, folder: Path) -> Desk:
    """Jobs that know nothing of the others', for the same page."""
    beside = Desk(desk.shared, folder, WAITS)
    beside.page = desk.page
    return beside


STEPS: dict[str, tuple[object, str, bool]] = {
    "its arguments are read": (Jobs, "verbs", False),
    "it is let in": (Jobs, "_require_board", False),
    "it was let in": (Jobs, "_require_board", True),
    "it gets the board": (Relay, "join", False),
    "it has the board": (Relay, "join", True),
    "its process begins": (processes, "start", False),
    "its process has begun": (processes, "start", True),
    "it is listed": (Jobs, "_keep", False),
    "it has been listed": (Jobs, "_keep", True),
}


def meanwhile(monkeypatch: pytest.MonkeyPatch, step: str, act: Callable[[], object]) -> None:
    """Do something once at this step of a verb's start."""
    owner, name, after = STEPS[step]
    real, left = getattr(owner, name), [act]

    def wrapped(*given: Any, **named: Any) -> Any:
        if not after and left:
            left.pop()()
        result = real(*given, **named)
        if after and left:
            left.pop()()
        return result

    monkeypatch.setattr(owner, name, wrapped)


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize(
    "how", ["is closed", "lets go", "is stopped", "is stopped by a watcher", "is stopped at a terminal"]
)
def test_no_verb_outlives_its_page_or_a_stop_whenever_they_come(
    shared: Shared, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: str, how: str
) -> None:
    desk, watcher = Desk(shared, tmp_path, WAITS), shared.page(0)
    acts: dict[str, Callable[[], object]] = {
        "is closed": lambda: shared.relay.leave(desk.page.client),
        "lets go": lambda: shared.relay.release(desk.page.client),
        "is stopped": lambda: desk.page.ask(schema.StopRequest()),
        "is stopped by a watcher": lambda: watcher.ask(schema.StopRequest()),
        "is stopped at a terminal": lambda: shared.relay.stopped("with `greywhale stop` in another terminal"),
    }
    with closing(desk.jobs):
        with monkeypatch.context() as patched, contextlib.suppress(UserError):
            meanwhile(patched, step, acts[how])
            id = desk.start("record")
            assert desk.wait(id)["state"] == "stopped"
        assert not [one for one in desk.jobs.facts() if one["state"] == "running"]
        shared.relay.release(desk.page.client)
        shared.relay.drive(watcher.client)
        desk.page = watcher
        desk.start("record")


def test_a_server_that_ends_while_a_verb_begins_leaves_none_running(
    shared: Shared, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    desk = Desk(shared, tmp_path, WAITS)
    meanwhile(monkeypatch, "its arguments are read", desk.jobs.close)
    with pytest.raises(UserError, match="the dashboard ends"):
        desk.start("record")


def test_a_verb_whose_process_cannot_begin_leaves_the_board_free(
    shared: Shared, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    desk = Desk(shared, tmp_path, WAITS)

    def fail() -> None:
        raise OSError(12, "Cannot allocate memory")

    with closing(desk.jobs):
        with monkeypatch.context() as patched:
            meanwhile(patched, "its process begins", fail)
            with pytest.raises(OSError, match="memory"):
                desk.start("record")
        desk.start("record")
