"""Random assemblies on the bench: does calibrating make them follow like the calibrated one, are mistakes named?

Each assembly has another zero, direction and track at all eight potentiometers, and one motor the wrong way round.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import numpy as np

from greywhale.demo import BenchProcess, record_motion
from greywhale.files.arm import default_arm
from greywhale.files.leader import save_leader
from greywhale.measure import evaluate
from greywhale.study import Task
from greywhale.trajectory import human_reaches
from tools.bench.figure import Figure
from tools.bench.hands import SECOND_DEG, Hands, bench_of, mounted_anyhow, run_calibrate
from tools.bench.study import repeat

ASSEMBLIES = 20
WORKERS = 2
LIKE = 0.1
SECOND = ("--second", ",".join(f"{angle:g}" for angle in SECOND_DEG))


@dataclass(frozen=True)
class Mistake:
    """`stage` gives the bench's commands for a joint; the verb must then say what `says` matches."""

    name: str
    stage: Callable[[int], list[str]]
    says: Callable[[int], str]


def _next(joint: int) -> int:
    return (joint + 1) % 4


MISTAKES = (
    Mistake(
        "potentiometers swapped",
        lambda joint: [f"swap leader{joint} leader{_next(joint)}"],
        lambda joint: rf"eader potentiometer {min(joint, _next(joint))} .* their wires are swapped",
    ),
    Mistake(
        "arms swapped",
        lambda joint: [f"swap leader{joint} follower{joint}"],
        lambda joint: rf"eader potentiometer {joint} .* the two arms are swapped",
    ),
    Mistake(
        "shaft does not turn",
        lambda joint: [f"pot follower {joint} frozen"],
        lambda joint: rf"ollower potentiometer {joint} .* did not move: check that its shaft",
    ),
    Mistake(
        "open", lambda joint: [f"pot leader {joint} open"], lambda joint: rf"eader potentiometer {joint} .* a rail"
    ),
    Mistake(
        "shorted",
        lambda joint: [f"pot follower {joint} shorted"],
        lambda joint: rf"ollower potentiometer {joint} .* at a rail",
    ),
    Mistake(
        "loose wire",
        lambda joint: [f"pot leader {joint} loose"],
        lambda joint: rf"eader potentiometer {joint} (jumped \d+ times|reaches an end)",
    ),
    Mistake(
        "shaft slips",
        lambda joint: [f"pot follower {joint} slipping"],
        lambda joint: rf"ollower potentiometer {joint} (reads? \d+|reaches an end|turned the other way)",
    ),
    Mistake(
        "motors swapped",
        lambda joint: [f"motor {joint} {_next(joint)}", f"motor {_next(joint)} {joint}"],
        lambda joint: r"the motor of joint \d moved joint \d: their motors",
    ),
    Mistake(
        "motor dead",
        lambda joint: [f"motor {joint} dead"],
        lambda joint: rf"the motor of joint {joint} did not move it",
    ),
)


def error_of(bench: BenchProcess, folder: Path) -> float:
    """The mean squared error, rad², of all joints with the controllers that the board has, under a person's motion."""
    leader = folder / "leader.csv"
    save_leader(leader, human_reaches(1, 12.0))
    log = record_motion(bench, leader, folder / "log.csv").log()
    return float(sum(joint.mse for joint in evaluate(log).joints))


def assembled(seed: int) -> float:
    """The error of a random assembly after `greywhale calibrate`."""
    with tempfile.TemporaryDirectory() as name, bench_of(mounted_anyhow(seed), Path(name)) as bench:
        bench.command(f"motor {seed % 4} reversed")
        done = run_calibrate(Hands(bench), Path(name), *SECOND)
        return error_of(bench, Path(name)) if done.code == 0 else np.inf


def is_named(seed: int, number: int) -> bool:
    """Whether a mistake of a random assembly is named, at the first try, and nothing is stored."""
    mistake, joint = MISTAKES[number], (seed + number) % 4
    with tempfile.TemporaryDirectory() as name, bench_of(mounted_anyhow(seed), Path(name)) as bench:
        for command in mistake.stage(joint):
            bench.command(command)
        done = run_calibrate(Hands(bench), Path(name), *SECOND)
        named = re.search(mistake.says(joint), done.said) is not None
        return done.code == 1 and named and not bench.command("status")["eeprom_writes"]


def run() -> list[Figure]:
    with tempfile.TemporaryDirectory() as name, bench_of(default_arm(), Path(name)) as bench:
        usual = error_of(bench, Path(name))
    seeds = range(1, ASSEMBLIES + 1)
    tries = [
        [Task(f"{seed}, {one.name}", is_named, seed, {"number": n}) for seed in seeds] for n, one in enumerate(MISTAKES)
    ]
    tasks = [Task(f"{seed}", assembled, seed) for seed in seeds]
    found = repeat("calibrate", [*tasks, *chain(*tries)], WORKERS)
    ratios = np.array([found[task.key] for task in tasks]) / usual
    named = [sum(found[task.key] for task in of_mistake) for of_mistake in tries]
    apart = float(np.abs(ratios - 1.0).max())
    return [
        Figure("error of 20 assemblies / calibrated bench, farthest from 1", apart, "", f"<= {LIKE}", apart <= LIKE),
        *(
            Figure(f"{mistake.name}: named in so many assemblies", count, "", f"{ASSEMBLIES}", count == ASSEMBLIES)
            for mistake, count in zip(MISTAKES, named, strict=True)
        ),
    ]
