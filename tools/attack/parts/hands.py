"""Measures what the arm does under a hand that leans on it for a while, and once that lets go."""

from __future__ import annotations

import numpy as np

from greywhale.arm.parameters import JOINT_NAMES
from greywhale_sim.wiring import BOARDS
from tools.attack.hands import TUNED, UNTUNED, ArmAndHand, Hand, hands
from tools.attack.part import Part, Piece, Row
from tools.attack.parts import faults

HELD_S, WATCHED_S = 10.0, 2.0
POSES_RAD = 0.5  # to either side


def lean_and_let_go(board: str, name: str, hand: Hand, seed: int) -> tuple[str, float]:
    """The fault that a hand brought about, and the joint's greatest speed afterwards in rad/s."""
    pose = np.random.default_rng(seed).uniform(-POSES_RAD, POSES_RAD, 4)
    arm = ArmAndHand(board, name, pose, seed)
    fastest = arm.let_go(hand.joint, WATCHED_S) if arm.lean(hand, HELD_S) else 0.0
    return "none" if arm.motors_on else arm.status().fault.key, fastest


def run(piece: Piece) -> list[Row]:
    rows = []
    for hand in hands(piece["joint"])[piece["begin"] :: piece["step"]]:
        speeds = {}
        for name in (UNTUNED, TUNED):
            fault, speeds[name] = lean_and_let_go(piece["board"], name, hand, piece["seed"])
            counts = {} if fault == "none" else {fault: 1}
            worst = {"rad/s": round(speeds[name], 1)}
            if name == TUNED and speeds[UNTUNED]:
                worst["times untuned"] = round(speeds[TUNED] / speeds[UNTUNED], 2)
            joint = JOINT_NAMES[hand.joint]
            rows.append(Row(f"{piece['board']}: {joint}, {name}", 1, int(fault != "none"), counts, worst))
    return rows


def pieces(share: float) -> list[Piece]:
    """Every so many-th hand at each joint."""
    step = max(1, round(1 / share))
    return [
        {"board": board, "joint": joint, "seed": joint, "begin": joint % step, "step": step}
        for board in BOARDS
        for joint in range(4)
    ]


PART = Part(
    "hands",
    "A hand leans on the arm and lets go",
    f"""A hand leans on one joint of the default arm for {HELD_S:g} s, 0.3 or 0.5 rad from its leader, like a spring of
        20 to 400 N m/rad (roll: 3 to 20), damped or not. No fault may come of that. `rad/s` is the joint's greatest
        speed within {WATCHED_S:g} s of its release, `times untuned` that of the tuner's controllers beside the paper's
        untuned ones.""",
    (*faults.PART.depends, "host/src/greywhale/tune", "tools/attack/hands.py"),
    pieces,
    run,
)
