"""Pages that share a board: each gets its own answers and every tick, one drives, and the motors never outlive it."""

from __future__ import annotations

from collections import Counter

import pytest

from greywhale.base.errors import UserError
from greywhale.dashboard.limits import BOARD
from greywhale.protocol import schema
from greywhale.protocol.frames import FrameDecoder
from greywhale_sim.lockstep import LockStepBench
from tests.board.fake_board import FakeBoard, Faults
from tests.dashboard.shared import Shared, Viewer

# By then the motors are off, whatever becomes of the page.
OFF_S = BOARD.page_silence_s + 0.02


def start(shared: Shared) -> Viewer:
    """A page whose motors are on."""
    page = shared.page()
    shared.relay.drive(page.client)
    page.ask(schema.EnableRequest(0))
    shared.live(0.1)
    assert page.answers()[-1].type == schema.EnableReply.TYPE
    return page


def motors_on(page: Viewer) -> bool:
    return page.samples()[-1].state not in (schema.State.DISABLED, schema.State.FAULT)


def test_frames_arrive_byte_for_byte_and_no_tick_is_missing() -> None:
    with FakeBoard() as board:
        said = b""
        with Shared(board.port) as shared:
            read = shared.line.read

            def note() -> bytes:
                nonlocal said
                data = read()
                said += data
                return data

            shared.line.read = note  # type: ignore[method-assign]
            page = shared.page()
            shared.live(1.0)
            got = page.raw()
        samples = [wire for frame, wire in FrameDecoder().feed_wire(said) if frame.type == schema.Sample.TYPE]
        assert got == b"".join(samples)
        ticks = [one.tick for one in map(schema.Sample.unpack, (f.payload for f in FrameDecoder().feed(got)))]
        assert len(ticks) > 900
        assert ticks == list(range(ticks[0], ticks[0] + len(ticks)))


def test_each_page_gets_its_own_answers_with_its_own_numbers(shared: Shared) -> None:
    one, other = shared.page(0), shared.page(0)
    for count in range(260):  # more than there are numbers
        one.ask(schema.ParamGetRequest(count % 7), seq=1 + count % 5)
        other.ask(schema.StatusRequest(), seq=1 + count % 5)
        shared.live(0.02)
        (got,), (told,) = one.answers(), other.answers()
        assert (got.type, got.seq) == (schema.ParamGetReply.TYPE, 1 + count % 5)
        assert schema.ParamGetReply.unpack(got.payload).index == count % 7
        assert (told.type, told.seq) == (schema.StatusReply.TYPE, 1 + count % 5)


def test_what_many_pages_ask_at_once_costs_no_sample_of_an_arm_that_follows(
    bench: LockStepBench, shared: Shared
) -> None:
    driver = start(shared)
    shared.live(1.5, here=driver)
    driver.raw()
    driver.answers()
    pages = [driver, *(shared.page(0) for _ in range(3))]
    for phase in range(20):
        bench.bench.run_slices(phase % 4)
        for page in pages:
            page.ask(schema.StatusRequest())
            page.ask(schema.ParamGetRequest(phase))
        shared.live(0.05)
        assert [len(page.answers()) for page in pages] == 4 * [2]
    samples = driver.samples()
    assert {sample.state for sample in samples} == {schema.State.FOLLOWING}
    ticks = [sample.tick for sample in samples]
    assert ticks == list(range(ticks[0], ticks[0] + len(ticks)))


def test_a_request_that_is_lost_delays_neither_others_nor_the_lease() -> None:
    with FakeBoard(Faults(lose=Counter({schema.StatusRequest.TYPE: 100}))) as board, Shared(board.port) as shared:
        driver, other = start(shared), shared.page(0)
        for count in range(30):
            driver.ask(schema.StatusRequest())
            driver.ask(schema.StatusRequest())
            seq = other.ask(schema.ParamGetRequest(count))
            shared.live(2 * BOARD.answer_s + 0.02)
            assert [frame.seq for frame in other.answers()] == [seq]
        assert motors_on(driver)


def test_how_many_samples_a_page_wants_is_its_own_affair(shared: Shared) -> None:
    every, tenth, none = shared.page(0), shared.page(0), shared.page(0)
    every.ask(schema.TelemetryRequest(1))
    tenth.ask(schema.TelemetryRequest(10))
    shared.live(0.5)
    assert [schema.TelemetryReply.unpack(one.payload).every for one in (*every.answers(), *tenth.answers())] == [1, 10]
    ticks = [one.tick for one in every.samples()]
    assert [one.tick for one in tenth.samples()] == [tick for tick in ticks if tick % 10 == 0]
    assert none.raw() == b""


def test_a_watcher_changes_nothing_but_may_look_and_stop(shared: Shared) -> None:
    driver, watcher = start(shared), shared.page()
    before = shared.line.clock()
    for request in (
        schema.EnableRequest(0), schema.LeadRequest(100), schema.RenewRequest(0), schema.ClearFaultRequest(),
        schema.ParamSetRequest(0, 1), schema.ParamApplyRequest(0), schema.ParamSaveRequest(),
        schema.ParamDefaultsRequest(), schema.LeadPointRequest(0, (0, 0, 0, 0)),
    ):  # fmt: skip
        seq = watcher.ask(request)
        (refused,) = watcher.words("refused")
        assert (refused["seq"], refused["type"]) == (seq, request.TYPE)
        assert "only watches" in refused["sentence"]
    assert shared.line.clock() == before
    shared.live(0.1, here=driver)
    assert watcher.answers() == []
    assert motors_on(driver)
    seq = watcher.ask(schema.StopRequest())
    shared.live(0.05)
    assert (schema.StopReply.TYPE, seq) in [(frame.type, frame.seq) for frame in watcher.answers()]
    assert not motors_on(driver)


def test_one_drives_until_it_lets_go(shared: Shared) -> None:
    first, second = shared.page(), shared.page()
    shared.relay.drive(first.client)
    shared.relay.drive(second.client)
    assert "Another page drives" in second.words("refused")[0]["sentence"]
    assert second.words("driver")[-1] == {"kind": "driver", "you": False, "free": False, "job": None, "verb": None}
    assert first.words("driver")[-1]["you"]
    shared.relay.release(first.client)
    assert second.words("driver")[-1]["free"]
    shared.relay.drive(second.client)
    assert second.words("driver")[-1]["you"]
    shared.relay.require(shared.relay.wish(second.client.id))
    with pytest.raises(UserError, match="only watches"):
        shared.relay.require(shared.relay.wish(first.client.id))
    for page in (first, second):
        shared.relay.leave(page.client)


def test_motors_run_as_long_as_their_page_is_there(shared: Shared) -> None:
    page = start(shared)
    shared.live(1.0, here=page)
    assert motors_on(page)
    silent_from = shared.line.clock()
    shared.live(BOARD.page_silence_s - 0.1)
    assert motors_on(page)
    shared.live(silent_from + OFF_S - shared.line.clock())
    assert not motors_on(page)
    assert "fell silent" in page.words("refused")[0]["sentence"]


@pytest.mark.parametrize("how", ["leave", "release"])
def test_motors_go_off_with_their_page(shared: Shared, how: str) -> None:
    driver, watcher = start(shared), shared.page()
    shared.live(0.05)
    assert motors_on(watcher)
    getattr(shared.relay, how)(driver.client)
    shared.live(0.05)
    assert not motors_on(watcher)


def test_motors_go_off_by_the_lease_if_this_host_hangs(shared: Shared) -> None:
    page = start(shared)
    shared.line.wait(BOARD.lease_ms / 1000 + 0.05)
    shared.turn()
    assert not motors_on(page)


def test_a_page_cannot_ask_for_a_longer_lease(bench: LockStepBench) -> None:
    with FakeBoard() as board, Shared(board.port) as shared:
        page = shared.page()
        shared.relay.drive(page.client)
        for request in (schema.EnableRequest(0), schema.RenewRequest(60_000), schema.LeadRequest(60_000)):
            page.ask(request)
            shared.live(0.01)
            assert board.lease_ms == BOARD.lease_ms
        shared.live(1.0)
        page.ask(schema.EnableRequest(PULSE_MS))
        shared.live(0.01)
        assert board.lease_ms == PULSE_MS, "but for a shorter one, which is not renewed"


PULSE_MS = 160


def pulsed(shared: Shared) -> Viewer:
    """A page that drives and has just asked for a pulse."""
    page = shared.page()
    shared.relay.drive(page.client)
    page.ask(schema.LeadRequest(PULSE_MS))
    shared.live(0.02, here=page)
    assert page.answers()[-1].type == schema.LeadReply.TYPE
    assert motors_on(page)
    return page


def on_ticks(page: Viewer) -> int:
    return sum(sample.state not in (schema.State.DISABLED, schema.State.FAULT) for sample in page.samples())


@pytest.mark.parametrize("speaks", [True, False])
def test_a_pulse_ends_by_its_own_lease_whether_its_page_speaks_or_not(shared: Shared, speaks: bool) -> None:
    page = pulsed(shared)
    shared.live(1.0, here=page if speaks else None)
    assert 0 < on_ticks(page) <= PULSE_MS
    assert page.words("refused") == []


def test_nothing_that_a_page_asks_makes_a_pulse_longer(shared: Shared) -> None:
    page = pulsed(shared)
    for request in (schema.RenewRequest(0), schema.EnableRequest(0), schema.LeadRequest(60_000)):
        page.ask(request)
        assert "nothing makes longer" in page.words("refused")[0]["sentence"]
    shared.live(0.5, here=page)
    assert on_ticks(page) <= PULSE_MS
    page.ask(schema.EnableRequest(0))
    shared.live(1.0, here=page)
    assert motors_on(page), "what is asked for afterwards is kept on again"


def test_a_pulse_that_never_reached_the_board_is_in_nobodys_way() -> None:
    with FakeBoard(Faults(lose=Counter({schema.LeadRequest.TYPE: 1}))) as board, Shared(board.port) as shared:
        page = shared.page()
        shared.relay.drive(page.client)
        for answers in (0, 1):
            page.ask(schema.LeadRequest(PULSE_MS), seq=7)
            shared.live(0.5, here=page)
            assert len(page.answers()) == answers
        assert board.lease_ms == PULSE_MS


def test_a_board_that_is_silent_and_restarts_is_told_and_speaks_on(bench: LockStepBench, shared: Shared) -> None:
    page = start(shared)
    page.words("link")
    bench.command("power off")
    shared.live(1.0, here=page)
    (told,) = page.words("link")
    assert told["open"]
    assert told["sentence"] == "The board is silent: is its supply on, or is this computer too busy to simulate it?"
    bench.command("power on")
    for _ in range(20):  # a page that goes on asking does not keep the bootloader
        page.ask(schema.StatusRequest())
        shared.live(0.1, here=page)
    assert "silent" in page.words("refused")[0]["sentence"]
    assert (schema.HelloReply.TYPE, 0) in [(frame.type, frame.seq) for frame in page.answers()]
    assert "restarted" in page.words("link")[-1]["sentence"]
    page.raw()
    shared.live(0.2)
    assert page.samples()[-1].state is schema.State.DISABLED


def test_a_host_that_is_late_itself_refuses_nothing(shared: Shared) -> None:
    page = shared.page(0)
    shared.line.wait(0.4)
    seq = page.ask(schema.StatusRequest())
    shared.live(0.05)
    assert page.words("refused") == []
    assert [frame.seq for frame in page.answers()] == [seq]


def test_what_is_no_frame_is_nobodys_and_what_follows_is_heard(shared: Shared) -> None:
    page = shared.page(0)
    for garbage in (bytes(range(1, 200)) + b"\0", b"\1" * 60_000 + b"\0"):
        shared.relay.receive(page.client, garbage)
        seq = page.ask(schema.HelloRequest())
        shared.live(0.05)
        assert [(frame.type, frame.seq) for frame in page.answers()] == [(schema.HelloReply.TYPE, seq)]


def test_a_refusal_of_the_board_has_the_pages_number() -> None:
    refuse = {schema.EnableRequest.TYPE: (schema.NackCode.ERROR_TOO_LARGE, 0x0140)}
    with FakeBoard(Faults(refuse=refuse)) as board, Shared(board.port) as shared:
        page = shared.page()
        shared.relay.drive(page.client)
        seq = page.ask(schema.EnableRequest(0))
        shared.live(0.05)
        (nack,) = page.answers()
        assert (nack.type, nack.seq) == (schema.Nack.TYPE, seq)
        shared.live(1.0)
        assert page.words("refused") == []


def test_a_slow_page_loses_its_oldest_samples_and_delays_nobody(shared: Shared) -> None:
    slow, quick = shared.page(), shared.page()
    small = slow.client.outbox = type(slow.client.outbox)(lambda urgent: None, most_samples=100)
    shared.live(1.0)
    ticks = [one.tick for one in quick.samples()]
    assert len(ticks) > 900
    assert [one.tick for one in slow.samples()] == ticks[-100:]
    assert small.take() == ([], b"")


def test_without_a_board_a_page_is_told_what_to_do(shared: Shared) -> None:
    page = shared.page()
    shared.relay.close("", "No board was found; plug it in.")
    page.ask(schema.HelloRequest())
    assert page.words("link")[-1] == {
        "kind": "link", "open": False, "port": "", "sentence": "No board was found; plug it in.",
        "unflashed": False,
    }  # fmt: skip
    assert page.words("refused")[-1]["sentence"] == "No board was found; plug it in."
