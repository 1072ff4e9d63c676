"""The identification as the ablation screens it: from the white box, judged against the true arm."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.files.arm import load_arm
from greywhale.identify import identify
from greywhale.identify.limits import IDENTIFICATION_LIMITS
from greywhale.identify.space import KINDS, Parameter, Space
from greywhale.loop import human_reaches
from tools.benchmarks.ablated import Ablated, true_arm, with_values
from tools.benchmarks.bench_identify import held
from tools.support.recordings import record, table_of

LOG_S = 6.0
MAIN = ("inertia", "damping", "coulomb")
GROUPS = ("data", "windows", "search", "uncertainty")
# Read by a report, a refusal or another method only, or never at work in a short log without gaps.
APART = (
    "data.usual_spacings",
    "data.longest_gap_s",
    "data.max_windows",
    "search.rival_margin",
    "search.max_rivals",
    "search.farthest_log",
    "uncertainty.open_log",
    "uncertainty.uncertain",
    "uncertainty.sharper",
)
# A held-out block has at least one window, the log has at least one such block, and a change of start must leave less.
CLOSER: dict[str, tuple[Any, Any]] = {
    "data.window_s": (0.3, 0.7),
    "data.block_s": (0.5, 1.0),
    "data.held_out_every": (3, 5),
    "windows.worth_a_change": (0.9, 0.975),
}
NEVER = 1e9
# What switches a rule off.
OFF: dict[str, Any] = {
    **dict.fromkeys(("search.soft_teeth", "search.far_doubts", "search.other_optimum", "search.lossy_drivers"), NEVER),
    "search.min_closed_improvement": 1.0,
    "windows.usual_misfit": NEVER,
    "windows.worth_a_change": 0.0,
    **dict.fromkeys(("uncertainty.mass_share", "uncertainty.length_share", "uncertainty.gap_beside_play_rad"), 0.0),
    "uncertainty.widened": 1.0,
    **dict.fromkeys(("uncertainty.systematic", "uncertainty.foreign"), ()),
    "uncertainty.systematic_alpha": (0.0, 0.0, 0.0, 0.0),
}


def identified(seed: int, kind: str, number: int, values: Mapping[str, Any]) -> dict[str, float]:
    """The responses of an identification with these values of limits, from readings with noise by the seed."""
    arm, table = true_arm(kind, number), table_of("before_tuning")
    with tempfile.TemporaryDirectory() as name:
        logs = [
            record(arm, human_reaches(motion, LOG_S), Path(name) / f"{motion}.csv", table, 10 * seed + motion)
            for motion in (1, 2)
        ]
    begin = time.process_time()
    outcome = identify(
        logs[:1],
        load_arm("white_box"),
        validate=logs[1:],
        tables=[table],
        judging=with_values(IDENTIFICATION_LIMITS, values),
    )
    seconds = time.process_time() - begin
    if not outcome.complete:
        raise KeyboardInterrupt
    off = []
    for one in outcome.estimates:
        parameter = Parameter.from_name(one.name)
        if parameter.kind in MAIN:
            true = float(Space.of(arm, (parameter.kind,), (parameter.joint,)).start()[0])
            off.append(abs(KINDS[parameter.kind].to_search(one.value) - true))
    intervals = [holds for kind in held(outcome, arm).values() for holds in kind]
    return {
        "error": float(0.5 * np.log(np.sum(outcome.verdicts[1].model))),
        "parameters": float(np.median(off)),
        "missed": 1.0 - float(np.mean(intervals)),
        "seconds": float(np.log(seconds)),
    }


IDENTIFY = Ablated(IDENTIFICATION_LIMITS, GROUPS, APART, CLOSER, OFF, identified)
