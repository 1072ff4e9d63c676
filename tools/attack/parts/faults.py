"""Measures the time until the motors are off after a fault, and how far the arm has gone by then."""

from __future__ import annotations

from functools import partial

from greywhale_sim.wiring import BOARDS
from tools.attack.arm_faults import LEASE_MS, Trial, arm_at_work, begin, faults, suffer
from tools.attack.copies import in_a_copy
from tools.attack.part import STAYED_ON, Part, Piece, Row, split

MOMENTS, PER_PIECE = 250, 10
AT_ONCE_MS = 10.0
# What takes longer, and why: docs/firmware.md. A hang inside an interrupt is one with interrupts off.
SLOWER_MS = {
    f"lease of {LEASE_MS} ms runs out": LEASE_MS + 2.0,
    "flood of 80 bytes a ms": 30.0,
    "hang, interrupts on": 20.0,
    "hang, interrupts off": 20.0,
    "bit of the running set flips": 103.0,
    "supply sinks by 0.1 V a ms": 24.0,  # 23 ms to the level of the brown-out detector
    "leader floats": 45.0,  # one pot in each tick is read after ground
    "follower floats": 45.0,
    "leader jumps 1 rad in 20 ms": 20.0,  # two looks at its speed
} | {f"{side} {state} 2 of 10 ms": 20.0 for side in ("leader", "follower") for state in ("open", "shorted")}
# Some show only once the person has moved that joint. Then a way counts and not the time: of the follower, and
# where a potentiometer lies only what makes the true error grow.
BY_WRONG_WAY = {"follower frozen", "follower reads neighbour", "follower touches neighbour"}
BY_WAY = {"motor dead", "motor reversed", "follower pot reversed", "joint blocked"}
FARTHEST_RAD = 0.5
# What this costs depends on what the board knows of the arm: a row without and a row with the numbers of `tune`.
BY_TRAVEL = {"follower frozen"}


def is_violation(name: str, trial: Trial) -> bool:
    if name in BY_WRONG_WAY:
        return trial.wrong_rad > FARTHEST_RAD
    if name in BY_WAY:
        return trial.gone_rad > FARTHEST_RAD
    return trial.off_ms is None or trial.off_ms > SLOWER_MS.get(name, AT_ONCE_MS)


def count(board: str, name: str, trial: Trial, limit: str = "") -> Row:
    seen = trial.fault if trial.off_ms is not None else STAYED_ON
    worst = {"rad": round(trial.gone_rad if name in BY_WAY else trial.wrong_rad, 3)} | (
        {} if trial.off_ms is None else {"ms": round(trial.off_ms, 2)}
    )
    return Row(f"{board}: {name}{limit}", 1, int(is_violation(name, trial)), {seen: 1}, worst)


def run(piece: Piece) -> list[Row]:
    """At each moment every fault in a copy of its own: all meet the same motion and the same phase of a tick."""
    arm, known = arm_at_work(piece["board"], piece["seed"])
    chosen = {name: inject for name, inject in faults().items() if name in piece.get("faults", faults())}
    rows = []
    for moment in range(piece["trials"]):
        begin(arm)
        for name, inject in chosen.items():
            trial = in_a_copy(partial(suffer, arm, inject, moment % 4))
            rows.append(count(piece["board"], name, trial, f", {known}" if name in BY_TRAVEL else ""))
    return rows


def pieces(share: float) -> list[Piece]:
    return [piece for board in BOARDS for piece in split(MOMENTS, share, PER_PIECE, board=board)]


PART = Part(
    "faults",
    "From a fault to the motors off",
    f"""Both boards' real images, the default arm, a person's motion, and the paper's controllers before and after
        tuning, those with the numbers of travel that `tune` works out. At {MOMENTS:,} random moments of a run each
        fault begins. The motors must be off within {AT_ONCE_MS:g} ms; within {LEASE_MS + 2} for the lease, 20 for a
        hang (the watchdog's time) and for a wire that touches only 2 ms in 10, 45 for an input that floats, 30 for a
        flood, 20 for a leader that takes 20 ms to jump, 24 for a supply that sinks (the brown-out detector acts after
        23), 103 for a flipped bit. Where a fault shows only once the person moves that joint, a way counts, at most
        {FARTHEST_RAD} rad: of the follower where a motor does not obey or a potentiometer turns the other way, or by
        which the true error has grown where one lies. `ms` is the longest time, `rad` the greatest such way.""",
    (
        "firmware/lib",
        "firmware/src",
        "host/src/greywhale/tune/travel.py",
        "shared",
        "sim/board",
        "sim/arm",
        "sim/bench/greywhale_sim/board_with_image.py",
        "tools/attack/arm_faults.py",
        "tools/attack/arm_on_board.py",
        "tools/attack/pot_lies.py",
    ),
    pieces,
    run,
)
