"""The AVR binary on the bench, recorded slice by slice, for comparison with the native closed loop."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from greywhale.arm import ArmParameters
from greywhale.base.types import Floats
from greywhale.files.trajectory import Trajectory
from greywhale.loop import Timing
from greywhale.protocol import schema
from greywhale.protocol.frames import FrameDecoder, encode_frame
from greywhale_sim.assemble import BenchOptions, build_board, wiring_of
from greywhale_sim.bench import SLICE_CYCLES, SLICE_S, Bench
from greywhale_sim.leader_player import LeaderPlayer
from tests.support.arms import make_arm

TICK_CYCLES = 16000
ADCSRA = 0x7A
ADC_CLOCK_CYCLES = 32
CONVERSION_CYCLES = 416
HOLD_CYCLES = 48
CHAIN_AFTER_TICK = 2208
INSIDE_CYCLES = 200  # a tick begins so far inside of a slice, so that there is no doubt in which
INSTRUCTION_CYCLES = 5  # the longest; the board is looked at between two instructions
ADATE = 0x20  # set while a tick's conversions follow each other
BOOT_S = 4.0


@dataclass(frozen=True)
class Recording:
    """From the slice in which the motors came on: the leader, what the pins said, where the follower was after it."""

    timing: Timing
    gap_position: Floats  # -1..1
    leader: Floats  # (slices, 4) rad
    duties: Floats  # (slices, 4) -1..1, as the pins are when the slice begins
    angles: Floats  # (slices, 4) rad


def quiet(parameters: ArmParameters) -> ArmParameters:
    """A copy of the arm with potentiometers that make no noise."""
    silent = {"joint": {"noise": 0.0}}
    return make_arm(parameters, leader_pots=silent, follower_pots=silent)


def record(parameters: ArmParameters, motion: Trajectory, seconds: float, board: str = "mega") -> Recording:
    """Switch on at such a moment that no slice ends where the firmware reads or writes; enable and watch."""
    natural = _Watched(parameters, motion, board, delay=0)
    start = natural.boot()
    natural.follow(2.0)
    timing = clear_of_slices(natural.write_times())
    watched = _Watched(parameters, motion, board, delay=(timing.chain_start - start) % SLICE_CYCLES)
    assert (watched.boot() - timing.chain_start + INSTRUCTION_CYCLES) % SLICE_CYCLES <= 2 * INSTRUCTION_CYCLES
    recording = watched.follow(seconds)
    return replace(recording, timing=replace(timing, drivers_on=recording.timing.drivers_on))


def _clearance(start: int, written: Floats, held: npt.NDArray[np.intp]) -> float:
    """Cycles from a slice boundary to the nearest write, or ten times those to a conversion, which is exact."""
    if ((written[:, 0] + start) // SLICE_CYCLES != (written[:, 1] + start) // SLICE_CYCLES).any():
        return 0.0
    half = SLICE_CYCLES // 2
    from_write = np.abs((written + start + half) % SLICE_CYCLES - half).min()
    from_conversion = np.abs((held + start + half) % SLICE_CYCLES - half).min()
    return float(min(from_write, 10 * from_conversion))


def clear_of_slices(written: Floats) -> Timing:
    """The timing with slice boundaries furthest from all that matters; `written` (4, 2): earliest and latest cycle."""
    held = CONVERSION_CYCLES * np.arange(32, dtype=np.intp) + HOLD_CYCLES
    first, last = CHAIN_AFTER_TICK + INSIDE_CYCLES, CHAIN_AFTER_TICK + SLICE_CYCLES - INSIDE_CYCLES
    best = max(range(first, last, 8), key=lambda start: _clearance(start, written, held))
    assert _clearance(best, written, held) > 0, f"the firmware's writes are spread too far: {written}"
    acts = [int(slice_number) + 1 for slice_number in (written[:, 0] + best) // SLICE_CYCLES]
    return Timing(best, (acts[0], acts[1], acts[2], acts[3]))


class _Watched:
    """A bench whose board is switched on `delay` cycles late."""

    def __init__(self, parameters: ArmParameters, motion: Trajectory, board: str, delay: int) -> None:
        options = BenchOptions(board=board)
        self.board: Any = build_board(options)
        self.board.power_off(1)
        self.board.run_until(self.board.cycle + TICK_CYCLES - self.board.cycle % TICK_CYCLES + delay)
        self.board.power_on(1)
        self.parameters = parameters
        self.bench = Bench(
            board=self.board,
            wiring=wiring_of(board),
            plant=parameters,
            leader=LeaderPlayer(motion, SLICE_S),
            pots=(parameters.leader_pots, parameters.follower_pots),
            supply_v=parameters.drive.supply,
        )
        self.decoder = FrameDecoder()

    def boot(self) -> int:
        """Until the firmware says hello; when its tick's first conversion begins (cycles of a slice)."""
        for _ in range(round(BOOT_S / 0.01)):
            self.bench.run(0.01)
            if any(frame.type == schema.HelloReply.TYPE for frame in self.decoder.feed(self.board.uart_receive())):
                return self._chain_start()
        raise AssertionError(f"no hello within {BOOT_S} s")

    def _chain_start(self) -> int:
        """Cycles from a slice's beginning to a tick's first conversion, found by watching the converter start."""
        board = self.board
        for wanted, step in ((False, 400), (True, 1)):
            for _ in range(2 * TICK_CYCLES):
                if bool(board.peek(ADCSRA)[0] & ADATE) is wanted:
                    break
                board.run_until(board.cycle + step)
            else:
                raise AssertionError("the converter never runs")
        # The first conversion begins with the next ADC clock, which is free-running since the converter was enabled.
        return int(board.cycle % SLICE_CYCLES) + ADC_CLOCK_CYCLES // 2

    def write_times(self, ticks: int = 150) -> Floats:
        """Cycles from a tick's first conversion to a joint's duty being written: earliest and latest, (4, 2)."""
        board = self.board
        self._chain_start()
        chain = board.cycle
        seen: list[list[int]] = [[] for _ in range(4)]
        for _ in range(ticks):
            self.bench.run_slices(4)
            end = board.cycle + TICK_CYCLES
            before = board.outputs()[1:5].copy()
            while board.cycle < end:
                board.run_until(board.cycle + 40)
                duties = board.outputs()[1:5]
                for joint in np.flatnonzero(duties != before):
                    seen[joint].append((board.cycle - chain + TICK_CYCLES // 2) % TICK_CYCLES - TICK_CYCLES // 2)
                before = duties.copy()
        assert all(seen), f"duties hardly ever changed: {[len(times) for times in seen]} times; does the arm follow?"
        return np.array([[min(times) - 60, max(times) + 60] for times in seen])

    def follow(self, seconds: float) -> Recording:
        """Enable, and keep everything from the tick on in whose course the drivers come on."""
        bench = self.bench
        rows: list[tuple[Floats, Floats, Floats]] = []
        start: list[tuple[int, Floats]] = []
        half_gap = np.array([joint.gear.half_gap for joint in self.parameters.joint])

        def trace(cycle: int, pins: Floats, angles: Floats) -> None:
            if pins[0] and not start:
                moved = bench.own_arm
                assert moved is not None
                start.append((cycle - SLICE_CYCLES, (moved.motor_angles - moved.angles) / half_gap))
            if start:
                rows.append((bench.leader.angles.copy(), pins[1:5] * (2.0 * pins[5:9] - 1.0), angles.copy()))

        bench.trace = trace
        self.board.uart_send(encode_frame(schema.EnableRequest.TYPE, 1, schema.EnableRequest(0).pack()))
        bench.run(seconds)
        assert start, "the motors never came on"
        assert bench.motors_enabled, "the motors went off on the way"
        leader, duties, angles = (np.array(column) for column in zip(*rows, strict=True))
        chain_start = self._chain_start()
        first_conversion = self.board.cycle + ADC_CLOCK_CYCLES // 2
        tick_slice = (first_conversion - CHAIN_AFTER_TICK) // SLICE_CYCLES * SLICE_CYCLES
        on = (start[0][0] - tick_slice - SLICE_CYCLES) % TICK_CYCLES // SLICE_CYCLES + 1
        return Recording(
            timing=Timing(chain_start, drivers_on=on),
            gap_position=start[0][1],
            leader=np.vstack([leader[:1]] * on + [leader]),
            duties=np.vstack([np.zeros((on, 4)), duties]),
            angles=np.vstack([angles[:1]] * on + [angles]),
        )
