"""Five minutes of a person's work with an arm that changes, on the bench in lock step: adapted, and left alone.

The arm is practised with, identified and tuned for before it changes. Searches take no time of the bench here; on a
computer of its own one takes some ten seconds. GREYWHALE_ADAPT names the cases to run, GREYWHALE_BUDGET the
evaluations of a search.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.adapt import BUDGET, AdaptationRequest, adapt
from greywhale.adapt.decide import HALF_MINUTE, LIMIT
from greywhale.arm import ArmParameters
from greywhale.arm.parameters import Tip
from greywhale.arm.plants import plant_row
from greywhale.base.study import SerialWorkers, Task
from greywhale.base.types import Controllers, Floats
from greywhale.board.device import Device
from greywhale.board.record import record
from greywhale.board.upload import upload_set
from greywhale.cli.story.learn import learn
from greywhale.cli.story.practice import tables
from greywhale.files.arm import default_arm, load_arm
from greywhale.motion import human_reaches
from greywhale.protocol.table import ParameterTable
from greywhale.simulate import Experiment
from greywhale.simulate.controllers import controllers_of
from greywhale.tune import tune
from greywhale.tune.model import load_model
from tools.benchmarks.figure import Figure
from tools.benchmarks.study import repeat
from tools.benchmarks.tuning import practised
from tools.support.worker import stickier, working_bench

WORK_S = 300.0
PERSON = 3  # seed of the motions
LOADED_AFTER_S, LOAD_KG = 60.0, 0.3
OF_TUNED = 1.15


def loaded(seconds: float) -> ArmParameters:
    """The default arm, which takes up a load."""
    arm = default_arm()
    return arm.model_copy(update={"tip": Tip(mass=LOAD_KG)}) if seconds >= LOADED_AFTER_S else arm


CASES: dict[str, Callable[[float], ArmParameters]] = {
    "friction +40 % within 2 min": stickier,
    f"{LOAD_KG} kg at the tip": loaded,
    "an unchanged arm": lambda seconds: default_arm(),
}
CHOSEN = os.environ.get("GREYWHALE_ADAPT", ",".join(CASES)).split(",")
SEARCH_BUDGET = int(os.environ.get("GREYWHALE_BUDGET", BUDGET))


def worked(seed: int, case: str) -> dict[str, Any]:
    """Errors (seconds, 4) rad² adapted and left alone, what came of it, and errors (4,) on the changed arm after it."""
    arm_at, board = CASES[case], ParameterTable.defaults()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        fit, *checks = practised(default_arm(), folder, 1)
        learnt = learn(fit, checks, tables(board), load_arm("white_box"), folder)
        start = board.with_controllers(learnt.tuning.after)
        motion = human_reaches(seed, WORK_S + 30.0)
        bench, person = working_bench(motion, arm_at)
        with bench:
            with Device(bench.port) as device:
                upload_set(device, start)
            out, workers = folder / "adapted.toml", SerialWorkers()
            request = AdaptationRequest(bench.port, learnt.model, out, workers, WORK_S, SEARCH_BUDGET)
            result = adapt(request)
        bench, alone = working_bench(motion, arm_at)
        with bench:
            with Device(bench.port) as device:
                upload_set(device, start)
                record(device, folder / "alone.csv", WORK_S, 100, enable=True)
        changed = arm_at(WORK_S)
        model = replace(load_model(learnt.model, force=True), arm=changed, plants=plant_row(changed)[None], doubts=())
        tuned = tune(model, start=controllers_of(start), floors=False).after
    sets = {"start": controllers_of(start), "adapted": controllers_of(result.kept), "tuned": tuned}
    return {
        "facts": result.as_dict(),
        "adapted": np.array(person.errors),
        "alone": np.array(alone.errors),
        "after": {name: error_of(rows, changed) for name, rows in sets.items()},
    }


def error_of(rows: Controllers, arm: ArmParameters) -> Floats:
    """On reaches that nobody trained on, (4,) rad²."""
    found: Floats = Experiment(human_reaches(91, 30.0), arm).run(rows[None]).mse[0]
    return found


def run() -> list[Figure]:
    found = repeat("adapt", [Task(case, worked, PERSON, {"case": case}) for case in CHOSEN])
    return [figure for case, facts in found.items() for figure in judged(case, facts)]


def judged(case: str, found: dict[str, Any]) -> list[Figure]:
    """The figures of one case."""
    facts, after = found["facts"], found["after"]
    count = min(len(found["adapted"]), len(found["alone"]))
    adapted, alone = found["adapted"][:count], found["alone"][:count]
    weight = 1.0 / alone.mean(axis=0)  # each joint counts the same
    of_tuned, worst = total(after["adapted"] / after["tuned"]), most_excess(adapted @ weight, alone @ weight)
    kept = sum(one["outcome"] == "kept" for one in facts["trials"])
    return [
        Figure(f"{case}: error after / before, held-out reaches", total(after["adapted"] / after["start"]), "x"),
        Figure(f"{case}: error / a tuning's on the true arm", of_tuned, "x", f"<= {OF_TUNED}", of_tuned <= OF_TUNED),
        Figure(f"{case}: the start's / a tuning's", total(after["start"] / after["tuned"]), "x"),
        Figure(
            f"{case}: error in the last minute, of alone",
            float((adapted @ weight)[-60:].sum() / (alone @ weight)[-60:].sum()),
            "x",
        ),
        Figure(f"{case}: worst half minute, beyond alone", worst, "", f"<= {LIMIT}", worst <= LIMIT),
        Figure(f"{case}: sets kept", kept, ""),
        Figure(f"{case}: sets taken back", len(facts["trials"]) - kept, ""),
        Figure(f"{case}: searches", facts["searches"], ""),
        Figure(f"{case}: bump of a change", 1e3 * facts["bump_rad"], "mrad"),
    ]


def total(ratios: Floats) -> float:
    """The geometric mean over the joints."""
    return float(np.exp(np.log(ratios).mean()))


def most_excess(adapted: Floats, alone: Floats) -> float:
    """By how much half a minute's error exceeded that of the arm left alone, (n,) each, as a share of its usual one."""
    sums = [np.convolve(one, np.ones(HALF_MINUTE), "valid") for one in (adapted, alone)]
    return float(((sums[0] - sums[1]) / np.maximum(sums[1], HALF_MINUTE * alone.mean())).max())
