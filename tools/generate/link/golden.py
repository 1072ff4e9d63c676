"""Golden vectors for host and page: every message with its payload and whole frame, and the packed default parameters.

Bytes are made here from the declarations by their own short definitions of little-endian, CRC and COBS, so that neither
side's code is its own judge. The firmware is compared with the host, in tests/protocol.
"""

from __future__ import annotations

import random
from dataclasses import dataclass

from . import NOTICE
from .declaration import WIDTHS, Declaration, Field, Message, limits

_SEED = 20220


@dataclass(frozen=True)
class Vector:
    message: Message
    seq: int
    values: dict[str, list[int]]
    payload: bytes
    wire: bytes


def crc16(data: bytes) -> int:
    """CRC-16/CCITT-FALSE, bit by bit as published."""
    crc = 0xFFFF
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = ((crc << 1) ^ 0x1021 if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc


def cobs(data: bytes) -> bytes:
    """COBS of fewer than 254 bytes: every zero becomes the distance to the next."""
    return b"".join(bytes([len(run) + 1]) + run for run in data.split(b"\0"))


def frame(number: int, seq: int, payload: bytes) -> bytes:
    body = bytes([number, seq]) + payload
    return cobs(body + crc16(body).to_bytes(2, "little")) + b"\0"


def vectors(declaration: Declaration) -> list[Vector]:
    """Smallest, largest and random values of every message."""
    chance = random.Random(_SEED)
    made = []
    for message in declaration.messages:
        for kind in ("low", "high", "random") if message.fields else ("low",):
            values = {field.name: _values(field, kind, chance, declaration) for field in message.fields}
            payload = b"".join(
                value.to_bytes(WIDTHS[field.kind], "little", signed=field.kind[0] == "i")
                for field in message.fields
                for value in values[field.name]
            )
            seq = {"low": 0, "high": 255}.get(kind, chance.randrange(256))
            made.append(Vector(message, seq, values, payload, frame(message.type, seq, payload)))
    return made


def _values(field: Field, kind: str, chance: random.Random, declaration: Declaration) -> list[int]:
    if field.enum:
        choices = sorted(value.value for enum in declaration.enums if enum.name == field.enum for value in enum.values)
    else:
        choices = list(limits(field.kind))
    picks = {"low": lambda: choices[0], "high": lambda: choices[-1]}
    if field.enum:
        picks["random"] = lambda: chance.choice(choices)
    else:
        picks["random"] = lambda: chance.randint(choices[0], choices[-1])
    return [picks[kind]() for _ in range(field.count or 1)]


def default_table(declaration: Declaration) -> bytes:
    """The default parameters packed in index order."""
    return b"".join(
        p.defaults[element].to_bytes(WIDTHS[p.kind], "little", signed=p.kind[0] == "i")
        for group in declaration.groups
        for element in range(group.count)
        for p in group.parameters
    )


def toml(declaration: Declaration) -> str:
    """Text of shared/link/golden.toml."""
    table = default_table(declaration)
    rows = [
        f'  {{ message = "{vector.message.struct}", seq = {vector.seq}, payload = "{vector.payload.hex()}", '
        f'wire = "{vector.wire.hex()}", values = {{ {", ".join(_pairs(vector))} }} }},'
        for vector in vectors(declaration)
    ]
    lines = [
        f"# Golden vectors of the link. {NOTICE}",
        "",
        "vector = [",
        *rows,
        "]",
        "",
        "[parameters]",
        f'defaults = "{table.hex()}"',
        f"crc = 0x{crc16(table):04X}",
    ]
    return "\n".join(lines) + "\n"


def _pairs(vector: Vector) -> list[str]:
    values = vector.values
    return [
        f"{field.name} = {values[field.name] if field.count else values[field.name][0]}"
        for field in vector.message.fields
    ]
