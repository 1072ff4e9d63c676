"""The queue of messages to one client of the board: a page, or a verb that runs for a page."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from typing import Any

from greywhale.dashboard.limits import SAMPLES

Message = dict[str, Any]


class Outbox:
    """Filled by the relay and emptied by the client's own sender, each in its own thread."""

    def __init__(self, notify: Callable[[bool], None], most_samples: int = SAMPLES.outbox) -> None:
        """`notify` is called from any thread when something waits that did not before: with True where it is urgent."""
        self._notify = notify
        self._samples: deque[bytes] = deque(maxlen=most_samples)
        self._answers: deque[bytes | Message] = deque(maxlen=SAMPLES.most_answers)
        self._lock = threading.Lock()

    def add_sample(self, frame: bytes) -> None:
        with self._lock:
            waiting = bool(self._samples)
            self._samples.append(frame)
        if not waiting:
            self._notify(False)

    def add_answer(self, answer: bytes | Message) -> None:
        with self._lock:
            self._answers.append(answer)
        self._notify(True)

    def take(self) -> tuple[list[bytes | Message], bytes]:
        """Answers in their order, and all samples in one piece."""
        with self._lock:
            answers, samples = list(self._answers), b"".join(self._samples)
            self._answers.clear()
            self._samples.clear()
        return answers, samples
