"""The board's port: taken when it comes, told when it goes, taken again, given up to a stop from another terminal."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import ExitStack

import pytest

from greywhale.base.errors import UserError
from greywhale.board.device import Device
from greywhale.board.session import ask_to_stop
from greywhale.dashboard.client import Client
from greywhale.dashboard.history import History
from greywhale.dashboard.limits import BOARD
from greywhale.dashboard.outbox import Outbox
from greywhale.dashboard.port_holder import STOPPED, PortHolder
from greywhale.dashboard.relay import Relay
from greywhale.protocol import schema
from greywhale.protocol.lines import open_line
from tests.board.fake_board import FakeBoard, Faults
from tests.board.port_board import PortBoard


class Told:
    """A page that notes what it is told of the board, and does something after so many samples."""

    def __init__(self, relay: Relay, after: int = 0, do: Callable[[], object] = lambda: None) -> None:
        self.client = Client(Outbox(self._look))
        self.sentences: list[str] = []
        self.samples = 0
        self._after, self._do = after, do
        relay.join(self.client)
        self.client.every = 1

    def _look(self, urgent: bool) -> None:
        answers, samples = self.client.outbox.take()
        for answer in answers:
            if isinstance(answer, dict) and answer["kind"] == "link":
                self.sentences.append(f"open {answer['port']}" if answer["open"] else answer["sentence"])
        had, self.samples = self.samples, self.samples + samples.count(0)
        if had < self._after <= self.samples:
            self._do()


@pytest.fixture
def relay() -> Relay:
    return Relay(History(10_000))


def chooser(*ports: str | None) -> Callable[[str | None], str]:
    """Finds these ports one after the other; None is none."""
    left = list(ports)

    def choose(named: str | None) -> str:
        port = left.pop(0)
        if port is None:
            raise UserError("no board was found on any serial port; plug it in.")
        return port

    return choose


def test_a_board_is_taken_when_it_comes_and_again_after_it_went(relay: Relay) -> None:
    with FakeBoard(Faults(unplug_at=200)) as first, FakeBoard() as second:
        holder = PortHolder(relay, None, chooser(None, first.port, None, second.port))
        page = Told(relay, 400, holder.end)
        assert [holder.hold() for _ in range(4)] == [BOARD.look_again_s] * 4
    nothing = "No board was found on any serial port; plug it in."
    assert page.sentences == [
        "",
        nothing,
        f"open {first.port}",
        f"{first.port}: the port went away in the middle; check the cable and try again.".capitalize(),
        nothing,
        f"open {second.port}",
        "",
    ]
    assert page.samples >= 400


def test_a_board_that_is_no_greywhale_is_told_and_asked_again_later(relay: Relay) -> None:
    with FakeBoard(Faults(silent=True)) as board:
        assert PortHolder(relay, board.port).hold() == BOARD.ask_again_s
    assert "the board has probably no greywhale firmware: flash it" in relay.link["sentence"]
    assert (relay.link["open"], relay.link["unflashed"]) == (False, True)


def test_a_board_that_falls_silent_is_given_up(relay: Relay) -> None:
    with FakeBoard(Faults(stop_sampling_at=300)) as board:
        assert PortHolder(relay, board.port).hold() == BOARD.ask_again_s
        assert board.asked(schema.TelemetryRequest) == 3, "once more before it is given up, and off"
    assert "the board fell silent" in relay.link["sentence"]
    assert not relay.link["unflashed"], "it had answered"


@pytest.mark.slow
def test_a_stop_from_another_terminal_turns_the_motors_off_and_is_told(relay: Relay) -> None:
    there = threading.Event()
    with ExitStack() as stack:
        board = stack.enter_context(PortBoard())
        holder = PortHolder(relay, board.port)
        page = Told(relay, 1, there.set)
        stack.callback(holder.close)
        holder.start()
        assert there.wait(60)
        answer = ask_to_stop(board.port, wait_for_end=True)
    assert answer is not None
    assert (answer["state"], answer["goes_on"]) == ("disabled", True)
    assert board.asked(schema.StopRequest) > 0
    assert page.sentences[:3] == ["", f"open {board.port}", STOPPED]


def test_a_port_is_lent_out_whole_and_taken_again(relay: Relay) -> None:
    seen = threading.Semaphore(0)
    with FakeBoard() as board, ExitStack() as stack:
        holder = PortHolder(relay, board.port)
        page = Told(relay, 1, seen.release)
        stack.callback(holder.close)
        holder.start()
        assert seen.acquire(timeout=60)
        with holder.away("`greywhale flash` has the port.") as port:
            assert port == board.port
            assert not relay.link["open"]
            with Device(port) as device:
                assert device.restarted
            Told(relay, 1, seen.release)
        assert seen.acquire(timeout=60)
    away = f"open {board.port}"
    assert page.sentences == ["", away, "`greywhale flash` has the port.", away, ""]


def test_a_board_that_no_firmware_answers_on_can_be_flashed_too(relay: Relay) -> None:
    with FakeBoard(Faults(silent=True)) as board, ExitStack() as stack:
        holder = PortHolder(relay, board.port)
        stack.callback(holder.close)
        holder.start()
        with holder.away("`greywhale flash` has the port.") as port:
            assert relay.link["sentence"] == "`greywhale flash` has the port."
            assert relay.link["unflashed"]
            assert open_line(port).read() == b""
