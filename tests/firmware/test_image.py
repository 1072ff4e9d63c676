"""The real firmware images on the simulated chips: what unit tests cannot show, because it is about time and memory."""

from __future__ import annotations

import pytest

from greywhale.protocol import frames, schema
from greywhale_sim.board_with_image import UNWATCHED, BoardWithImage, ram_of_a_life
from greywhale_sim.wiring import BOARDS

BYTES_A_MS = 100  # what the wire carries at 1 Mbaud


def babble(bench: BoardWithImage, ms: int) -> None:
    """Random bytes without a gap; at the end a zero, so that the next frame is not taken for part of the noise."""
    bench.board.uart_send(bench.random.bytes(ms * BYTES_A_MS) + b"\0")
    bench.wait(ms + 2)


def test_a_babbling_host_neither_starts_the_motors_nor_delays_a_tick(bench: BoardWithImage) -> None:
    babble(bench, 1000)
    seen = bench.status()
    assert seen.state == schema.State.DISABLED
    assert seen.late_ticks == 0
    assert seen.frames_bad > 0
    assert seen.rx_overruns > 0


def test_a_babbling_host_delays_no_tick_of_a_moving_arm_and_ends_in_a_fault(bench: BoardWithImage) -> None:
    bench.ask(schema.TelemetryRequest(1))
    bench.ask(schema.EnableRequest(0))
    babble(bench, 500)
    seen = bench.status()
    assert (seen.state, seen.fault) == (schema.State.FAULT, schema.Fault.FLOOD)
    assert seen.late_ticks == 0
    assert bench.ask(schema.ClearFaultRequest()).state == schema.State.DISABLED


def test_the_board_counts_the_sets_that_were_stored(bench: BoardWithImage) -> None:
    assert bench.status().saves == 0, "its EEPROM is blank"
    for saves, limit in enumerate((4096, 4506, 4506, 4915)):
        bench.apply({"tracking_limit": limit}, fresh=True)
        bench.save()
        assert bench.status().saves == (saves + 1 if saves < 2 else saves), "the same set again writes nothing"
    bench.board.reset()
    bench.wait(100)
    assert bench.status().saves == 3


def test_enabling_right_after_applying_works(bench: BoardWithImage) -> None:
    bench.ask(schema.ParamApplyRequest(schema.param_crc(schema.DEFAULTS)))
    bench.ask(schema.EnableRequest(0))
    bench.wait(1200)
    assert bench.status().state == schema.State.FOLLOWING


def test_a_reset_while_the_motors_run_leaves_them_off(bench: BoardWithImage) -> None:
    bench.apply(UNWATCHED)  # its follower stays where it is
    bench.millivolts[0] += 300
    bench.board.set_millivolts(bench.millivolts)
    bench.ask(schema.EnableRequest(0))
    bench.wait(500)
    assert bench.duty() > 0.05
    bench.board.reset()
    for _ in range(100):
        bench.wait(1)
        assert bench.duty() == 0
    assert bench.status().stop_reason == schema.StopReason.RESET


def test_a_damaged_newest_set_is_a_fault_until_the_host_has_confirmed_one(bench: BoardWithImage) -> None:
    for sign in (1, -1):
        bench.apply({"joint1.motor_sign": sign}, fresh=True)
        bench.save()
    content = bytearray(bench.board.eeprom())
    content[300] ^= 1  # in bank B, which holds the second set
    bench.board.set_eeprom(bytes(content))
    bench.board.reset()
    bench.wait(60)
    assert (bench.status().state, bench.status().fault) == (schema.State.FAULT, schema.Fault.PARAMS)
    with pytest.raises(RuntimeError, match="ClearFault"):
        bench.ask(schema.ClearFaultRequest())
    bench.apply({"joint1.motor_sign": -1}, fresh=True)
    assert bench.ask(schema.ClearFaultRequest()).state == schema.State.DISABLED


def leader(bench: BoardWithImage) -> tuple[int, ...]:
    """The leader's angles in the last sample of a tenth of a second."""
    bench.wait(100)
    frames_heard = frames.FrameDecoder().feed(bench.board.uart_receive())
    samples = [frame for frame in frames_heard if frame.type == schema.Sample.TYPE]
    return schema.Sample.unpack(samples[-1].payload).leader


def test_a_host_that_leads_costs_the_tick_nothing_and_delays_none(bench: BoardWithImage) -> None:
    bench.ask(schema.TelemetryRequest(1))
    bench.ask(schema.EnableRequest(0))
    bench.wait(1100)
    by_pots = max(bench.tick_cycles()[1] for _ in range(50))
    bench.ask(schema.StopRequest())
    reply = bench.ask(schema.LeadRequest(60000))
    bench.wait(1100)
    assert (
        max(bench.tick_cycles()[1] for _ in range(50)) <= by_pots + 10
    )  # the same work: pots agree as the reference does
    number, taken = reply.next, []
    for step in [*range(0, 40, 8), *range(40, -32, -8), *range(-32, 8, 8)]:
        taken.append(step)
        number = bench.ask(schema.LeadPointRequest(number, (step, -step, step // 2, 0))).next
        bench.wait(14.5)
    assert max(bench.tick_cycles()[1] for _ in range(50)) <= 3200
    assert number == (reply.next + len(taken)) % 256
    after = bench.ask(schema.LeadRequest(60000))
    assert after.reference[0] == reply.reference[0] + 4 * sum(taken)
    assert leader(bench) == after.reference
    assert bench.status().state == schema.State.FOLLOWING
    assert bench.status().late_ticks == 0


@pytest.mark.parametrize("name", BOARDS)
def test_variables_and_the_deepest_stack_leave_a_nano_240_bytes(name: str) -> None:
    assert ram_of_a_life(name) <= 1808
