"""Random assemblies on the bench: does calibrating make them follow like the calibrated one, are mistakes named?

Each assembly has another zero, direction and track at all eight potentiometers, and one motor the wrong way round.
"""

from __future__ import annotations

import contextlib
import io
import re
import tempfile
from itertools import chain
from pathlib import Path

import numpy as np

from greywhale.base.study import Task
from greywhale.board.calibrate.rules import PULSE_SHARES
from greywhale.cli.entry import run as verb
from greywhale.cli.story import RunningBench, record_motion
from greywhale.files.arm import default_arm
from greywhale.files.leader import save_leader
from greywhale.loop import human_reaches
from greywhale.measure import evaluate
from greywhale_sim.faults import BY_NAME, FAULTS, WHERE
from tools.benchmarks.figure import Figure, at_most
from tools.benchmarks.study import repeat
from tools.support.calibrating_person import SECOND_DEG, CalibratingPerson, bench_of, mounted_anyhow, run_calibrate

ASSEMBLIES = 20
WORKERS = 2
LIKE = 0.1
SECOND = ("--second", ",".join(f"{angle:g}" for angle in SECOND_DEG))


def error_of(bench: RunningBench, folder: Path) -> float:
    """The mean squared error, rad², of all joints with the controllers that the board has, under a person's motion."""
    leader = folder / "leader.csv"
    save_leader(leader, human_reaches(1, 12.0))
    log = record_motion(bench, leader, folder / "log.csv").log()
    return float(sum(joint.mse for joint in evaluate(log).joints))


def assembled(seed: int) -> float:
    """The error of a random assembly after `greywhale calibrate`."""
    with tempfile.TemporaryDirectory() as name, bench_of(mounted_anyhow(seed), Path(name)) as bench:
        bench.command(f"motor {seed % 4} reversed")
        done = run_calibrate(CalibratingPerson(bench), Path(name), *SECOND)
        return error_of(bench, Path(name)) if done.code == 0 else np.inf


def is_named(seed: int, name: str) -> bool:
    """True if its verb names a mistake of a random assembly, at the first try, and stores nothing it should not."""
    fault = BY_NAME[name]
    places = WHERE[fault.on]
    arm = mounted_anyhow(seed)
    pots = (*arm.leader_pots.joint, *arm.follower_pots.joint)
    number = (seed + FAULTS.index(fault)) % len(places)
    if name == "pot-reversed":  # one that is the right way round before
        number = next(pot for pot in (*range(number, 8), *range(8)) if pots[pot].direction > 0)
    with tempfile.TemporaryDirectory() as folder, bench_of(arm, Path(folder)) as bench:
        bench.command(f"mistake {name}" + (f":{places[number]}" if places[number] else ""))
        if fault.verb == "calibrate":
            done = run_calibrate(CalibratingPerson(bench), Path(folder), *SECOND)
            code, output = done.code, done.said + done.printed
        else:
            bench.command("hand both 0.1 -0.6 0.7 0.4")
            out = io.StringIO()
            with contextlib.redirect_stdout(out):
                code = verb(["doctor", "--port", bench.port, "--seconds", "0.5", "--json", *fault.options])
            output = out.getvalue()
        named = re.search(fault.tells(number), output) is not None
        within = max(bench.command("pins")["duties"]) <= PULSE_SHARES[-1] + 1 / 400
        stored = bool(bench.command("status")["eeprom_writes"])
        return named and within and code == int(fault.ends == "refused") and (code == 0 or not stored)


def run() -> list[Figure]:
    with tempfile.TemporaryDirectory() as name, bench_of(default_arm(), Path(name)) as bench:
        usual = error_of(bench, Path(name))
    seeds = range(1, ASSEMBLIES + 1)
    tries = [[Task(f"{seed}, {one.name}", is_named, seed, {"name": one.name}) for seed in seeds] for one in FAULTS]
    tasks = [Task(f"{seed}", assembled, seed) for seed in seeds]
    found = repeat("calibrate", [*tasks, *chain(*tries)], WORKERS)
    ratios = np.array([found[task.key] for task in tasks]) / usual
    named = [sum(found[task.key] for task in of_fault) for of_fault in tries]
    apart = float(np.abs(ratios - 1.0).max())
    return [
        at_most("error of 20 assemblies / calibrated bench, farthest from 1", apart, "", LIKE),
        *(
            Figure(f"{fault.name}: named in so many assemblies", count, "", f"{ASSEMBLIES}", count == ASSEMBLIES)
            for fault, count in zip(FAULTS, named, strict=True)
        ),
    ]
