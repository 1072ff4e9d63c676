"""A signal that comes at a bad moment is held back, never lost: with real signals to this process itself."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress

import pytest

from greywhale.base.interrupts import hold_back
from greywhale.board.device import hold_ctrl_c


class EndedError(Exception):
    """Raised by SIGTERM here, as in the command line."""


@pytest.fixture(autouse=True)
def handlers() -> Iterator[None]:
    def end(number: int, frame: object) -> None:
        raise EndedError

    before = signal.signal(signal.SIGINT, signal.default_int_handler), signal.signal(signal.SIGTERM, end)
    yield
    signal.signal(signal.SIGINT, before[0])
    signal.signal(signal.SIGTERM, before[1])


def press(number: signal.Signals = signal.SIGINT) -> None:
    os.kill(os.getpid(), number)


def from_another_thread() -> None:
    thread = threading.Thread(target=press)
    thread.start()
    thread.join()


def storm() -> None:
    for _ in range(50):
        press()


@pytest.mark.parametrize("come", [press, from_another_thread, storm])
def test_ctrl_c_comes_after_what_it_must_not_break_off(come: Callable[[], None]) -> None:
    done = []
    with pytest.raises(KeyboardInterrupt):
        with hold_ctrl_c():
            come()
            done.append("all")
        done.append("more")
    assert done == ["all"]
    with pytest.raises(KeyboardInterrupt):
        press()


def test_one_inside_another_holds_it_until_the_outer_one_ends() -> None:
    done = []
    with pytest.raises(KeyboardInterrupt):
        with hold_ctrl_c():
            with hold_back(signal.SIGINT, signal.SIGTERM):
                press()
            done.append("outer")
        done.append("more")
    assert done == ["outer"]


@pytest.mark.parametrize(("number", "error"), [(signal.SIGINT, KeyboardInterrupt), (signal.SIGTERM, EndedError)])
def test_each_signal_keeps_its_meaning(number: signal.Signals, error: type[BaseException]) -> None:
    with pytest.raises(error), hold_back(signal.SIGINT, signal.SIGTERM):
        press(number)


def test_what_is_ignored_stays_ignored_and_what_does_not_come_does_nothing() -> None:
    with hold_ctrl_c():
        pass
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with hold_ctrl_c():
        press()
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN


@pytest.mark.parametrize("between", [None, ValueError])
def test_a_second_ctrl_c_does_not_break_off_the_clean_up_after_the_first(between: type[Exception] | None) -> None:
    done = []
    with pytest.raises(KeyboardInterrupt):
        try:
            press()
        finally:
            with suppress(ValueError):
                try:
                    if between is not None:
                        raise between
                finally:
                    with hold_ctrl_c():
                        press()
            done.append("written")
    assert done == ["written"]


def test_after_an_error_it_still_counts() -> None:
    with pytest.raises(KeyboardInterrupt):
        try:
            raise ValueError
        except ValueError:
            with hold_ctrl_c():
                press()


def test_in_another_thread_it_reaches_the_main_one_at_once() -> None:
    inside, leave = threading.Event(), threading.Event()

    def work() -> str:
        with hold_ctrl_c():
            inside.set()
            leave.wait()
        return "all"

    with ThreadPoolExecutor(1) as pool:
        working = pool.submit(work)
        inside.wait()
        with pytest.raises(KeyboardInterrupt):
            press()
        leave.set()
        assert working.result() == "all"
