"""What a bad line does to bytes: one kind of damage at a time, at random places."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Damage = Callable[[np.random.Generator, bytearray, int], None]  # at one place of some bytes


def _flip(random: np.random.Generator, data: bytearray, at: int) -> None:
    data[at] ^= 1 << int(random.integers(8))


def _replace(random: np.random.Generator, data: bytearray, at: int) -> None:
    data[at] = (data[at] + int(random.integers(1, 256))) & 0xFF


def _lose(random: np.random.Generator, data: bytearray, at: int) -> None:
    del data[at]


def _double(random: np.random.Generator, data: bytearray, at: int) -> None:
    data.insert(at, data[at])


def _insert(random: np.random.Generator, data: bytearray, at: int) -> None:
    data.insert(at, int(random.integers(256)))


def _swap(random: np.random.Generator, data: bytearray, at: int) -> None:
    other = (at + 1) % len(data)
    data[at], data[other] = data[other], data[at]


def _burst(random: np.random.Generator, data: bytearray, at: int) -> None:
    length = min(int(random.integers(2, 17)), len(data) - at)
    data[at : at + length] = random.bytes(length)


def _break_off(random: np.random.Generator, data: bytearray, at: int) -> None:
    del data[at:]


def _zero(random: np.random.Generator, data: bytearray, at: int) -> None:
    """The mark between frames, in the middle of one."""
    data.insert(at, 0)


DAMAGES: dict[str, Damage] = {
    "a bit flipped": _flip,
    "a byte replaced": _replace,
    "a byte lost": _lose,
    "a byte doubled": _double,
    "a byte inserted": _insert,
    "two bytes swapped": _swap,
    "a burst of 2 to 16 bytes": _burst,
    "a frame broken off": _break_off,
    "a zero inserted": _zero,
}


def damage(random: np.random.Generator, data: bytes, kind: str, rate: float) -> tuple[bytes, int]:
    """The bytes as they arrive, each damaged with this probability, and how often that was."""
    places = np.flatnonzero(random.random(len(data)) < rate)[::-1]  # from the end: what is before stays in its place
    arriving, done = bytearray(data), 0
    for place in places.tolist():
        if place < len(arriving):
            DAMAGES[kind](random, arriving, place)
            done += 1
    return bytes(arriving), done
