"""Messages: golden vectors, round trips with the firmware's structs, and what wrong payloads get."""

from __future__ import annotations

import dataclasses
import re
import tomllib
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from greywhale.protocol import schema
from greywhale.protocol.declared import Described, Message, MessageError
from greywhale.protocol.frames import encode_frame
from tools import ROOT

if TYPE_CHECKING:
    from .conftest import Firmware

GOLDEN = tomllib.loads((ROOT / "shared/link/golden.toml").read_text(encoding="utf-8"))
DECLARED = tomllib.loads((ROOT / "shared/link/messages.toml").read_text(encoding="utf-8"))
BY_NAME = {message.__name__: message for message in schema.MESSAGES}


def payload_strategy(fields: list[dict[str, Any]]) -> st.SearchStrategy[bytes]:
    """Payloads that fit the declared fields: any bytes, but known values where an enum is declared."""
    parts = []
    for field in fields:
        if "enum" in field:
            parts.append(st.sampled_from([bytes([member]) for member in getattr(schema, field["enum"])]))
        else:
            kind = re.fullmatch(r"[iu](\d+)(?:\[(\d+)\])?", field["type"])
            assert kind is not None
            size = int(kind[1]) // 8 * int(kind[2] or 1)
            parts.append(st.binary(min_size=size, max_size=size))
    return st.tuples(*parts).map(b"".join)


def declared_payloads() -> dict[str, st.SearchStrategy[bytes]]:
    strategies = {}
    for message in DECLARED["message"]:
        name = message["name"].title().replace("_", "")
        for key, suffix in (("fields", ""), ("request", "Request"), ("reply", "Reply")):
            if key in message:
                strategies[name + suffix] = payload_strategy(message[key])
    return strategies


PAYLOADS = declared_payloads()


@pytest.mark.parametrize("vector", GOLDEN["vector"], ids=lambda vector: f"{vector['message']}-{vector['seq']}")
def test_golden_vectors(vector: dict[str, Any]) -> None:
    message = BY_NAME[vector["message"]]
    payload = bytes.fromhex(vector["payload"])
    decoded = message.unpack(payload)
    values = dataclasses.asdict(decoded)  # type: ignore[call-overload]
    assert {name: list(value) if isinstance(value, tuple) else value for name, value in values.items()} == vector[
        "values"
    ]
    assert decoded.pack() == payload
    assert encode_frame(message.TYPE, vector["seq"], payload) == bytes.fromhex(vector["wire"])


def test_golden_vectors_cover_every_message() -> None:
    assert {vector["message"] for vector in GOLDEN["vector"]} == set(BY_NAME)


@pytest.mark.parametrize("name", sorted(PAYLOADS))
@given(data=st.data())
@settings(max_examples=30)
def test_payloads_survive_both_sides(firmware: Firmware, name: str, data: st.DataObject) -> None:
    payload = data.draw(PAYLOADS[name])
    assert BY_NAME[name].unpack(payload).pack() == payload
    assert firmware.reencode(name, payload) == payload


@pytest.mark.parametrize("message", schema.MESSAGES, ids=lambda message: message.__name__)
def test_a_payload_of_another_length_is_refused_by_both_sides(firmware: Firmware, message: type[Message]) -> None:
    for size in {0, message.SIZE - 1, message.SIZE + 1, 48} - {message.SIZE, -1}:
        with pytest.raises(MessageError, match=rf"{size} bytes as {message.__name__}.* {message.SIZE}"):
            message.unpack(bytes(size))
        assert firmware.reencode(message.__name__, bytes(size)) is None


def test_both_sides_were_made_from_the_same_declarations(firmware: Firmware) -> None:
    assert firmware.schema_hash == schema.SCHEMA_HASH


def test_an_unknown_enum_value_is_one_sentence_with_a_remedy() -> None:
    with pytest.raises(MessageError, match=r"sent 9 as its State.*0 boot.*4 fault.*greywhale flash"):
        schema.StopReply.unpack(b"\x09")


def test_a_value_that_does_not_fit_its_field_is_refused() -> None:
    with pytest.raises(MessageError, match=r"message enable cannot carry lease_ms = 70000"):
        schema.EnableRequest(70000).pack()


@pytest.mark.parametrize("enum", [schema.Fault, schema.NackCode, schema.Refusal])
def test_every_refusal_and_fault_says_what_to_do(enum: type[Described]) -> None:
    for member in enum:
        assert len(member.description) > 5
        assert member.remedy.endswith(".")
