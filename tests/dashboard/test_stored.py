"""The set that a board stores, by what it says: at its start, and when it has written a set and read it back."""

from __future__ import annotations

import pytest

from greywhale.dashboard.stored import StoredSet
from greywhale.protocol.declared import Message
from greywhale.protocol.frames import Frame
from greywhale.protocol.schema import (
    DEFAULTS,
    PARAMETER_BY_NAME,
    Board,
    Clutch,
    Fault,
    HelloReply,
    ParamApplyRequest,
    ParamSaveReply,
    ParamSaveRequest,
    ParamSetRequest,
    ParamSource,
    ResetCause,
    SaveState,
    State,
    StatusReply,
    StatusRequest,
    StopReason,
    param_crc,
)
from tests.dashboard.shared import Shared

KP = PARAMETER_BY_NAME["joint2.kp"]
HELLO = HelloReply(1, 0, 1, 0, 7, Board.MEGA2560, 0x1234, ParamSource.BANK_A, ResetCause.POWER_ON)


def frame(message: Message, seq: int = 9) -> Frame:
    return Frame(message.TYPE, seq, message.pack())


def status(state: SaveState) -> Frame:
    return frame(
        StatusReply(State.DISABLED, StopReason.NONE, Fault.NONE, 255, 0, 0, 0, 0, 0, 0, 0, state, 1, Clutch.ENGAGED)
    )


def test_only_what_is_written_and_read_back_is_stored() -> None:
    stored = StoredSet()
    assert not stored.hear(frame(HELLO))
    assert stored.crc is None, "a board that answers may run what it does not store"
    assert stored.hear(frame(HELLO, seq=0))
    assert stored.crc == HELLO.param_crc
    stored.hear(status(SaveState.SAVED))  # of an earlier set
    for ends, crc in ((SaveState.FAILED, HELLO.param_crc), (SaveState.SAVED, 0x4321)):
        stored.hear(frame(ParamSaveReply(0x4321)))
        stored.hear(status(SaveState.SAVING))
        assert stored.crc == HELLO.param_crc
        assert stored.hear(status(ends)) == (ends is SaveState.SAVED)
        assert stored.crc == crc


@pytest.mark.slow
def test_every_page_is_told_what_is_stored(shared: Shared) -> None:
    page, watcher = shared.page(0), shared.page(0)
    assert page.words("stored")[-1]["crc"] is None
    shared.relay.drive(page.client)
    values = list(DEFAULTS)
    values[KP.index] *= 2
    crc = param_crc(values)
    for request in (ParamSetRequest(KP.index, values[KP.index]), ParamApplyRequest(crc), ParamSaveRequest()):
        page.ask(request)
        shared.live(0.1)
    assert [word["crc"] for word in watcher.words("stored")] == [None]
    shared.live(1.0)
    page.ask(StatusRequest())
    shared.live(0.1)
    assert [word["crc"] for word in watcher.words("stored")] == [crc]
    assert shared.page(0).words("stored")[-1]["crc"] == crc
