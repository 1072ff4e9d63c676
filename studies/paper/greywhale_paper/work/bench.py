"""The experiment: the compiled firmware on the simulated board drives an arm; all that comes back are logs.

The bench runs in lock step with its host, so the logs are the same byte for byte whenever they are recorded again.
"""

from __future__ import annotations

import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.base.errors import UserError
from greywhale.base.types import Controllers
from greywhale.files.leader import save_leader
from greywhale.files.log import Log, read_evidence
from greywhale.files.trajectory import Trajectory
from greywhale.loop import human_reaches
from greywhale.measure import evaluate
from greywhale.protocol.table import ParameterTable
from greywhale_paper.work.arms import DEFAULT, file_of
from greywhale_paper.work.motions import MOTIONS, SHOWN_S, measures, paper_board, printed, rounded, shown
from greywhale_sim.assemble import BenchOptions
from greywhale_sim.lockstep import record_in_lock_step

SUPPLY_V = 15.0
BENCH_SEED = 1
# The log begins after the soft start (1 s), the leader 0.5 s later; it ends so long after the leader's last move.
BEFORE_S, AFTER_S = 0.5, 0.2
# By then a joint that will rest does.
LAST_S = 1.0
# The paper's arm had no supervisor, and each experiment shall be seen to its end.
UNGUARDED = {
    "tracking_limit": 0,
    "unrest_amplitude": 0,
    "speed_limit": 0,
    "runaway_limit": 0,
    "stall_volts": 0,
}
# The motions from which models are identified: name, controllers; and the seeds of the hand that makes them, and of
# another hand.
DATA_SETS = (("data set 1", "before_tuning"), ("data set 2", "before_tuning"), ("data set 3", "table_9"))
HANDS = ((1001, 1002, 1003), (11, 12, 13))


def board(rows: Controllers, period_ms: int) -> ParameterTable:
    """The bench's board with controllers (4, 13) at a control period, without the supervisor's checks of motion."""
    return paper_board(SUPPLY_V, period_ms).with_raw(UNGUARDED).with_controllers(rows.tolist())


def record(
    folder: Path, name: str, motion: Trajectory, table: ParameterTable, seed: int = BENCH_SEED, arm: str = DEFAULT
) -> Log:
    """The log `name`.csv of an arm that follows a motion; the leader's own file lies beside it."""
    leader, path = folder / f"{name}.leader.csv", folder / f"{name}.csv"
    save_leader(leader, motion)
    options = BenchOptions(leader=leader, arm=file_of(arm, folder), seed=seed)
    seconds = BEFORE_S + motion.duration_s + AFTER_S
    try:
        record_in_lock_step(path, options, table, seconds)
    except UserError as error:
        if not path.is_file():  # nothing at all was recorded
            raise
        error.add_note("The log so far is taken.")
    # Where the file lay changes from run to run, and would go into models and reports.
    return replace(read_evidence(path), name=path.name)


@cache
def record_data(
    seconds: float, period_ms: int, arm: str = DEFAULT, hand: int = 0
) -> tuple[tuple[Log, ...], tuple[ParameterTable, ...]]:
    """The data sets of an arm at a control period, and the tables with which they were recorded.

    Every process records them for itself, once: they come out the same.
    """
    logs = []
    with tempfile.TemporaryDirectory(prefix="greywhale-reproduce-") as folder:
        for number, ((_, controllers), seed) in enumerate(zip(DATA_SETS, HANDS[hand], strict=True), 1):
            motion, table = human_reaches(seed, seconds), board(printed(controllers), period_ms)
            logs.append(record(Path(folder), f"data set {number}", motion, table, arm=arm))
    names = dict.fromkeys(controllers for _, controllers in DATA_SETS)
    return tuple(logs), tuple(board(printed(name), period_ms).with_name(name) for name in names)


def why_ended(log: Log) -> str:
    """Why a recording ended early, "" if it did not, without the name of the line, which no other run has."""
    line, _, reason = log.ended_by.partition(": ")
    return reason or line


def swings(log: Log) -> list[float]:
    """How far each joint swings to and fro, from end to end, in the log's last second, rad."""
    last = log.time > log.time[-1] - LAST_S
    found: list[float] = np.ptp(log.follower[last], axis=0).tolist()
    return found


def try_controllers(
    seed: int, rows: list[list[int]], period_ms: int, traces: bool = True, arm: str = DEFAULT
) -> dict[str, Any]:
    """Steps and multi-steps of controllers (4, 13) on the bench: the paper's measures of the logs.

    `seed` changes the noise of the bench's potentiometers, and where its gears stand.
    """
    table = board(np.array(rows, dtype=np.int32), period_ms)
    found: dict[str, Any] = {}
    with tempfile.TemporaryDirectory(prefix="greywhale-reproduce-") as folder:
        for motion, make in MOTIONS.items():
            log = record(Path(folder), motion, make(), table, BENCH_SEED + seed, arm)
            numbers = measures(evaluate(log)) | {"swing": swings(log)}
            one: dict[str, Any] = {"after": numbers, "stopped": why_ended(log), "samples": len(log.time)}
            if traces:
                every = round(SHOWN_S / float(log.time[1] - log.time[0]))
                one["trace"] = shown(log.time, log.leader, every) | {"after": rounded(log.follower[::every])}
            found[motion] = one
    return found
