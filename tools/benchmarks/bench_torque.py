"""Measures what a model that was identified tells of torques from outside: on greywhale's own arm, new and worn, and on
two of MuJoCo's with play at the potentiometers, one with motors that stand apart from their joints.

Each arm is identified from 25 s of following. Then somebody pushes one joint after the other by a quarter to half of
its stall torque, and at last it follows freely. Without MuJoCo (`make oracles`) only the own arms are measured.
"""

from __future__ import annotations

import importlib.util
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.study import Task
from greywhale.base.types import Floats
from greywhale.files.arm import load_arm
from greywhale.files.log import Log
from greywhale.identify import identify
from greywhale.loop import human_reaches
from greywhale.observe import estimate_external_torque
from tools.benchmarks.figure import Figure, at_least, at_most
from tools.benchmarks.study import repeat
from tools.support.foreign_arm import MuJoCoPlant, foreign_arm_with
from tools.support.pushed_arm import OwnPlant, Push, PushedPlant, judge, record_pushed, some_pushes
from tools.support.recordings import record, table_of

OWN = ("default", "worn")
FOREIGN: dict[int, tuple[str, ...]] = {0: (), 5: ("two-masses",)}
IDENTIFIED_S, PUSHED_S = 25.0, 40.0
FREE_S, FOREIGN_FREE_S = 600.0, 120.0
SHARES = (0.25, 0.5)  # of the stall torque
NEVER_S = 999.0
TABLE = "before_tuning"


def own(seed: int) -> dict[str, Floats]:
    arm = load_arm(OWN[seed])
    return measure(arm, lambda start: OwnPlant(arm, start, 5), FREE_S)


def foreign(seed: int) -> dict[str, Floats]:
    arm = foreign_arm_with(seed, FOREIGN[seed])

    def plant(start: Floats) -> PushedPlant:
        found = MuJoCoPlant(arm)
        found.reset(start)
        return found

    return measure(arm.parameters, plant, FOREIGN_FREE_S)


def measure(arm: ArmParameters, plant: Callable[[Floats], PushedPlant], free_s: float) -> dict[str, Floats]:
    """Errors and shares of one arm: by joint, by push, and false contacts in so many seconds of free motion."""
    table = table_of(TABLE)
    with tempfile.TemporaryDirectory() as folder:

        def recorded(seed: int, seconds: float, pushes: list[Push]) -> Log:
            motion, path = human_reaches(seed, seconds), Path(folder) / f"{seed}.csv"
            return record_pushed(plant(motion.angles[0]), arm, motion, path, table, pushes, seed)

        found = identify([recorded(31, IDENTIFIED_S, [])], load_arm("white_box"), tables=[table])
        found.save(Path(folder) / "model.toml")
        model = load_arm(str(Path(folder) / "model.toml"))
        pushes = some_pushes(arm, PUSHED_S, SHARES, 3)
        log = recorded(77, PUSHED_S, pushes)
        judged = judge(estimate_external_torque(log, model), log, arm, pushes)
        if free_s == FREE_S:
            log = record(arm, human_reaches(78, free_s), Path(folder) / "free.csv", table, 78)
        else:
            log = recorded(78, free_s, [])
        free = judge(estimate_external_torque(log, model), log, arm, [])
    return {
        "error": np.array([np.sqrt(np.mean(one**2)) for one in judged.error]),
        "half": np.array([np.median(one) for one in judged.half_width]),
        "held": np.array(np.mean(np.concatenate([*judged.held, *free.held]))),
        "seen": np.nan_to_num(judged.seen, nan=NEVER_S),
        "false in ten minutes": np.array(len(free.false) * 600.0 / free_s),
        "told": np.array([len(one) / len(log.time) for one in free.error]),
    }


def run() -> list[Figure]:
    tasks = [Task(name, own, number) for number, name in enumerate(OWN)]
    if importlib.util.find_spec("mujoco"):
        tasks += [Task(f"MuJoCo's {seed}", foreign, seed) for seed in FOREIGN]
    found = repeat("torque", tasks)
    return [figure for name, one in found.items() for figure in figures(name, one)]


def figures(name: str, one: dict[str, Floats]) -> list[Figure]:
    within = float(np.mean(one["seen"] <= 0.05))
    joints = range(len(one["error"]))
    return [
        *(at_most(f"{name}: error of joint {n}, rms of stall", percent(one["error"][n]), "%", 10) for n in joints),
        *(Figure(f"{name}: half width of joint {n}, of stall", percent(one["half"][n]), "%") for n in joints),
        *(Figure(f"{name}: told of free motion, joint {n}", percent(one["told"][n]), "%") for n in joints),
        at_least(f"{name}: intervals that hold", percent(one["held"]), "%", 90),
        at_least(f"{name}: of {len(one['seen'])} pushes seen within 50 ms", percent(within), "%", 90),
        Figure(f"{name}: pushes seen at all", percent(float(np.mean(one["seen"] < NEVER_S))), "%"),
        at_most(f"{name}: false contacts in ten minutes", float(one["false in ten minutes"]), "", 1),
    ]


def percent(share: float | Floats) -> float:
    return 100.0 * float(share)
