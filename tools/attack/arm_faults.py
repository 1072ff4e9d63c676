"""Everything that can go wrong with an arm on the pins of the real image: each injected by name at a moment of a run.

A trial is the real image on the simulated board with the default arm: a leader that a person moves, everything in
order, and at a random moment a fault. A leader that a person moves makes the error grow as well.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from greywhale.base.types import Floats
from greywhale.board.device import stop_message
from greywhale.files import controller
from greywhale.files.arm import default_arm
from greywhale.files.paper_tables import paper_table
from greywhale.loop import human_reaches
from greywhale.protocol import frames, schema
from greywhale.protocol.table import ParameterTable
from greywhale.tune.travel import travel_of
from greywhale_sim.board_with_image import CYCLES_PER_TICK
from tools.attack import pot_lies
from tools.attack.arm_on_board import SLICE_S, ArmOnBoard, Leader
from tools.attack.pot_lies import Inject, jump, leader, shift, to_and_fro, two_leaders

PATIENCE_S = 2.0
SOFT_START_MS = 100
CHATTER = ((2, 3), (1, 2), (2, 4), (2, 10))  # ms at the rail, of so many
LEASE_MS = 20
SINKS_MV_PER_MS = 100.0
FLOOD_BYTES = 20  # in each slice of 250 us: 80 a millisecond


@dataclass(frozen=True)
class Trial:
    """Until the motors went off (`off_ms` None: never) the follower had gone `gone_rad`, and `wrong_rad` of it had made
    the true error grow: where it stands and the person leads away, it does not run."""

    off_ms: float | None
    wrong_rad: float
    gone_rad: float
    fault: str
    where: int


def reverse_motor(arm: ArmOnBoard, joint: int) -> None:
    arm.motor_signs[joint] = -1.0


def block(arm: ArmOnBoard, joint: int) -> None:
    arm.stuck[joint] = float(arm.angles[joint])


def _press_estop(arm: ArmOnBoard, joint: int) -> None:
    arm.board.hold_pin(arm.wiring.estop.port, arm.wiring.estop.bit, False)


def _cut_motor(arm: ArmOnBoard, joint: int) -> None:
    arm.motor_signs[joint] = 0.0


def _send_stop(arm: ArmOnBoard, joint: int) -> None:
    arm.board.uart_send(stop_message(7))


def _end_lease(arm: ArmOnBoard, joint: int) -> None:
    """The host renews for a short time and is gone."""
    arm.board.uart_send(frames.encode_frame(schema.RenewRequest.TYPE, 7, LEASE_MS.to_bytes(2, "little")))


def _flood(arm: ArmOnBoard, joint: int) -> None:
    def pour(volts: Floats, since: float) -> None:
        arm.board.uart_send(arm.random.bytes(FLOOD_BYTES))

    arm.pot_fault = pour


def _hang(interrupts: bool) -> Inject:
    """Into the endless loop behind main(), which begins with turning interrupts off, or just behind that."""

    def inject(arm: ArmOnBoard, joint: int) -> None:
        arm.board.pc = arm.symbols["_exit"].address + 2 * interrupts

    return inject


def _flip_bit(arm: ArmOnBoard, joint: int) -> None:
    """Of the running set."""
    at = arm.running_set + int(arm.random.integers(schema.TABLE.size))
    arm.board.poke(at, bytes([arm.board.peek(at, 1)[0] ^ 1 << int(arm.random.integers(8))]))


def _sink(arm: ArmOnBoard, joint: int) -> None:
    """The board's supply falls by 0.1 V a millisecond to 2 V, the potentiometers' with it."""

    def fall(volts: Floats, since: float) -> None:
        supply = max(2000.0, 5000.0 - SINKS_MV_PER_MS * 1000 * since)
        arm.board.set_supply(round(supply))
        volts *= supply / 5000.0

    arm.pot_fault = fall


def leader_jumps() -> dict[str, Inject]:
    """A leader's reading that no hand makes, by name."""
    at_once = {f"leader jumps {way:g} rad": shift(leader, jump(way)) for way in (0.3, 1.0, 2.0)}
    within = {f"leader jumps 1 rad in {ms} ms": shift(leader, jump(1.0, ms / 1000)) for ms in (5, 20)}
    return {
        **at_once,
        **within,
        "leader jumps 1 rad to and fro": shift(leader, to_and_fro(1.0, 0.003)),
        "leader jumps to the end of its track": pot_lies.leave_range,
        "two leaders jump 1 rad": shift(two_leaders, jump(1.0)),
    }


def faults() -> dict[str, Inject]:
    """Everything that can be injected, by name."""
    found: dict[str, Inject] = {
        "stop request": _send_stop,
        "emergency stop pressed": _press_estop,
        f"lease of {LEASE_MS} ms runs out": _end_lease,
        "flood of 80 bytes a ms": _flood,
        "hang, interrupts on": _hang(True),
        "hang, interrupts off": _hang(False),
        "bit of the running set flips": _flip_bit,
        "supply sinks by 0.1 V a ms": _sink,
    }
    for side, follower in (("leader", False), ("follower", True)):
        found[f"{side} floats"] = pot_lies.leave_floating(follower)
        for state, rail in (("open", 0.0), ("shorted", 5000.0)):
            found[f"{side} {state}"] = pot_lies.at_rail(rail, follower)
            for pattern in CHATTER:
                found[f"{side} {state} {pattern[0]} of {pattern[1]} ms"] = pot_lies.at_rail(rail, follower, pattern)
    return {
        **found,
        **leader_jumps(),
        "motor dead": _cut_motor,
        "follower frozen": pot_lies.freeze,
        "follower reads neighbour": pot_lies.read_neighbour,
        "follower touches neighbour": pot_lies.touch_neighbour,
        "motor reversed": reverse_motor,
        "follower pot reversed": pot_lies.reverse,
        "joint blocked": block,
    }


def person(seed: int) -> Leader:
    """A leader that a person moves, without a rest at the beginning; worked out once for every slice."""
    motion = human_reaches(seed)
    times, angles = np.asarray(motion.time_s), np.asarray(motion.angles)
    moves = int(np.argmax(np.abs(angles - angles[0]).max(axis=1) > 0.02))
    slices = times[moves] + SLICE_S * np.arange(math.ceil((times[-1] - times[moves]) / SLICE_S) + 1)
    path = np.column_stack([np.interp(slices, times, angles[:, joint]) for joint in range(4)])

    def at(seconds: float) -> Floats:
        place: Floats = path[min(round(seconds / SLICE_S), len(path) - 1)]
        return place

    return at


def tuned_travel() -> dict[str, int]:
    """The travel of each joint for a voltage, as `greywhale tune` works it out for the default arm, raw."""
    travel = travel_of(default_arm(), ParameterTable.defaults(), samples=1)
    assert travel is not None
    return travel.raw()


def arm_at_work(board: str, seed: int) -> tuple[ArmOnBoard, str]:
    """A board with its arm, and what it knows of how far a voltage moves that.

    Even seeds run the paper's untuned controllers, odd ones its tuned ones and the numbers of travel that belong to
    the arm. Unrest is off: the tuned ones make a joint of this arm ring at times, which is not the fault that is meant.
    """
    travel = tuned_travel() if seed % 2 else {}
    arm = ArmOnBoard(board, person(seed), seed)
    table = paper_table(("before_tuning", "table_10")[seed % 2])
    changes = {key: int(raw) for key, raw in controller.load(table).raw_values().items()}
    arm.run_set(changes | {"soft_start_ms": SOFT_START_MS, "unrest_amplitude": 0} | travel)
    return arm, "travel known" if travel else "travel unknown"


def begin(arm: ArmOnBoard) -> None:
    """All in order, and some of a motion done: the moment for a fault."""
    arm.start()
    arm.wait(SOFT_START_MS + 1000 * arm.random.uniform(0.3, 3.0))
    assert arm.motors_on, f"nothing was wrong yet, but the board says {arm.status().fault.key}"
    arm.shift_phase()


def suffer(
    arm: ArmOnBoard,
    inject: Inject,
    joint: int,
    patience_s: float = PATIENCE_S,
    note: Callable[[], None] = lambda: None,
) -> Trial:
    """From the fault to the motors off; the arm can be used again. `note` is done after each slice with motors on."""
    before = abs(arm.true_error[joint])
    begun, place, wrong, gone = arm.board.cycle, arm.angles[joint], 0.0, 0.0
    inject(arm, joint)
    off_ms = None
    for _ in range(round(patience_s / SLICE_S)):
        arm.slice()
        if not arm.motors_on:
            off_ms = (arm.board.cycle - begun) / CYCLES_PER_TICK
            break
        note()
        way = abs(arm.angles[joint] - place)
        wrong, gone = max(wrong, min(way, abs(arm.true_error[joint]) - before)), max(gone, way)
    arm.pot_fault = None
    arm.board.set_supply(5000)
    status = arm.status()
    return Trial(off_ms, float(wrong), float(gone), status.fault.key, status.fault_where)
