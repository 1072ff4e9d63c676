"""Inputs for the fuzzer of the whole firmware, written by hand: what a bench sees, from which the search goes on.

Each deed is a byte and what it needs; firmware/test/attack/fuzz_app.cpp reads them.
"""

from __future__ import annotations

import struct

from greywhale.protocol import schema

STOP, CLEAR, APPLY, SAVE, ESTOP, STALL_WIRE = (bytes([deed]) for deed in (2, 4, 7, 8, 21, 22))
LATE = bytes([17, 12])
NO_SAMPLES = bytes([17, 0])
LOSE_BYTES = bytes([20, 9])


def ticks(count: int) -> bytes:
    return struct.pack("<BH", 15, count)


def enable(lease_ms: int = 0) -> bytes:
    return struct.pack("<BH", 0, lease_ms)


def lead(lease_ms: int) -> bytes:
    return struct.pack("<BH", 1, lease_ms)


def renew(lease_ms: int) -> bytes:
    return struct.pack("<BH", 3, lease_ms)


def point(*steps: int) -> bytes:
    return struct.pack("<BB4b", 10, 0, *steps)


def stage(name: str, raw: int) -> bytes:
    parameter = schema.PARAMETER_BY_NAME[name]
    return struct.pack("<BBBI", 6, parameter.index, 1, raw - int(parameter.minimum))


def frame(kind: int, payload: bytes) -> bytes:
    return bytes([11, kind, len(payload)]) + payload


def pot(number: int, count: int) -> bytes:
    return struct.pack("<BBH", 16, number, count)


def arm_moves(speed: int) -> bytes:
    return struct.pack("<Bb", 23, speed)


def shake(joint: int, counts: int, period: int) -> bytes:
    return bytes([25, joint, counts, period - 1])


def reset(cause: int) -> bytes:
    return bytes([19, cause])


def damage(**cells: int) -> bytes:
    """A power cut, and EEPROM cells that have another value after it: cell_ADDRESS=value."""
    pairs = b"".join(struct.pack("<HB", int(name.removeprefix("cell_")), value) for name, value in cells.items())
    return bytes([19, 8 | (len(cells) - 1) << 4]) + pairs


SOME = ticks(12)
UNWATCHED = stage("speed_limit", 0) + stage("runaway_limit", 0) + stage("stall_volts", 0)
QUIET = UNWATCHED + APPLY + SOME
SAFE = UNWATCHED + stage("joint0.kp", 200_000) + stage("unrest_action", 1) + APPLY + SOME

STORIES = {
    "a leader moves and the arm follows": arm_moves(20) + enable() + ticks(1100) + pot(0, 560) + ticks(900) + STOP
    + SOME,
    "a follower runs away": arm_moves(-20) + enable() + ticks(1100) + pot(0, 560) + ticks(900),
    "a joint is stuck": enable() + ticks(1100) + pot(1, 600) + ticks(900) + CLEAR + SOME,
    "a follower is lost": QUIET + enable() + pot(0, 800) + ticks(600) + CLEAR + SOME,
    "a lease runs out": QUIET + enable(100) + ticks(60) + renew(80) + ticks(200),
    "the host leads": QUIET + lead(4000) + b"".join(point(50, -50, 127, -127) + ticks(16) for _ in range(12))
    + renew(1024) + ticks(63) + STOP + SOME,
    "the host leads too far": stage("joint0.limit_max", 100) + QUIET + lead(4000)
    + b"".join(point(40, 0, 0, 0) + ticks(16) for _ in range(6)),
    "more points than there is room for": QUIET + lead(4000) + ticks(5)
    + b"".join(point(5, -5, 5, -5) for _ in range(16)) + ticks(100) + b"".join(point(-5, 5, -5, 5) for _ in range(16))
    + ticks(300),
    "unrest, and the safe set goes on": SAFE + enable() + shake(0, 20, 20) + ticks(1999) + ticks(60),
    "unrest within a lease": SAFE + enable(3000) + shake(2, 30, 15) + ticks(1999) + ticks(1999),
    "unrest stops": QUIET + enable() + shake(1, 20, 20) + ticks(1999) + CLEAR + SOME,
    "a set is refused": QUIET + stage("joint0.kp", 4_000_000) + stage("joint2.ne_c", 900) + APPLY + SOME + enable()
    + pot(0, 530) + ticks(900),
    "an apply with a wrong CRC": UNWATCHED + stage("joint0.kp", 4000)
    + frame(schema.ParamApplyRequest.TYPE, b"\x12\x34") + SOME + enable() + ticks(300),
    "a long period": stage("period_ms", 20) + stage("filter_shift", 3) + stage("soft_start_ms", 300)
    + stage("supply_mv", 12000) + APPLY + SOME + arm_moves(9) + enable() + pot(2, 530) + ticks(700),
    "saved, and the power goes": stage("period_ms", 10) + APPLY + SOME + SAVE + ticks(1500) + reset(1) + ticks(30),
    "the power goes in a save": stage("period_ms", 10) + APPLY + SOME + SAVE + ticks(40) + reset(1) + ticks(30),
    "saved twice": stage("period_ms", 10) + APPLY + SOME + SAVE + ticks(1500) + stage("period_ms", 4) + APPLY + SOME
    + SAVE + ticks(300) + reset(4) + ticks(30) + CLEAR + enable(50) + ticks(60),
    "the EEPROM rots": stage("period_ms", 10) + APPLY + SOME + SAVE + ticks(1500) + damage(cell_100=7, cell_300=9)
    + ticks(30) + enable() + SAVE + ticks(1999),
    "the emergency stop": enable() + ticks(40) + ESTOP + ticks(5) + ESTOP + CLEAR + enable(500) + ticks(60)
    + ticks(600),
    "a wire breaks": enable() + ticks(50) + pot(5, 0) + ticks(5) + pot(5, 512) + ticks(60) + CLEAR + enable() + SOME,
    "a tick is late": enable() + ticks(50) + LATE + ticks(4) + CLEAR + enable() + ticks(30) + NO_SAMPLES + ticks(3),
    "a flood": enable() + ticks(30) + (LOSE_BYTES + ticks(1)) * 6 + ticks(3),
    "nobody reads": STALL_WIRE + ticks(300) + STALL_WIRE + enable() + ticks(100),
}  # fmt: skip
