"""Ctrl-C and its like, while something must not be broken off."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def hold_back(*numbers: signal.Signals) -> Iterator[None]:
    """Hold signals back for what takes a second at most; what came counts afterwards.

    A process may receive a signal in any of its threads, but Python's main thread alone answers it, so in others
    there is nothing to hold back. A Ctrl-C while another one is obeyed already is that one, pressed again.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[int] = []
    before: dict[int, Any] = {number: signal.getsignal(number) for number in numbers}
    for number in before:
        signal.signal(number, lambda number, frame: came.append(number))
    try:
        yield
    finally:
        for number, handler in before.items():
            # None: not a handler of Python's, which cannot be put back.
            signal.signal(number, signal.SIG_DFL if handler is None else handler)
        counts = [number for number in came if number != signal.SIGINT or not _is_interrupted()]
        if counts:
            signal.raise_signal(counts[0])


def _is_interrupted() -> bool:
    """True while the caller cleans up after a Ctrl-C."""
    error = sys.exception()
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__context__
    return error is not None
