"""The verbs that run for pages: which there are, who may start one, and who is told how it goes."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, ExitStack
from typing import Any, TypedDict

from greywhale.base import system
from greywhale.base.errors import BadUsage, UserError, cut
from greywhale.dashboard import arm_answers
from greywhale.dashboard.folder import Folder
from greywhale.dashboard.job import Facts, Job, Lent, Taken
from greywhale.dashboard.limits import JOBS
from greywhale.dashboard.relay import Relay, Wish
from greywhale.dashboard.verbs import VerbFacts, command_line


class Listed(TypedDict):
    verbs: list[VerbFacts]
    jobs: list[Facts]


class Jobs:
    """Any thread may call it. `listeners` are called with a job's facts after each change, in the job's thread."""

    def __init__(
        self,
        relay: Relay,
        folder: Folder,
        catalogue: Callable[[], list[VerbFacts]],
        program: Sequence[str],
        away: Callable[[str], AbstractContextManager[str]],
    ) -> None:
        """`catalogue` tells the verbs there are, and may take seconds; `program` runs one as `Job` says; `away` frees
        the board's port (`PortHolder.away`).
        """
        self._relay = relay
        self._folder = folder
        self._catalogue = catalogue
        self._program = program
        self._away = away
        self._verbs: list[VerbFacts] = []
        self._jobs: list[Job] = []
        self._closed = False
        self._lock, self._asking = threading.Lock(), threading.Lock()
        self.listeners: list[Callable[[Facts], None]] = []

    def listed(self) -> Listed:
        """The verbs, and the jobs so far, oldest first."""
        return {"verbs": self.verbs(), "jobs": self.facts()}

    def facts(self) -> list[Facts]:
        return [job.facts for job in self._jobs]

    def verbs(self) -> list[VerbFacts]:
        """The verbs of the command line; it is asked once."""
        with self._asking:
            self._verbs = self._verbs or self._catalogue()
            return self._verbs

    def start(self, asked: dict[str, Any], page: str) -> Facts:
        """Start a verb for a page: {"verb": ..., "arguments": {...}}."""
        wish = self._relay.wish(page)  # a stop while the rest is done comes after it
        name, arguments = asked.get("verb"), asked.get("arguments", {})
        verb = next((one for one in self.verbs() if one["verb"] == name), None)
        if verb is None or not isinstance(arguments, dict):
            names = ", ".join(one["verb"] for one in self.verbs())
            said = cut(repr(name)) if isinstance(name, str) else "what is no text"
            raise BadUsage(f"{said} is no verb of a page; there are: {names}.")
        if not system.HANDS_DOWN_DESCRIPTORS:
            raise UserError(f"a page starts no verbs on Windows; run `greywhale {name}` in a terminal.")
        arguments = arm_answers.in_a_file(verb, arguments, self._folder)
        words = command_line(verb, arguments, self._folder)
        with self._lock, ExitStack() as failed:
            if self._closed:
                raise UserError("the dashboard ends; start it again.")
            if sum(job.running for job in self._jobs) >= JOBS.most_running:
                raise UserError(f"{JOBS.most_running} verbs are running; wait for the end of one, or stop it.")
            board: Lent | Taken | None = None
            if verb["board"] != "none":
                self._require_board(wish, there=verb["board"] == "lent")
                board = Lent(self._relay.link["port"], self._relay, wish)
            if verb["board"] == "taken":
                freed = failed.enter_context(ExitStack())
                port = freed.enter_context(self._away(f"`greywhale {verb['verb']}` has the port."))
                board = Taken(port, freed.close)
            options = [*(["--port", board.port] if board else []), "--json"]
            line = [*words[: words.index("--")], *options, *words[words.index("--") :]]
            job = Job(self._program, verb["verb"], line, arguments, self._folder.path, self._tell, board)
            failed.pop_all()
            self._keep(job)
        return job.facts

    def stop(self, id: str) -> Facts:
        job = self._find(id)
        job.stop()
        return job.facts

    def put_away(self, id: str) -> dict[str, Any]:
        """Forget a job that has ended: no page shows it any more."""
        with self._lock:
            job = self._find(id)
            if job.running:
                raise UserError(f"{job.facts['verb']} still runs; stop it first.")
            self._jobs.remove(job)
        for listener in list(self.listeners):
            listener({**job.facts, "kind": "gone"})
        return {}

    def say(self, id: str, line: object) -> Facts:
        job = self._find(id)
        if not isinstance(line, str) or len(line) > 200:
            raise BadUsage("line must be a short text.")
        job.say(line)
        return job.facts

    def close(self) -> None:
        """End all that runs, and wait for it; nothing begins any more."""
        with self._lock:
            self._closed = True
        for job in self._jobs:
            job.stop()
        for job in self._jobs:
            job.join()

    def _keep(self, job: Job) -> None:
        """List a job; of the others the oldest that have ended are forgotten."""
        ended = [one for one in self._jobs if not one.running]
        forgotten = ended[: max(0, len(self._jobs) + 1 - JOBS.most_kept)]
        self._jobs = [*(one for one in self._jobs if one not in forgotten), job]

    def _require_board(self, wish: Wish, there: bool) -> None:
        """Refuse a verb that uses the board, where it is to be `there`, or where others have it."""
        if there and not self._relay.link["open"]:
            raise UserError(self._relay.link["sentence"] or "no board is there yet.")
        if any(job.running and job.board for job in self._jobs):
            raise UserError("another verb uses the board; wait for its end, or stop it.")
        self._relay.require(wish)

    def _find(self, id: str) -> Job:
        job = next((one for one in self._jobs if one.facts["id"] == id), None)
        if job is None:
            raise BadUsage(f"{cut(repr(id))} is no job of this dashboard.")
        return job

    def _tell(self, job: Job) -> None:
        for listener in list(self.listeners):
            listener(job.facts)
