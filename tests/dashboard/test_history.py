"""The last samples, whole and in order, also beyond the ring's end and after a restart of the board."""

from __future__ import annotations

import pytest

from greywhale.dashboard.history import FRAME_BYTES, History


def frame(tick: int) -> bytes:
    return tick.to_bytes(4, "big") + bytes(FRAME_BYTES - 4)


def kept(history: History, since: int | None = None) -> list[int]:
    data = history.since(since)
    return [int.from_bytes(data[at : at + 4], "big") for at in range(0, len(data), FRAME_BYTES)]


@pytest.mark.parametrize("added", [0, 99, 100, 101, 250])
def test_the_newest_are_kept_in_order_and_told_from_a_tick_on(added: int) -> None:
    history, oldest = History(100), max(0, added - 100)
    for tick in range(added):
        history.add(tick, frame(tick))
    assert kept(history) == list(range(oldest, added))
    for since in (0, oldest, oldest + 40, added):
        assert kept(history, since) == list(range(max(since, oldest), added))


def test_a_tick_counts_from_the_last_restart() -> None:
    history = History(100)
    for tick in (*range(500, 530), *range(10), *range(3, 20, 2)):
        history.add(tick, frame(tick))
    assert kept(history, 0) == list(range(3, 20, 2))
    assert kept(history, 8) == list(range(9, 20, 2))
    assert kept(history)[:30] == list(range(500, 530))
