"""The progress bar: on a terminal it shows how far, how long still and how good; elsewhere nothing."""

from __future__ import annotations

import contextlib
import os
import pty
import sys

import pytest

from greywhale.cli.output import progress


def everything(seen: int) -> str:
    """What was written to a terminal whose other end is closed by now; it comes in pieces of any size."""
    text = b""
    with contextlib.suppress(OSError):  # nothing more to come
        while piece := os.read(seen, 65536):
            text += piece
    os.close(seen)
    return text.decode()


def test_a_terminal_sees_the_share_done_the_time_left_and_the_note(monkeypatch: pytest.MonkeyPatch) -> None:
    seen, inner = pty.openpty()
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setenv("TERM", "xterm")
    with os.fdopen(inner, "w", encoding="utf-8") as terminal:
        monkeypatch.setattr(sys, "stderr", terminal)
        with progress(as_json=False) as report:
            assert report is not None
            report("tuning", 0.25, "cost 0.125")
            report("tuning", 0.5, "cost 0.0625")
        with progress(as_json=True) as report:
            assert report is None
    text = everything(seen)
    for words in ("tuning", "50 %", " left", "cost 0.0625"):
        assert words in text


def test_a_pipe_sees_none(monkeypatch: pytest.MonkeyPatch) -> None:
    with open(os.devnull, "w", encoding="utf-8") as nowhere:
        monkeypatch.setattr(sys, "stderr", nowhere)
        with progress(as_json=False) as report:
            assert report is None
