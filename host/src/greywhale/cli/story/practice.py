"""Three motions that the bench makes before it is tuned; none of them is shown or judged later.

The first is the one from which an arm can be identified best, as `greywhale record --excite` makes it. The other two
are a person's reaches, and validate the model: one with the controllers of the first, one with other controllers.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.bench_process import RunningBench
from greywhale.base.types import Progress, show_no_progress
from greywhale.board.record import record_led
from greywhale.cli.story.recorder import HuntedError, record_motion, record_with
from greywhale.files import controller as controller_file
from greywhale.files.leader import save_leader
from greywhale.files.log import Log
from greywhale.files.paper_tables import paper_table
from greywhale.files.trajectory import Trajectory
from greywhale.identify.excite import design
from greywhale.loop import human_reaches
from greywhale.protocol.table import ParameterTable

UNTUNED, OTHER = "before_tuning", "table_9"  # of the paper: where tuning starts, and the changed controller
REST_FILE = "rest_leader.csv"  # a leader that the person holds still
PRACTICE_S = 20.0
START_POSE_RAD = (0.0, 0.4, 0.0, 0.0)  # the arm off its lower stops, room to both sides
# The last evaluations of a search would gain little, and here the motion only has to be a good one.
DESIGN_BUDGET = 150
# To validate, with the same controllers and with others: was the arm learnt, or the arm with its controllers?
CHECKS = (("check", UNTUNED), ("check_changed", OTHER))
CHECK_SHARE = 0.6  # of the length of the practice
FIRST_SEED = 1000  # of the checks; far from the seeds that people give


def practise(
    bench: RunningBench,
    nominal: ArmParameters,
    base: ParameterTable,
    folder: Path,
    seconds: float = PRACTICE_S,
    report: Progress = show_no_progress,
) -> list[Log]:
    """Record practice of about `seconds` into `folder`, then the checks: the log to fit first, then those to validate.

    `nominal` is what is known of the arm; `base` the parameters that the board has besides its controllers. A check
    with which the arm hunts proves nothing of the arm: it ends early, and is left out.
    """

    def named(name: str) -> Progress:
        return lambda what, fraction: report(f"{name}: {what}", fraction)

    rest, motion = folder / REST_FILE, folder / "practice_leader.csv"
    pose = np.array([angle if joint in nominal.joints_in_use else 0.0 for joint, angle in enumerate(START_POSE_RAD)])
    save_leader(rest, Trajectory(np.array([0.0, 1.0]), np.array([pose, pose])))
    untuned = tables(base)[0]
    designed = design(nominal, pose, table=untuned, seconds=seconds, budget=DESIGN_BUDGET, report=named("practice"))
    save_leader(motion, designed.motion)
    path, note = folder / "practice.csv", named("practice")
    first = record_with(  # while the person holds the leader still
        bench, rest, paper_table(UNTUNED), note, lambda device: record_led(device, path, designed.motion, progress=note)
    )
    logs = [first.log()]
    for number, (name, controller) in enumerate(CHECKS):
        leader, path = folder / f"{name}_leader.csv", folder / f"{name}.csv"
        save_leader(leader, human_reaches(FIRST_SEED + number, CHECK_SHARE * seconds))
        try:
            logs.append(record_motion(bench, leader, path, paper_table(controller), named(name)).log())
        except HuntedError:
            report(f"{name}: the arm hunts with {controller}, so the model is judged without this log", 1.0)
    return logs


def tables(base: ParameterTable) -> list[ParameterTable]:
    """The parameters of the practice's logs: its controllers on a board that otherwise has `base`."""
    return [controller_file.load(paper_table(name)).table(base).with_name(name) for name in (UNTUNED, OTHER)]
