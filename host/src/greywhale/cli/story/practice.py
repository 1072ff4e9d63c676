"""Three motions that the bench makes before it is tuned; none of them is shown or judged later.

The first is the one from which an arm can be identified best, as `greywhale record --excite` makes it. The other two
are a person's reaches, and validate the model: one with the controllers of the first, one with other controllers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.bench_process import RunningBench
from greywhale.base.errors import UserError
from greywhale.base.types import Progress, show_no_progress
from greywhale.board.record import record_led
from greywhale.cli.story.recorder import Recorded, StoppedError, record_motion, record_with
from greywhale.files import controller as controller_file
from greywhale.files.leader import save_leader
from greywhale.files.log import Log
from greywhale.files.paper_tables import paper_table
from greywhale.files.trajectory import Trajectory
from greywhale.identify.excite import design
from greywhale.identify.excite.design import GOOD_BUDGET
from greywhale.loop import human_reaches
from greywhale.protocol.table import ParameterTable

UNTUNED, OTHER = "before_tuning", "table_9"  # of the paper: where tuning starts, and the changed controller
REST_FILE = "rest_leader.csv"  # a leader that the person holds still
PRACTICE_S = 20.0
START_POSE_RAD = (0.0, 0.4, 0.0, 0.0)  # the arm off its lower stops, room to both sides
# To validate, with the same controllers and with others: was the arm learnt, or the arm with its controllers?
CHECKS = (("check", UNTUNED), ("check_changed", OTHER))
CHECK_SHARE = 0.6  # of the length of the practice


@dataclass(frozen=True)
class Practice:
    """The log to fit first, then those to validate; and the motions in which the board stopped the arm, and why."""

    logs: list[Log]
    left_out: tuple[str, ...]


def practise(
    bench: RunningBench,
    nominal: ArmParameters,
    base: ParameterTable,
    folder: Path,
    seconds: float = PRACTICE_S,
    report: Progress = show_no_progress,
) -> Practice:
    """Record practice of about `seconds` into `folder`, then the checks.

    `nominal` is what is known of the arm; `base` the parameters that the board has besides its controllers. A motion
    in which the board stopped the arm is left out, and the next log is the one to fit. UserError where it stopped all.
    """

    def named(name: str) -> Progress:
        return lambda what, fraction: report(f"{name}: {what}", fraction)

    rest, motion = folder / REST_FILE, folder / "practice_leader.csv"
    pose = np.array([angle if joint in nominal.joints_in_use else 0.0 for joint, angle in enumerate(START_POSE_RAD)])
    save_leader(rest, Trajectory(np.array([0.0, 1.0]), np.array([pose, pose])))
    untuned = tables(base)[0]
    designed = design(nominal, pose, table=untuned, seconds=seconds, budget=GOOD_BUDGET, report=named("practice"))
    save_leader(motion, designed.motion)
    logs: list[Log] = []
    left_out: list[str] = []

    def keep(name: str, recording: Callable[[], Recorded]) -> None:
        try:
            logs.append(recording().log())
        except StoppedError as error:
            left_out.append(f"{name}: {error.message}")
            report(f"left out: {left_out[-1]}", 1.0)

    def practice() -> Recorded:
        path, note = folder / "practice.csv", named("practice")
        return record_with(  # while the person holds the leader still
            bench, rest, paper_table(UNTUNED), note,
            lambda device: record_led(device, path, designed.motion, progress=note),
        )  # fmt: skip

    keep("practice", practice)
    for number, (name, controller) in enumerate(CHECKS):
        leader, path = folder / f"{name}_leader.csv", folder / f"{name}.csv"
        save_leader(leader, human_reaches(1000 + number, CHECK_SHARE * seconds))  # far from the seeds that people give
        keep(name, partial(record_motion, bench, leader, path, paper_table(controller), named(name)))
    if not logs:
        raise UserError(
            "the arm cannot be identified, because no motion came to its end; `greywhale commission` leads an arm with "
            f"softer gains where it swings; the last: {left_out[-1]}"
        )
    return Practice(logs, tuple(left_out))


def tables(base: ParameterTable) -> list[ParameterTable]:
    """The parameters of the practice's logs: its controllers on a board that otherwise has `base`."""
    return [controller_file.load(paper_table(name)).table(base).with_name(name) for name in (UNTUNED, OTHER)]
