"""Questions to a bootloader, and what is kept of its answers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

# Of a pattern, beside bytes: any byte, and one that was asked for.
ANY, KEPT = -1, -2


@dataclass(frozen=True)
class Question:
    """The bytes of a question, and the pattern of the answer to it."""

    asks: Sequence[int]
    answer: Sequence[int]


def keep(heard: bytes, pattern: Sequence[int]) -> bytes | None:
    """The bytes that were asked for, of an answer; None where it is another one."""
    if len(heard) != len(pattern) or any(
        wanted >= 0 and wanted != got for wanted, got in zip(pattern, heard, strict=True)
    ):
        return None
    return bytes(got for wanted, got in zip(pattern, heard, strict=True) if wanted == KEPT)


def high_first(number: int, width: int) -> bytes:
    """A number in so many bytes."""
    return number.to_bytes(width, "big")


def low_first(number: int, width: int) -> bytes:
    """A number in so many bytes."""
    return number.to_bytes(width, "little")
