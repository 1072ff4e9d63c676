"""The paper's tuning: GWO-WOA, 10 agents, 30 iterations, every joint's controller on its own (section 4, Table 7).

J = ITAE + ITAU with weights 1 (Eqs. 19 to 21). Time counts from the leader's step to the end of the record. The model
is taken as given: its estimate, no other plants, no sensor noise. The paper leaves some things open; they are chosen as
follows:

- Training motion: the paper's 1 rad step (section 5.1) of the joint that is tuned. The other joints' leaders rest, and
  the other joints keep the controller from before.
- Control period: 20 ms, to which the paper's Kd belongs.
- Voltage: the model's supply for strategy mf. Where Ku is tuned too, 20 V: Ku = 20 of Table 8 is its bound.
- Bounds of Kp, Kd, Ki: 0 to 3 (`space.py`). The sets of strategy sf and the factors of strategy mf stay as they are.
- Table 7's bounds let a flank of a set have no width. No board takes that, so widths below 0.01 become 0.01; a note
  says how often that happened. The corners of a set cannot be out of order: each has a side of zero to itself.
- No joint's search knows the controller from before; the first pack is random.

This objective is mostly effort, so a controller that moves little does well. By any other measure this method may
therefore end worse than it began; use `default` instead.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from greywhale.arm.plants import column
from greywhale.base.types import Controllers, Floats
from greywhale.files.trajectory import Trajectory
from greywhale.loop import Experiment, steps
from greywhale.protocol.firmware import JOINTS
from greywhale.tune.judge.following import worse_followers
from greywhale.tune.judge.held_out import judge_held_out
from greywhale.tune.judge.margins import Margins
from greywhale.tune.method import Costs, Judgement
from greywhale.tune.model import Model
from greywhale.tune.request import TuningRequest
from greywhale.tune.search.journal import TuningJournal
from greywhale.tune.search.lockstep import LockstepSearch, SearchState
from greywhale.tune.search.space import Space
from greywhale.tune.search.training import tick_times

METHOD = "gwo-woa"
AGENTS = 10  # the paper's
ITERATIONS = 30  # the paper's
# For each joint the first pack, and then as many moves as iterations.
BUDGET = AGENTS * (ITERATIONS + 1)
PERIOD_MS = 20
LARGEST_SUPPLY_V = 20.0
WAIT_S = 0.1


class Loops:
    """The model in the paper's setting, with a step for each joint alone."""

    def __init__(self, model: Model, strategy: str, before: Controllers, threads: int) -> None:
        supply_v = LARGEST_SUPPLY_V if strategy != "mf" else model.arm.drive.supply
        self.table = model.table.with_raw({"period_ms": PERIOD_MS, "supply_mv": round(1000 * supply_v)})
        self.plant = model.plants[0].copy()
        self.plant[column("supply")] = supply_v
        self.before = before
        self._threads = threads
        self._experiments = [
            Experiment(
                move_one_joint(steps(), joint),
                model.arm,
                table=self.table,
                noise=False,
                wait_s=WAIT_S,
                soft_start=False,
                weight_s=time_since_step(steps(), WAIT_S),
            )
            for joint in range(JOINTS)
        ]

    def costs(self, rows: Controllers) -> Floats:
        """J of every joint, tried alone: (n, 4) for (n, 4, 13)."""
        costs = np.empty((len(rows), JOINTS))
        for joint, experiment in enumerate(self._experiments):
            laws = np.repeat(self.before[None], len(rows), axis=0)
            laws[:, joint] = rows[:, joint]
            result = experiment.run(laws, self.plant, threads=self._threads)
            costs[:, joint] = result.itae[:, joint] + result.itau[:, joint]
        return costs


class PaperMethod:
    """See the head of this file."""

    def __init__(self, task: TuningRequest) -> None:
        self.task = task
        self.loops = Loops(task.model, task.strategy, task.before, task.threads)
        self.table = self.loops.table
        self.found = SearchState.nothing(task.before)

    def facts(self) -> dict[str, Any]:
        return {"parameters": list(self.table.raw), "board": self.table.board.key}

    def search(self, journal: TuningJournal) -> None:
        """GWO-WOA for every joint on its own."""
        task = self.task

        def tick(now: SearchState) -> None:
            task.report("tuning", min(1.0, now.evaluations / task.budget), note=f"J {now.total:.2f}")

        space = Space.paper(task.strategy, task.before)
        search = LockstepSearch(self.loops.costs, self.found, journal, tick)
        search.run(space, stage="paper", method=METHOD, budget=task.budget, seed=(task.seed,), pack=AGENTS)

    def cost_before(self) -> Costs:
        return tuple(map(float, self.loops.costs(self.task.before[None])[0]))

    def judge(self) -> Judgement:
        task, table, plant = self.task, self.table, self.loops.plant
        best = self.found.best
        task.report("judging", 0.0)
        margins = Margins(task.model.arm, table, plant[None], threads=task.threads, judging=task.judging)
        margins_before, margins_after = margins.check(task.before), margins.check(best)
        task.report("judging", 0.5)
        held_out = judge_held_out(task.model.arm, table, plant, task.before, best, task.threads, task.judging)
        task.report("judging", 1.0)
        return Judgement(
            after=best.copy(),
            cost_before=self.cost_before(),
            cost_after=tuple(map(float, self.found.cost)),
            notes=_notes(self.found, task.strategy, self.loops),
            margins_before=margins_before,
            margins=margins_after,
            held_out=held_out,
            worse=worse_followers(
                held_out,
                (),
                plant,
                task.before,
                best,
                task.model.arm.joints_in_use,
                task.threads,
                task.judging.following,
            ),
        )


def move_one_joint(motion: Trajectory, joint: int) -> Trajectory:
    """The motion of one joint; the others rest where it begins."""
    angles = np.repeat(motion.angles[:1], len(motion.angles), axis=0)
    angles[:, joint] = motion.angles[:, joint]
    return replace(motion, angles=angles)


def time_since_step(motion: Trajectory, wait_s: float) -> Floats:
    """The k of Eqs. 19 and 20 at every tick: the time since the leader left its first angle, 0 before."""
    elsewhere = np.flatnonzero(np.abs(motion.angles - motion.angles[0]).max(axis=1) > 1e-9)
    leaves = float(motion.time_s[elsewhere[0] - 1])
    return np.maximum(tick_times(motion, wait_s) - leaves, 0.0)


def _notes(found: SearchState, strategy: str, loops: Loops) -> tuple[str, ...]:
    supply = loops.plant[column("supply")]
    notes = [f"simulated with a control period of {PERIOD_MS} ms and {supply:g} V, each joint alone"]
    if strategy != "sf":
        notes.append(f"{found.narrowed} of the searched widths were below 0.01 and became 0.01; none was out of order")
    return tuple(notes)
