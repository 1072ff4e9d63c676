"""Measures how well `greywhale identify` predicts recordings of three real rigs of one joint that it never saw.

The recordings are other people's and not part of this project; docs/real_data.md says where they come from. Their
folder is ../shared/data, or what GREYWHALE_REAL_DATA names.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np

from greywhale.files.log import Log
from greywhale.identify import identify
from studies.real_data.rigs import LEVER_RIG, POT_RIG, SERVO_RIG, Rig, read_lever, read_pot, read_servo
from tools import ROOT
from tools.benchmarks.figure import Figure

FOLDER = Path(os.environ.get("GREYWHALE_REAL_DATA") or ROOT.parent / "shared" / "data")
READERS = {"pot_servo/": read_pot, "servo_pendulum/xl330_": read_servo, "lever_1dof/m2_": read_lever}
# The rig, the record that is fitted, and those that are judged: they have another controller or another motion.
CASES: tuple[tuple[Rig, str, tuple[str, ...]], ...] = (
    (POT_RIG, "pot_servo/pid_step", ("pot_servo/pr", "pot_servo/relay_method")),
    (SERVO_RIG, "servo_pendulum/xl330_kp200_sin_sin", ("servo_pendulum/xl330_kp400_sin_sin",)),
    (SERVO_RIG, "servo_pendulum/xl330_kp400_sin_sin", ("servo_pendulum/xl330_kp200_sin_sin",)),
    (SERVO_RIG, "servo_pendulum/xl330_kp200_up_and_down", ("servo_pendulum/xl330_kp400_up_and_down",)),
    (LEVER_RIG, "lever_1dof/m2_a_free_motion_500hz", ("lever_1dof/m2_c_free_motion_500hz",)),
    (LEVER_RIG, "lever_1dof/m2_c_free_motion_500hz", ("lever_1dof/m2_a_free_motion_500hz",)),
)


def read(name: str) -> Log:
    reader = next(reader for prefix, reader in READERS.items() if name.startswith(prefix))
    return reader(FOLDER / f"{name}.csv")


def judge(rig: Rig, fitted: str, others: tuple[str, ...]) -> list[Figure]:
    """The model's error on each record beside that of the published data, in percent of the joint's range."""
    log, logs = read(fitted), [read(name) for name in others]
    verdicts = {verdict.name: verdict for verdict in identify([log], rig.arm(), validate=logs).verdicts}
    figures = []
    for other in logs:
        verdict, scale = verdicts[other.name], 100.0 / float(np.ptp(other.follower[:, rig.joint]))
        model, published = (scale * float(np.sqrt(sum(mse))) for mse in (verdict.model, verdict.white_box))
        aim = f"< {published:.2f} (published data)"
        figures.append(Figure(f"{log.name} -> {other.name}", model, "% of range", aim, model < published))
    return figures


def run() -> list[Figure]:
    if not FOLDER.is_dir():
        print(f"There are no recordings at {FOLDER}; docs/real_data.md says where they come from.", file=sys.stderr)
        return []
    return [figure for case in CASES for figure in judge(*case)]
