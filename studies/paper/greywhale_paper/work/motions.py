"""The paper's steps and multi-steps, played to controllers in simulation; and their measures as numbers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.types import Controllers, Floats
from greywhale.files.controller import load
from greywhale.files.log import Log
from greywhale.files.log.layout import Origin
from greywhale.files.paper_tables import paper_table
from greywhale.files.trajectory import Trajectory
from greywhale.loop import Experiment, controller_row, multi_steps, steps
from greywhale.measure import Evaluation, evaluate
from greywhale.protocol.table import ParameterTable

# From the moment the motors go on to the leader's first move, as on the bench.
WAIT_S = 1.5
SEED = 7  # of the potentiometers' noise
MOTIONS: dict[str, Callable[[], Trajectory]] = {"steps": steps, "multi-steps": multi_steps}
# The paper's Kd belongs to this control period, which it does not print (docs/tune.md).
PERIOD_MS = 20
# Pictures need no more rows a second.
SHOWN_S = 0.01
_DIGITS = 5  # of shown angles


def printed(name: str) -> Controllers:
    """The controllers of "before_tuning", "table_8", "table_9" or "table_10": int32 (4, 13)."""
    return controller_row(load(paper_table(name)))


def paper_board(supply_v: float, period_ms: int = PERIOD_MS) -> ParameterTable:
    """A board as the paper's: its control period and supply."""
    return ParameterTable.defaults().with_raw({"period_ms": period_ms, "supply_mv": round(1000 * supply_v)})


def play(
    arm: ArmParameters,
    table: ParameterTable,
    plant: Floats,
    rows: Controllers,
    motion: Trajectory,
    every: int = 2,
) -> tuple[Floats, Floats, Floats]:
    """Time (rows,), leader (rows, 4) and followers (n, rows, 4) in rad, in the bench's own arithmetic."""
    experiment = Experiment(motion, arm, table=table, seed=SEED, wait_s=WAIT_S)
    result = experiment.run_exact(rows, plant, every=every, threads=1)
    return result.time_s, experiment.leader[::every], result.angles.astype(np.float64)


def judged(
    arm: ArmParameters, table: ParameterTable, plant: Floats, controllers: dict[str, Controllers], traces: bool = False
) -> dict[str, Any]:
    """The measures of named controllers on both motions, with what is to be drawn if asked."""
    found: dict[str, Any] = {}
    for name, make in MOTIONS.items():
        time_s, leader, angles = play(arm, table, plant, np.stack(list(controllers.values())), make())
        one: dict[str, Any] = {
            key: measures(evaluation(time_s, leader, follower))
            for key, follower in zip(controllers, angles, strict=True)
        }
        if traces:
            every = max(1, round(SHOWN_S / float(time_s[1] - time_s[0])))
            one["trace"] = shown(time_s, leader, every)
            one["trace"] |= {key: rounded(angles[place, ::every]) for place, key in enumerate(controllers)}
        found[name] = one
    return found


def evaluation(time_s: Floats, leader: Floats, follower: Floats) -> Evaluation:
    state = np.full(len(time_s), "following")
    return evaluate(Log("simulation", Origin(), time_s, leader, follower, np.zeros_like(leader), state, 0, True))


def measures(one: Evaluation) -> dict[str, Any]:
    """Numbers of the four joints, rad², rad and s; None where a motion does not define them."""
    return {
        "mse": [joint.mse for joint in one.joints],
        "steady": [joint.steady_state_error for joint in one.joints],
        "settling": [joint.settling_error for joint in one.joints],
        "onset": [joint.onset_delay_s for joint in one.joints],
        "delay": [joint.delay_s for joint in one.joints],
    }


def shown(time_s: Floats, leader: Floats, every: int) -> dict[str, Any]:
    return {"time": rounded(time_s[::every]), "leader": rounded(leader[::every])}


def rounded(values: Floats) -> list[Any]:
    """For pictures: as many digits as can be seen."""
    found: list[Any] = np.round(values, _DIGITS).tolist()
    return found
