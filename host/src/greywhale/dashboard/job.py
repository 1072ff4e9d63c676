"""One verb that runs for a page: a process of its own, as in a terminal, whose output is told while it runs.

A thread reads what the process says, and passes the frames of a board that is lent to it.
"""

from __future__ import annotations

import contextlib
import json
import os
import secrets
import selectors
import signal
import socket
import subprocess
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, TypedDict

from greywhale.base import processes
from greywhale.base.errors import INTERRUPTED, printable
from greywhale.base.telling import Telling
from greywhale.board.refusal import upper_first
from greywhale.dashboard.client import Client
from greywhale.dashboard.lending import LentEnd
from greywhale.dashboard.limits import JOBS, SAMPLES
from greywhale.dashboard.outbox import Outbox
from greywhale.dashboard.relay import Relay, Wish
from greywhale.protocol.socket_line import PIECE_BYTES


@dataclass(frozen=True)
class Lent:
    """A board whose line the server lends to a verb, for a page that wished it."""

    port: str
    relay: Relay
    wish: Wish


@dataclass(frozen=True)
class Taken:
    """A port that a verb has itself; `give_back` is called when it has ended."""

    port: str
    give_back: Callable[[], None]


class ProgressFacts(TypedDict):
    text: str  # the step that is done now
    done: float
    total: float
    note: str  # such as the best cost so far; "" for none


class Facts(TypedDict):
    """The facts of a job that pages get, again and again."""

    kind: Literal["job", "gone"]  # gone: put away
    id: str
    verb: str
    arguments: dict[str, Any]
    state: Literal["running", "done", "failed", "stopped"]
    progress: ProgressFacts | None
    countdown: int  # seconds until the arm moves; 0: it is not counted
    telling: Annotated[dict[str, Any], Telling] | None  # the result for people, as `base.telling` has it
    result: Any  # what the verb prints with --json
    error: str | None  # one sentence
    exit_code: int | None
    said: list[str]  # lines on its standard error


class Job:
    """Starts at once; `changed` is called in the job's thread, first and after every change of `facts`."""

    def __init__(
        self,
        program: Sequence[str],
        verb: str,
        words: Sequence[str],
        arguments: dict[str, Any],
        folder: Path,
        changed: Callable[[Job], None],
        board: Lent | Taken | None = None,
    ) -> None:
        """`program` takes two descriptors, a port and the verb's words; `board` is how the verb uses a board."""
        self.facts: Facts = {
            "kind": "job", "id": secrets.token_hex(4), "verb": verb, "arguments": arguments, "state": "running",
            "progress": None, "countdown": 0, "telling": None, "result": None, "error": None, "exit_code": None,
            "said": [],
        }  # fmt: skip
        self.board = board
        self._changed = changed
        self._printed = bytearray()
        self._rests: dict[str, bytes] = {"progress": b"", "said": b""}
        self._kill_at: float | None = None
        self._wake_out, self._wake_in = socket.socketpair()
        self._wake_in.setblocking(False)
        self._line: LentEnd | None = None
        self._guard = threading.Lock()  # a stop may come before there is a process
        self._started = self._stopping = False
        self._why = ""
        with contextlib.ExitStack() as handed:
            progress = self._start(program, words, folder, handed)
        self._thread = threading.Thread(target=self._run, args=(progress,), name="greywhale-job", daemon=True)
        self._thread.start()

    def _start(
        self,
        program: Sequence[str],
        words: Sequence[str],
        folder: Path,
        handed: contextlib.ExitStack,
    ) -> int:
        """Start the process; where its progress is read. `handed` closes here what the process has then."""
        port, line = "-", "-"
        descriptors = []
        with contextlib.ExitStack() as failed:
            failed.callback(self._wake_out.close)
            failed.callback(self._wake_in.close)
            if isinstance(self.board, Lent):
                port = self.board.port
                own, theirs = socket.socketpair()
                handed.callback(theirs.close)
                failed.callback(own.close)
                descriptors.append(theirs.fileno())
                line = str(theirs.fileno())
                client = Client(Outbox(self._wake, SAMPLES.lent), self.facts["verb"], self.facts["id"], self._interrupt)
                # From now on a stop, or the page's end, is heard.
                self._line = LentEnd(self.board.relay, own, client, self.board.wish)
                failed.callback(self._line.close)
            progress, reports = os.pipe()
            handed.callback(os.close, reports)
            failed.callback(os.close, progress)
            self._process = processes.start(
                [*program, str(reports), line, port, *words],
                cwd=folder,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                pass_fds=[*descriptors, reports],
                start_new_session=True,  # Ctrl-C in the server's terminal ends it through the server
            )
            failed.pop_all()
        with self._guard:
            self._started = True
            if self._stopping:
                self._process.send_signal(signal.SIGINT)
        return progress

    @property
    def running(self) -> bool:
        return self.facts["state"] == "running"

    def stop(self) -> None:
        """As Ctrl-C in a terminal; by force where that does not end it."""
        if self._line is not None:
            self._line.forbid()
        self._interrupt("")

    def _interrupt(self, why: str) -> None:
        with self._guard:
            self._why = self._why or why
            self._stopping = True
            if self._started and self.running:
                self._process.send_signal(signal.SIGINT)
            self._kill_at = self._kill_at or time.monotonic() + JOBS.end_wait_s
        self._wake()

    def say(self, line: str) -> None:
        """Write a line to its standard input."""
        assert self._process.stdin is not None
        with contextlib.suppress(OSError, ValueError):  # it has ended
            self._process.stdin.write(printable(line).replace("\n", " ").encode() + b"\n")
            self._process.stdin.flush()

    def join(self) -> None:
        self._thread.join()

    def _wake(self, urgent: bool = True) -> None:
        with contextlib.suppress(OSError):  # awake already, or at its end
            self._wake_in.send(b"w")

    def _run(self, progress: int) -> None:
        self._changed(self)  # a verb may say nothing for seconds
        assert self._process.stdout is not None
        assert self._process.stderr is not None
        open_pipes = {
            self._process.stdout.fileno(): self._printed.extend,
            self._process.stderr.fileno(): self._take_said,
            progress: self._take_told,
        }
        with selectors.DefaultSelector() as selector:
            for descriptor in (*open_pipes, self._wake_out.fileno()):
                selector.register(descriptor, selectors.EVENT_READ)
            if self._line is not None:
                self._line.register(selector)
            while open_pipes:
                for key, events in selector.select(self._patience_s()):
                    if key.fd == self._wake_out.fileno():
                        self._wake_out.recv(PIECE_BYTES)
                    elif key.fd in open_pipes:
                        data = os.read(key.fd, PIECE_BYTES)
                        if data:
                            open_pipes[key.fd](data)
                        else:
                            selector.unregister(key.fd)
                            del open_pipes[key.fd]
                    elif self._line is not None:
                        self._line.serve(selector, events)
                if self._line is not None:
                    self._line.pass_on(selector)
        os.close(progress)
        self._end()

    def _patience_s(self) -> float | None:
        """The time to wait for something to read (s), None for ever; kills a verb that was stopped too long ago."""
        if self._kill_at is None:
            return None
        left_s = self._kill_at - time.monotonic()
        if left_s <= 0.0:
            self._process.kill()
        return max(left_s, 0.1)

    def _take_said(self, data: bytes) -> None:
        said = [printable(line) for line in self._lines("said", data)]
        self.facts["said"] = [*self.facts["said"], *said][-JOBS.most_said_lines :]
        self._changed(self)

    def _take_told(self, data: bytes) -> None:
        """Take the facts that `greywhale.cli.job` sends."""
        lines = self._lines("progress", data)
        for line in lines:
            self.facts.update(json.loads(line))
        if lines:
            self._changed(self)

    def _lines(self, name: str, data: bytes) -> list[str]:
        *whole, self._rests[name] = (self._rests[name] + data).split(b"\n")
        return [line.decode("utf-8", "replace") for line in whole]

    def _end(self) -> None:
        """Tell how it ended; motors that may run for it are off before."""
        code = self._process.wait()
        if self._line is not None:
            self._line.close()
        if isinstance(self.board, Taken):
            self.board.give_back()
        for pipe in (self._process.stdin, self._process.stdout, self._process.stderr):
            assert pipe is not None
            with contextlib.suppress(OSError):
                pipe.close()
        self._wake_out.close()
        self._wake_in.close()
        stopped = self._stopping or code in (INTERRUPTED, -signal.SIGINT)
        try:
            answer = json.loads(self._printed)
        except ValueError:
            how = "was stopped before it had an answer" if stopped else f"ended without an answer (exit code {code})"
            answer = {"error": f"{self.facts['verb']} {how}.", "exit_code": code}
        failed = isinstance(answer, dict) and "exit_code" in answer and "error" in answer
        self.facts["exit_code"], self.facts["countdown"] = code, 0
        self.facts["error"] = self._with_reason(answer["error"]) if failed else None
        self.facts["result"] = None if failed else answer
        self.facts["state"] = ("stopped" if stopped else "failed") if failed else "done"
        self._changed(self)

    def _with_reason(self, error: str) -> str:
        """A verb's last words, after who stopped it; one that was stopped while Python began has none."""
        return " ".join([self._why, *([upper_first(error)] if self._printed else [])]) if self._why else error
