"""Five minutes of a person's work with an arm that changes, on the bench in lock step: adapted, and left alone.

The arm is practised with, identified and tuned for before it changes. One of them is moved by MuJoCo, with play at its
potentiometers (`make oracles` installs it). Searches take no time of the bench here; on a computer of its own one takes
some ten seconds. GREYWHALE_ADAPT names the cases to run, GREYWHALE_BUDGET the evaluations of a search, GREYWHALE_PERSON
the seed of the motions.
"""

from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.adapt import BUDGET, AdaptationRequest, adapt
from greywhale.adapt.limits import ADAPTATION_LIMITS
from greywhale.arm import ArmParameters
from greywhale.arm.parameters import Tip
from greywhale.arm.plants import plant_row
from greywhale.base.study import SerialWorkers, Task
from greywhale.base.types import Controllers, Floats
from greywhale.board.device import Device
from greywhale.board.record import record
from greywhale.board.upload import upload_set
from greywhale.cli.story.learn import learn
from greywhale.cli.story.practice import practise, tables
from greywhale.files.arm import default_arm, load_arm
from greywhale.files.trajectory import Trajectory
from greywhale.loop import Experiment, human_reaches
from greywhale.loop.controllers import controllers_of
from greywhale.protocol.table import ParameterTable
from greywhale.tune import tune
from greywhale.tune.limits import WITHOUT_FLOORS
from greywhale.tune.model import load_model
from greywhale_sim.assemble import BenchOptions
from greywhale_sim.lockstep import LockStepBench
from tools.benchmarks.figure import Figure
from tools.benchmarks.study import repeat
from tools.benchmarks.tuning import practised
from tools.support.foreign_arm import MuJoCoPlant, bench_of, foreign_arm, recorded, save
from tools.support.person_at_work import ArmAt, PersonAtWork, grown_friction, stickier, working_bench

WINDOW_S, MAX_EXCESS = ADAPTATION_LIMITS.decisions.window_s, ADAPTATION_LIMITS.decisions.max_excess
WORK_S = 300.0
PERSON = int(os.environ.get("GREYWHALE_PERSON", 3))
FOREIGN = 2  # seed of MuJoCo's arm
LOADED_AFTER_S, LOAD_KG = 60.0, 0.3
GROWS = 0.4  # friction, by this share
OF_TUNED = 1.15


def loaded(seconds: float) -> ArmParameters:
    """The default arm, which takes up a load."""
    arm = default_arm()
    return arm.model_copy(update={"tip": Tip(mass=LOAD_KG)}) if seconds >= LOADED_AFTER_S else arm


@dataclass(frozen=True)
class Case:
    """A course of the default arm's wear: the arm that it is after so many seconds of work, in our engine."""

    arm_at: ArmAt

    @staticmethod
    @cache
    def known() -> tuple[str, Controllers]:
        """The text of the model's file, and the controllers tuned on it, from before the work."""
        with tempfile.TemporaryDirectory() as name:
            fit, *checks = practised(default_arm(), Path(name), 1)
            found = learn(fit, checks, tables(ParameterTable.defaults()), load_arm("white_box"), Path(name))
            return found.model.read_text(encoding="utf-8"), found.tuning.after

    def at_work(self, motion: Trajectory, folder: Path) -> tuple[LockStepBench, PersonAtWork]:
        """A bench, and who works there."""
        return working_bench(motion, self.arm_at)

    def changed(self, identified: ArmParameters) -> ArmParameters:
        """The arm at the end of the work, in true numbers."""
        return self.arm_at(WORK_S)

    def error_of(self, table: ParameterTable, folder: Path) -> Floats:
        """On reaches that nobody trained on, with the arm as it is at the end of the work, (4,) rad²."""
        experiment = Experiment(unseen(), self.arm_at(WORK_S))
        found: Floats = experiment.run(controllers_of(table)[None]).mse[0]
        return found


class ForeignCase(Case):
    """An arm of another engine whose friction grows."""

    def __init__(self) -> None:
        super().__init__(stickier(foreign_arm(FOREIGN).parameters, by=GROWS))

    @staticmethod
    @cache
    def known() -> tuple[str, Controllers]:
        """See Case."""
        base, white = ParameterTable.defaults(), load_arm("white_box")
        with tempfile.TemporaryDirectory() as name, bench_of(foreign_arm(FOREIGN), Path(name)) as bench:
            fit, *checks = practise(bench, white, base, Path(name)).logs
            found = learn(fit, checks, tables(base), white, Path(name))
            return found.model.read_text(encoding="utf-8"), found.tuning.after

    def at_work(self, motion: Trajectory, folder: Path) -> tuple[LockStepBench, PersonAtWork]:
        """See Case."""
        arm = foreign_arm(FOREIGN)
        options = BenchOptions(arm=save(arm, folder / "foreign.toml"))
        return working_bench(motion, self.arm_at, options, MuJoCoPlant(arm))

    def changed(self, identified: ArmParameters) -> ArmParameters:
        """Our model knows no true numbers of another engine: what was identified, with the friction that it has now."""
        return grown_friction(identified, 1.0 + GROWS)

    def error_of(self, table: ParameterTable, folder: Path) -> Floats:
        """See Case."""
        arm = replace(foreign_arm(FOREIGN), parameters=self.arm_at(WORK_S))
        with bench_of(arm, folder) as bench:
            with Device(bench.port) as device:
                upload_set(device, table)
            return recorded(bench, folder, "after", {"reaches": unseen()}).error["reaches"]


CASES: dict[str, Case] = {
    "friction +40 % within 2 min": Case(stickier(default_arm(), by=GROWS)),
    f"{LOAD_KG} kg at the tip": Case(loaded),
    "an unchanged arm": Case(lambda seconds: default_arm()),
    "friction +40 % on MuJoCo's arm": ForeignCase(),
}
CHOSEN = os.environ.get("GREYWHALE_ADAPT", ",".join(CASES)).split(",")
SEARCH_BUDGET = int(os.environ.get("GREYWHALE_BUDGET", BUDGET))


def unseen() -> Trajectory:
    """Motions that nobody trained on."""
    return human_reaches(91, 30.0)


def worked(seed: int, case: str) -> dict[str, Any]:
    """Errors (seconds, 4) rad² adapted and left alone, what came of it, and errors (4,) on the changed arm after it."""
    arm, board = CASES[case], ParameterTable.defaults()
    text, rows = arm.known()
    start = board.with_controllers(rows)
    motion = human_reaches(seed, WORK_S + 30.0)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        file = folder / "model.toml"
        file.write_text(text, encoding="utf-8")
        bench, person = arm.at_work(motion, folder)
        with bench:
            with Device(bench.port) as device:
                upload_set(device, start)
            out, workers = folder / "adapted.toml", SerialWorkers()
            result = adapt(AdaptationRequest(bench.port, file, out, workers, WORK_S, SEARCH_BUDGET))
        bench, alone = arm.at_work(motion, folder)
        with bench:
            with Device(bench.port) as device:
                upload_set(device, start)
                record(device, folder / "alone.csv", WORK_S, 100, enable=True)
        model = load_model(file, force=True)
        changed = arm.changed(model.arm)
        model = replace(model, arm=changed, plants=plant_row(changed)[None], doubts=())
        tuned = board.with_controllers(tune(model, start=controllers_of(start), judging=WITHOUT_FLOORS).after)
        sets = {"start": start, "adapted": result.kept, "tuned": tuned}
        return {
            "facts": result.as_dict(),
            "adapted": np.array(person.errors),
            "alone": np.array(alone.errors),
            "after": {name: arm.error_of(table, folder) for name, table in sets.items()},
        }


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
        Figure(f"{case}: worst half minute, beyond alone", worst, "", f"<= {MAX_EXCESS}", worst <= MAX_EXCESS),
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
    sums = [np.convolve(one, np.ones(WINDOW_S), "valid") for one in (adapted, alone)]
    return float(((sums[0] - sums[1]) / np.maximum(sums[1], WINDOW_S * alone.mean())).max())
