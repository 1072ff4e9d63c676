"""A bit that flips in memory on the real images: what a set has become is looked over all the time."""

from __future__ import annotations

import struct

import pytest

from greywhale.fuzzy import twin
from greywhale.fuzzy.settings import JointSettings
from greywhale.protocol import schema
from greywhale_sim.board_with_image import BoardWithImage
from tests.firmware.conftest import apply, enable, ms_until_off

FLIPS = 26
LOOK_MS = 4.0  # at one joint after each tick
JUMPS = (schema.Fault.SPEED, schema.Fault.LEADER_JUMP, schema.Fault.TRACKING, schema.Fault.RUNAWAY)  # an angle may jump
ROUND_MS = 54.0  # all checked memory, eight bytes after each tick; a flip behind the eye waits for the next round
SOFT_START = ("soft_start_ms", schema.DEFAULTS[schema.PARAMETER_BY_NAME["soft_start_ms"].index])
LIMITS = ("enable_limit", "tracking_limit", "tracking_ms", "soft_start_ms")
JOINT_SIZE, POT_SIZE, LIMITS_AT = 28, 8, 22
JOINT_FIELDS = ("ne_c", "ze_a", "ze_c", "pe_b", "nce_c", "zce_a", "zce_c", "pce_b", "kp", "kd", "ki", "ku_mv")


def coefficients(joint: int) -> bytes:
    """A joint's coefficients of the default set as they lie in memory."""
    values = schema.DEFAULTS
    settings = JointSettings(
        *(values[schema.PARAMETER_BY_NAME[f"joint{joint}.{field}"].index] for field in JOINT_FIELDS)
    )
    found = twin.compile_settings(settings, values[schema.PARAMETER_BY_NAME["period_ms"].index])
    sides = b"".join(struct.pack("<IIB", side.zero, side.outer, side.short_ramps) for side in (*found.e, *found.ce))
    return sides + struct.pack("<IH", found.integral, found.ku_mv)


def watched(bench: BoardWithImage) -> list[tuple[int, int]]:
    """Address and size of the running table (the staged one lies behind), each joint's coefficients and the limits."""
    start, _ = bench.ram
    memory = bench.board.peek(start, bench.statics)
    limits = (schema.DEFAULTS[schema.PARAMETER_BY_NAME[name].index] for name in LIMITS)
    parts = [
        schema.TABLE.pack(schema.DEFAULTS),
        *(coefficients(joint) for joint in range(4)),
        struct.pack("<HHHH", *limits),
    ]
    return [(start + memory.index(part), len(part)) for part in parts]


def kept(bench: BoardWithImage) -> list[tuple[int, int]]:
    """Address and size of what the pots' pass keeps of the running set: joint by joint its lines and limits; at last
    which pots there are (firmware/lib/app/src/signals_layout.h).
    """
    start, _ = bench.ram
    zero, scale = (schema.DEFAULTS[schema.PARAMETER_BY_NAME[f"leader0.{name}"].index] for name in ("zero", "scale"))
    line = struct.pack("<hi", scale, 0x4000 - zero * 4 * scale)
    memory = bench.board.peek(start, bench.statics)
    first = start + memory.index(line)
    joints = [first + JOINT_SIZE * joint for joint in range(4)]
    assert all(bench.board.peek(at + pot, len(line)) == line for at in joints for pot in (0, POT_SIZE))
    pots = joints[-1] - 2 + JOINT_SIZE  # behind the last joint
    assert bench.board.peek(pots, 1) == b"\xff"
    places = [(at + place, size) for at in joints for place, size in ((0, 6), (POT_SIZE, 6), (LIMITS_AT - 2, 4))]
    return [*places, (pots, 1)]


def flip(bench: BoardWithImage, address: int) -> None:
    bench.board.poke(address, bytes([bench.board.peek(address, 1)[0] ^ 1 << int(bench.random.integers(8))]))


@pytest.mark.slow
def test_motors_are_off_soon_after_any_bit_of_the_running_set_has_flipped(bench: BoardWithImage) -> None:
    parts = watched(bench)
    for trial in range(FLIPS):
        address, size = parts[trial % len(parts)]
        enable(bench)
        bench.wait(bench.random.uniform(0, 60))
        flip(bench, address + int(bench.random.integers(size)))
        assert ms_until_off(bench, step_ms=0.25) <= 2 * ROUND_MS + 1
        seen = bench.status()
        assert seen.late_ticks == 0
        assert seen.fault in (schema.Fault.MEMORY, schema.Fault.ESTOP), "a flipped estop_input means an opening button"
        apply(bench, *SOFT_START)


@pytest.mark.slow
def test_motors_are_off_before_much_is_done_by_a_potentiometers_line_that_has_flipped(bench: BoardWithImage) -> None:
    """Also by a flip in the note which potentiometers there are: a broken wire would not be seen any more."""
    places, mended = kept(bench), 0
    for trial in range(FLIPS):
        address, size = places[trial % len(places)]
        enable(bench)
        bench.wait(bench.random.uniform(0, 60))
        right = bench.board.peek(address, size)
        flip(bench, address + int(bench.random.integers(size)))
        bench.wait(LOOK_MS + 1)
        assert bench.board.peek(address, size) == right
        if bench.motors_on:
            mended += 1  # just as it was written anew, before anybody used it
            continue
        seen = bench.status()
        assert seen.late_ticks == 0
        assert seen.fault is schema.Fault.MEMORY or seen.fault in JUMPS
        apply(bench, *SOFT_START)
    assert mended <= 2


def test_damaged_parameters_are_told_with_the_motors_off_as_well_until_a_set_is_applied(bench: BoardWithImage) -> None:
    address, _ = watched(bench)[1]
    flip(bench, address)
    bench.wait(2 * ROUND_MS)
    assert (bench.status().state, bench.status().fault) == (schema.State.FAULT, schema.Fault.MEMORY)
    with pytest.raises(RuntimeError, match="ClearFault"):
        bench.ask(schema.ClearFaultRequest())
    apply(bench, *SOFT_START)
    with pytest.raises(RuntimeError, match="Apply"):
        bench.apply({"joint2.ze_c": 1}, fresh=True)  # narrower than any set may be: it is no damage
    enable(bench)
    bench.wait(2 * ROUND_MS)
    assert bench.motors_on
