"""Frames: round trips, damage, lost places, and the same judgement as the firmware on any stream of bytes."""

from __future__ import annotations

import tracemalloc
from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from greywhale.base.errors import UserError
from greywhale.protocol.frames import MAX_WIRE, Frame, FrameDecoder, decode_frame, encode_frame
from greywhale.protocol.schema import MAX_PAYLOAD
from tools.generate.link import golden

if TYPE_CHECKING:
    from .conftest import Firmware

bytes_u8 = st.integers(0, 255)
# Half of the payloads are poor in values, so that zeros and equal bytes come together.
payloads = st.binary(max_size=MAX_PAYLOAD) | st.lists(st.sampled_from([0, 1, 255]), max_size=MAX_PAYLOAD).map(bytes)
frames = st.builds(Frame, bytes_u8, bytes_u8, payloads)
rubbish = st.lists(st.integers(1, 255), min_size=1, max_size=120).map(bytes)


def wire(frame: Frame) -> bytes:
    return encode_frame(frame.type, frame.seq, frame.payload)


@given(frames)
def test_a_frame_comes_back_and_holds_no_zero_but_the_last(frame: Frame) -> None:
    encoded = wire(frame)
    assert encoded.find(0) == len(encoded) - 1 <= MAX_WIRE
    assert decode_frame(encoded[:-1]) == frame
    decoder = FrameDecoder()
    assert decoder.feed(encoded) == [frame]
    assert decoder.bad == 0


@given(frames)
def test_the_firmware_makes_the_same_bytes(firmware: Firmware, frame: Frame) -> None:
    assert firmware.encode(*frame) == wire(frame)


@settings(derandomize=True)  # a changed COBS byte passes the CRC once in 65,536 times, which is no fault of the code
@given(frames, st.data())
def test_any_changed_byte_is_noticed_and_the_next_frame_arrives(frame: Frame, data: st.DataObject) -> None:
    encoded = bytearray(wire(frame))
    at = data.draw(st.integers(0, len(encoded) - 1))
    encoded[at] ^= data.draw(st.integers(1, 255))
    decoder = FrameDecoder()
    assert decoder.feed(bytes(encoded) + b"\0") == []
    assert decoder.bad >= 1
    assert decoder.feed(wire(frame)) == [frame]


@given(frames, st.data())
def test_any_missing_byte_is_noticed(frame: Frame, data: st.DataObject) -> None:
    encoded = wire(frame)
    at = data.draw(st.integers(0, len(encoded) - 2))
    damaged = encoded[:at] + encoded[at + 1 :]
    decoder = FrameDecoder()
    assert frame not in decoder.feed(damaged)


@given(st.lists(frames | rubbish, max_size=12), st.data())
def test_splitting_the_stream_anywhere_changes_nothing(parts: list[Frame | bytes], data: st.DataObject) -> None:
    stream = b"".join(wire(part) if isinstance(part, Frame) else part + b"\0" for part in parts)
    whole = FrameDecoder()
    expected = whole.feed(stream)
    assert [part for part in parts if isinstance(part, Frame)] == [frame for frame in expected if frame in parts]
    pieces = FrameDecoder()
    got: list[Frame] = []
    rest = stream
    while rest:
        size = data.draw(st.integers(1, len(rest)))
        got += pieces.feed(rest[:size])
        rest = rest[size:]
    assert got == expected
    assert pieces.bad == whole.bad


@given(st.lists(frames.map(wire) | rubbish | st.binary(max_size=80) | st.just(b"\0"), max_size=10))
def test_both_sides_judge_any_stream_alike(firmware: Firmware, parts: list[bytes]) -> None:
    stream = b"".join(parts) + b"\0"
    decoder = FrameDecoder()
    got = [tuple(frame) for frame in decoder.feed(stream)]
    assert (got, decoder.bad) == firmware.decode(stream)


def test_a_frame_one_byte_too_long_is_refused_by_both_sides_though_its_crc_is_right(firmware: Firmware) -> None:
    for size in (MAX_PAYLOAD, MAX_PAYLOAD + 1):
        stream = golden.frame(1, 2, bytes([0x55]) * size)
        assert len(FrameDecoder().feed(stream)) == len(firmware.decode(stream)[0]) == (size == MAX_PAYLOAD)


def test_the_firmwares_count_of_bad_frames_stops_at_its_end(firmware: Firmware) -> None:
    assert firmware.decode(b"\x05\0" * 70_000) == ([], 65_535)


def test_an_endless_piece_is_counted_once_and_takes_no_memory() -> None:
    decoder = FrameDecoder()
    piece = b"\x55" * 1000
    tracemalloc.start()
    try:
        before, _ = tracemalloc.get_traced_memory()
        for _ in range(1000):
            assert decoder.feed(piece) == []
        after, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert decoder.bad == 1
    assert after - before < len(piece)
    assert peak - before < 10 * len(piece)
    frame = Frame(1, 2, b"three")
    assert decoder.feed(b"\0" + wire(frame)) == [frame]
    assert decoder.bad == 1


def test_reset_forgets_a_piece() -> None:
    frame = Frame(1, 2, b"three")
    decoder = FrameDecoder()
    decoder.feed(wire(frame)[:4])
    decoder.reset()
    assert decoder.feed(wire(frame)) == [frame]


def test_a_payload_that_is_too_long_is_refused() -> None:
    with pytest.raises(UserError, match=r"at most 48 bytes, but 49"):
        encode_frame(1, 1, bytes(49))
