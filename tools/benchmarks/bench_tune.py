"""Measures tuning where it counts: the compiled firmware on the bench, with an arm that the tuner knows nothing of.

Everything goes through the serial port: practice recordings, identification from them, tuning on the identified
model, upload; then the same motions as before tuning, measured as `greywhale evaluate` does. The logs stay in
build/bench_tune for a look.
"""

from __future__ import annotations

from pathlib import Path

from greywhale.cli.story import BenchProcess, record_motion
from greywhale.cli.story.learn import learn
from greywhale.cli.story.practice import UNTUNED, practise, tables
from greywhale.files.arm import default_arm, load_arm
from greywhale.files.leader import save_leader
from greywhale.files.paper_tables import paper_table
from greywhale.files.trajectory import Trajectory
from greywhale.loop import plant_row
from greywhale.measure import Evaluation, evaluate
from greywhale.protocol.table import ParameterTable
from greywhale.tune.judge.margins import MOVING, Margin, Margins
from tools import ROOT
from tools.benchmarks.figure import Figure, at_most
from tools.benchmarks.tuning import Judged, figures, motions

FOLDER = ROOT / "build" / "bench_tune"
REACH_S = 120.0


def measured(
    bench: BenchProcess, wanted: dict[str, Trajectory], controller: Path, suffix: str
) -> dict[str, tuple[Evaluation, float]]:
    """Every motion recorded with these controllers; beside each evaluation the wall time of the upload."""
    found = {}
    for name, motion in wanted.items():
        leader = FOLDER / f"{name.replace(' ', '_')}_leader.csv"
        save_leader(leader, motion)
        recorded = record_motion(bench, leader, FOLDER / f"{name.replace(' ', '_')}_{suffix}.csv", controller)
        found[name] = (evaluate(recorded.log()), recorded.upload_s)
    return found


def roll_rattle(margins: tuple[Margin, ...]) -> float:
    """rad rms, in the worst class of motion."""
    (roll,) = (one.rattle_rad for one in margins if one.scenario == MOVING and one.joint == 3)
    return roll


def run() -> list[Figure]:
    FOLDER.mkdir(parents=True, exist_ok=True)
    wanted, nominal = motions(), load_arm("white_box")
    with BenchProcess("--speed", "max") as bench:
        before = measured(bench, wanted, paper_table(UNTUNED), "before")
        logs = practise(bench, nominal, ParameterTable.defaults(), FOLDER).logs
        learnt = learn(logs[0], logs[1:], tables(ParameterTable.defaults()), nominal, FOLDER)
        after = measured(bench, wanted, learnt.controller, "after")
    upload_s = next(iter(after.values()))[1]
    total = learnt.identify_s + learnt.tune_s + upload_s
    arm = default_arm()
    judged = {name: Judged.of(name, motion, arm, before[name][0], after[name][0]) for name, motion in wanted.items()}
    changed = 100 * learnt.identification.verdicts[2].improvement
    judge = Margins(arm, ParameterTable.defaults(), plant_row(arm)[None])
    margins = judge.check(learnt.tuning.after)
    rattling = [roll_rattle(judge.check(learnt.tuning.before)), roll_rattle(margins)]
    missing = sum(not margin.holds for margin in margins)
    return [
        Figure("bench: identify, wall time", learnt.identify_s, "s"),
        Figure("bench: tune, wall time", learnt.tune_s, "s"),
        Figure("bench: upload, wall time", upload_s, "s"),
        at_most("bench: identify, tune and upload", total, "s", REACH_S),
        Figure("bench: model better than white box, changed controller", changed, "%"),
        Figure(f"bench: margins missing on the true arm, of {len(margins)}", missing, "", "0", missing == 0),
        Figure("bench: rattling of the roll joint while moving, before", 1e3 * rattling[0], "mrad"),
        Figure("bench: the same, after", 1e3 * rattling[1], "mrad", "<= before", rattling[1] <= rattling[0]),
        *figures("bench", judged),
    ]
