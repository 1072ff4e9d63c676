"""After a stop from a page or a terminal no motor starts until a person asks anew, whatever runs and in any phase."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.board.session import Session
from greywhale.dashboard.client import Client
from greywhale.dashboard.history import History
from greywhale.dashboard.limits import BOARD
from greywhale.dashboard.outbox import Outbox
from greywhale.dashboard.port_holder import PortHolder
from greywhale.dashboard.relay import Relay
from greywhale.protocol import schema
from greywhale.protocol.declared import Message
from greywhale.protocol.frames import encode_frame
from tests.board.fake_board import FakeBoard
from tests.dashboard.shared import Desk, Shared, Viewer, living

STARTS = (schema.EnableRequest(0), schema.LeadRequest(100))
AGAIN = "start the verb again when the arm may move."


def on(viewer: Viewer) -> bool:
    """True if any sample since the last look says that the motors run."""
    return any(one.state not in (schema.State.DISABLED, schema.State.FAULT) for one in viewer.samples())


def begun(viewer: Viewer) -> int:
    """The number of times that the motors were started since the last look."""
    states = [one.state in (schema.State.DISABLED, schema.State.FAULT) for one in viewer.samples()]
    return sum(off and not after for off, after in zip([True, *states], states, strict=False))


def driving(shared: Shared) -> Viewer:
    page = shared.page()
    shared.relay.drive(page.client)
    return page


def verb_of(shared: Shared, page: Viewer) -> Viewer:
    verb = Viewer(shared, "record")
    shared.relay.join(verb.client, shared.relay.wish(page.client.id))
    return verb


@pytest.mark.parametrize("motors", ["off", "on"])
@pytest.mark.parametrize("who", ["the page that drives", "a page that watches"])
def test_a_verb_that_a_page_stopped_starts_no_motor_any_more(shared: Shared, who: str, motors: str) -> None:
    driver, watcher = driving(shared), shared.page()
    verb = verb_of(shared, driver)
    if motors == "on":
        verb.ask(STARTS[0])
    shared.live(0.2)
    assert on(watcher) is (motors == "on")
    page = driver if "drives" in who else watcher
    stop = page.ask(schema.StopRequest())
    shared.live(0.05)
    assert (schema.StopReply.TYPE, stop) in [(one.type, one.seq) for one in page.answers()]
    assert verb.ended == [f"Stopped from {who}: {AGAIN}"]
    told = [bool(one.words("stopped")) for one in (driver, watcher)]
    assert told == [page is watcher, page is driver], "all pages but the one that stopped it"
    watcher.raw()
    verb.answers()
    for request in 5 * STARTS:
        verb.ask(request)
        shared.live(0.3)
    assert not on(watcher)
    assert verb.answers() == []


def test_the_firmware_starts_motors_for_nothing_else_that_is_asked(shared: Shared) -> None:
    """So whatever a verb does between its motions, what the relay refuses after a stop is all that could start them."""
    driver, watcher = driving(shared), shared.page()
    starts: set[type[Message]] = set()
    for request in (one for one in schema.MESSAGES if not one.TYPE & schema.REPLY_BIT):
        for number in (0, 100):  # in its first field, such as a lease
            payload = number.to_bytes(request.SIZE, "little") if request.SIZE else b""
            seq = driver.ask(schema.StopRequest())
            shared.live(0.05, here=driver)
            watcher.raw()
            shared.relay.receive(driver.client, encode_frame(request.TYPE, seq + 1, payload))
            shared.live(0.1, here=driver)
            if on(watcher):
                starts.add(request)
    assert starts == set(map(type, STARTS))


def test_the_next_verb_that_a_person_starts_may_start_the_motors(shared: Shared) -> None:
    driver = driving(shared)
    first = verb_of(shared, driver)
    driver.ask(schema.StopRequest())
    shared.relay.leave(first.client)
    second = verb_of(shared, driver)
    second.ask(STARTS[0])
    shared.live(0.2)
    assert on(driver)
    assert second.ended == []


@pytest.mark.parametrize("how", ["it ends", "its page lets go"])
def test_motors_go_off_at_once_with_the_verb_that_started_them(shared: Shared, how: str) -> None:
    driver, watcher = driving(shared), shared.page()
    verb = verb_of(shared, driver)
    verb.ask(STARTS[0])
    shared.live(0.2)
    assert on(watcher)
    if how == "it ends":
        shared.relay.leave(verb.client)
    else:
        shared.relay.release(driver.client)
    shared.live(0.05)
    watcher.raw()
    shared.live(0.05)
    assert not on(watcher)


def test_a_verb_whose_motors_rest_and_that_nobody_stopped_goes_on(shared: Shared) -> None:
    driver = driving(shared)
    verb = verb_of(shared, driver)
    verb.ask(schema.StopRequest())  # its own, between two motions
    shared.live(2.0)
    verb.ask(STARTS[0])
    shared.live(0.2)
    assert on(driver)
    assert verb.ended == []


def test_a_verb_that_goes_on_hears_of_the_stop_again_but_one_that_ends_does_not(shared: Shared) -> None:
    driver = driving(shared)
    verb = verb_of(shared, driver)
    for _ in range(3):  # a key that is held down
        driver.ask(schema.StopRequest())
    verb.ask(STARTS[0])  # it was on its way
    assert len(verb.ended) == 1
    verb.ask(STARTS[0])
    assert len(verb.ended) == 2


def test_a_verb_that_was_asked_for_before_a_stop_does_not_begin(shared: Shared) -> None:
    driver, watcher = driving(shared), shared.page()
    wish = shared.relay.wish(driver.client.id)
    watcher.ask(schema.StopRequest())
    with pytest.raises(UserError, match="a stop came while the verb began; start the verb again"):
        shared.relay.join(Viewer(shared, "record").client, wish)
    verb_of(shared, driver)


def test_a_verb_is_stopped_by_its_page_also_while_no_board_is_there(shared: Shared) -> None:
    driver = driving(shared)
    verb = verb_of(shared, driver)
    shared.relay.close("", "It was unplugged.")
    driver.ask(schema.StopRequest())
    assert verb.ended == [f"Stopped from the page that drives: {AGAIN}"]
    assert driver.words("refused")[-1]["sentence"] == "It was unplugged."


@pytest.mark.parametrize("request_", STARTS, ids=["enable", "lead"])
def test_what_a_page_repeats_is_refused_after_a_stop_and_what_it_asks_anew_is_not(
    shared: Shared, request_: schema.EnableRequest | schema.LeadRequest
) -> None:
    driver, watcher = driving(shared), shared.page()
    for _ in range(2):  # its numbers go around
        seq = driver.ask(request_)
        driver.ask(request_, seq)
        shared.live(0.1, here=driver)
        assert on(watcher)
        driver.ask(schema.StatusRequest())
        watcher.ask(schema.StopRequest())
        shared.live(0.05, here=driver)
        watcher.raw()
        driver.ask(request_, seq)
        assert driver.words("refused")[-1]["sentence"].startswith("A stop came after this")
        shared.live(0.1, here=driver)
        assert not on(watcher)
        for _ in range(250):
            driver.ask(schema.TelemetryRequest(1))


@pytest.mark.parametrize("motors", ["off", "on"])
def test_a_stop_from_a_terminal_ends_the_verb_and_lets_no_start_through(motors: str) -> None:
    relay, ended = Relay(History(10_000)), list[str]()
    verb = Client(Outbox(lambda urgent: None), "record", end=ended.append)
    steps: dict[int, Callable[[], None]] = {}  # what happens after so many samples

    def look(urgent: bool) -> None:
        page.outbox.take()
        if not urgent:
            seen.append(None)
            steps.get(len(seen), lambda: None)()

    def enable(seq: int) -> None:
        relay.receive(verb, encode_frame(STARTS[0].TYPE, seq, STARTS[0].pack()))

    def begin() -> None:
        relay.drive(page)
        relay.join(verb, relay.wish(page.id))
        if motors == "on":
            enable(1)

    def stop() -> None:
        Session.of(board.port).asked = True
        enable(2)
        enable(3)

    seen: list[None] = []
    page = Client(Outbox(look))
    steps.update({50: begin, 100: stop})
    relay.join(page)
    page.every = 1
    with FakeBoard() as board:
        assert PortHolder(relay, board.port).hold() == BOARD.after_stop_s
        assert board.asked(schema.EnableRequest) == (motors == "on")
        assert board.state is schema.State.DISABLED
    assert ended == [f"Stopped with `greywhale stop` in another terminal: {AGAIN}"]


# A verb with its motors off or on that waits for a line, then starts the motors. Ctrl-C may be lost on its way.
VERB = """
import json, signal, socket, sys
from greywhale.board.device import Device
from greywhale.protocol.lent_line import lend

signal.signal(signal.SIGINT, signal.SIG_IGN)
lend(sys.argv[3], socket.socket(fileno=int(sys.argv[2])))
with Device(sys.argv[3], restart=False) as device:
    if "--enable" in sys.argv:
        device.enable(0)
    print("there", file=sys.stderr, flush=True)
    input()
    device.enable(0)
    print(json.dumps({"state": device.status().state.key}))
"""


@pytest.mark.parametrize("motors", ["off", "on"])
@pytest.mark.parametrize("who", ["nobody", "the page that drives", "a page that watches", "its card"])
def test_a_process_that_no_interrupt_reaches_starts_motors_only_if_nobody_stopped_it(
    shared: Shared, tmp_path: Path, who: str, motors: str
) -> None:
    desk, watcher = Desk(shared, tmp_path, [sys.executable, "-c", VERB]), shared.page()
    pages = {"the page that drives": desk.page, "a page that watches": watcher}
    with living(shared), closing(desk.jobs):
        id = desk.start("record", enable=motors == "on")
        desk.wait(id, lambda facts: "there" in facts["said"])
        if who in pages:
            pages[who].ask(schema.StopRequest())
        elif who == "its card":
            desk.jobs.stop(id)
        desk.jobs.say(id, "go on")
        job = desk.wait(id)
    if who == "nobody":
        assert (job["state"], job["error"]) == ("done", None)
        assert job["result"]["state"] in ("soft_start", "following")
    else:
        assert (job["state"], job["result"]) == ("stopped", None)
        assert who not in pages or job["error"] == f"Stopped from {who}: {AGAIN}"
        assert begun(watcher) == (motors == "on")
