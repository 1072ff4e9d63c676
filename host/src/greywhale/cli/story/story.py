"""The whole story on the bench: flash, record, identify, tune, upload, and record the same motion again.

The motion that is shown is not used for anything else: identification sees other motions, tuning only the model.
"""

from __future__ import annotations

import json
import shlex
import time
from dataclasses import dataclass, replace
from pathlib import Path

from greywhale.arm import ArmParameters
from greywhale.base.bench_process import BenchProcess, RunningBench
from greywhale.base.errors import UserError, require_between
from greywhale.base.formats.whole import make_folder, write_text
from greywhale.base.types import NotedProgress, show_no_progress
from greywhale.board import flash
from greywhale.board.device import Device
from greywhale.board.upload import change_parameters
from greywhale.cli.story import learn
from greywhale.cli.story.learn import Learnt
from greywhale.cli.story.practice import PRACTICE_S, REST_FILE, UNTUNED, practise, tables
from greywhale.cli.story.recorder import StoppedError, record_motion
from greywhale.cli.story.result import TUNED, DemoResult, Run
from greywhale.files import controller as controller_file
from greywhale.files.arm import default_arm, load_arm
from greywhale.files.leader import load_leader, save_leader
from greywhale.files.paper_tables import paper_table
from greywhale.files.trajectory import Trajectory
from greywhale.identify.excite import multisine
from greywhale.loop import human_reaches
from greywhale.measure import evaluate
from greywhale.pictures.follow import draw_following, trace
from greywhale.protocol.schema import Board
from greywhale.protocol.table import ParameterTable

PROVING_TRIALS = 4  # sets tried on the arm


@dataclass(frozen=True)
class DemoOptions:
    """Options of the demo."""

    out: Path
    leader: Path | None = None  # CSV of a leader's motion; None: generated human-like reaches
    board: str = "mega"
    arm: Path | None = None
    speed: str = "max"
    duration_s: float = 20.0  # of the generated motion
    seed: int = 1
    controller: Path | None = None  # shown instead of tuned ones
    practice_s: float = PRACTICE_S  # of the motion that the arm is identified from
    budget: int | None = None  # of the tuning, evaluations; None: its default
    prove: bool = False  # prove the tuned controllers on the arm, as `greywhale commission` does


def run(options: DemoOptions, report: NotedProgress = show_no_progress) -> DemoResult:
    """Tell the story; everything it shows is in the folder `options.out` afterwards."""
    started = time.monotonic()
    motion = _motion(options)
    arm = default_arm() if options.arm is None else load_arm(options.arm)
    if options.controller is not None:
        controller_file.load(options.controller)
    make_folder(options.out)
    leader = options.leader or options.out / "leader.csv"
    if options.leader is None:
        save_leader(leader, motion)
    report("starting the bench", 0.0)
    with BenchProcess(*_bench_options(options)) as bench:
        hello = flash.flash(bench.port, options.board, report=report)
        stage = _Stage(bench, options, arm, report)
        stage.follow(leader, "before", "before tuning", paper_table(UNTUNED))
        learnt = None if options.controller is not None else stage.learn()
        if learnt is None:
            assert options.controller is not None
            stage.follow(leader, "after", options.controller.stem, options.controller)
        else:
            stage.follow(leader, "after", TUNED, learnt.controller)
            if options.prove:
                stage.prove(learnt)
                stage.follow(leader, "proven", "proven")
    runs = stage.runs
    if not runs:
        raise UserError(f"there is nothing to show, because no motion came to its end: {'; '.join(stage.left_out)}")
    report("drawing", 0.0)
    result = DemoResult(
        leader=str(options.leader) if options.leader else f"generated, seed {options.seed}",
        board=hello.board.key,
        firmware=f"{hello.fw_major}.{hello.fw_minor}.{hello.fw_patch}",
        runs=tuple(runs),
        learnt=learnt,
        left_out=tuple(stage.left_out),
        pictures=(
            _draw(options, [runs[0], runs[-1]], arm.drive.supply),
            *(() if learnt is None else learn.draw(learnt, options.out)),
        ),
        wall_s=0.0,
    )
    result = replace(result, wall_s=time.monotonic() - started)
    write_text(options.out / "summary.json", json.dumps(result.as_dict(), indent=2) + "\n")
    return result


class _Stage:
    """The bench and the steps on it, each reported as it happens."""

    def __init__(self, bench: RunningBench, options: DemoOptions, arm: ArmParameters, report: NotedProgress) -> None:
        self._bench = bench
        self._options = options
        self._arm = arm
        self._report = report
        self.runs: list[Run] = []
        self.left_out: list[str] = []  # motions in which the board stopped the arm, and why
        self._base = self._tell_board()

    def follow(self, leader: Path, file: str, name: str, controller: Path | None = None) -> None:
        """Record the motion that is shown once; without a controller, with those that the board has."""

        def note(what: str, fraction: float) -> None:
            self._report(f"{name}: {what}", fraction)

        try:
            recorded = record_motion(self._bench, leader, self._options.out / f"{file}.csv", controller, note)
        except StoppedError as error:
            self.left_out.append(f"{name}: {error.message}")
            return self._report(f"left out: {self.left_out[-1]}", 1.0)
        self.runs.append(Run(name, recorded, evaluate(recorded.log())))

    def learn(self) -> learn.Learnt:
        options = self._options
        nominal = load_arm("white_box") if options.arm is None else learn.arm_as_drawn(self._arm)
        practice = practise(self._bench, nominal, self._base, options.out, options.practice_s, self._report)
        self.left_out += practice.left_out
        logs = practice.logs
        known = tables(self._base)
        return learn.learn(logs[0], logs[1:], known, nominal, options.out, options.budget, report=self._report)

    def prove(self, learnt: Learnt) -> None:
        """Try the tuned controllers and variants of them on the arm, while the person holds the leader still."""
        # It brings identification and tuning along, which are slow to import.
        from greywhale.commission import CommissioningRequest, commission
        from greywhale.commission.journal import NAME
        from greywhale.commission.page import save_page

        options = self._options
        out = options.out / "commission"
        (out / NAME).unlink(missing_ok=True)  # of an earlier demo in this folder
        self._bench.command(f"leader {shlex.quote(str((options.out / REST_FILE).resolve()))}")
        outcome = commission(
            CommissioningRequest(
                port=self._bench.port,
                out=out,
                model=learnt.model,
                rounds=1,
                trials=PROVING_TRIALS,
                budget=options.budget,
            ),
            self._report,
        )
        save_page(outcome, out / "report.html")

    def _tell_board(self) -> ParameterTable:
        """Tell the board the arm's supply and joints, as a person would; return the parameters that it then has."""
        defaults = ParameterTable.defaults(Board.NANO328 if self._options.board == "nano" else Board.MEGA2560)
        table = defaults.with_raw({"supply_mv": round(1000 * self._arm.drive.supply)})
        table = table.with_joints(self._arm.joints_in_use)
        if table != defaults:
            with Device(self._bench.port) as device:
                change_parameters(device, table.changes())
        return table


def _motion(options: DemoOptions) -> Trajectory:
    if options.controller is None:
        require_between("the practice", options.practice_s, "s", (10.0, 60.0))
    if options.leader is not None:
        return load_leader(options.leader)
    require_between("the duration", options.duration_s, "s", (multisine.SHORTEST_S, multisine.LONGEST_S))
    return human_reaches(options.seed, options.duration_s)


def _draw(options: DemoOptions, runs: list[Run], supply_v: float) -> Path:
    """The first run and the last: what lies between is too close to the last to be seen."""
    title = f"Follower on the bench: {options.leader.name if options.leader else 'generated reaches'}"
    picture = options.out / "following.png"
    draw_following(picture, [trace(one.recorded.log(), one.name, supply_v) for one in runs], title)
    return picture


def _bench_options(options: DemoOptions) -> list[str]:
    arm = [] if options.arm is None else ["--arm", str(options.arm)]
    return ["--board", options.board, "--blank", "--speed", options.speed, "--seed", str(options.seed), *arm]
