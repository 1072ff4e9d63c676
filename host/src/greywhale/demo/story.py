"""The whole story on the bench: flash, upload, follow, record, measure - with untuned and with tuned controllers."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from greywhale import flash
from greywhale.arm import load_arm
from greywhale.config.paper_tables import paper_table
from greywhale.demo.bench import BenchProcess
from greywhale.demo.result import DemoResult, Run
from greywhale.errors import BAD_USAGE, UserError, because
from greywhale.files import write_text
from greywhale.link import schema
from greywhale.link.device import Device
from greywhale.link.stream import stream
from greywhale.link.upload import upload_controller
from greywhale.log import read_log
from greywhale.log.record import record
from greywhale.measure import evaluate
from greywhale.report.follow import draw_following, trace
from greywhale.trajectory import Trajectory, human_reaches, load_leader, save_leader

Progress = Callable[[str, float], None]

RUNS = (("before tuning", "before", "before_tuning"), ("Table 10", "after", "table_10"))

SHORTEST_S, LONGEST_S = 4.0, 600.0  # of a generated motion
SETTLE_S = 1.0  # recorded after the leader's last movement
LEAD_S = 0.5  # between the end of the soft start and the leader's first movement
READY_RAD = 0.05  # both arms are back at the start within this
READY_WAIT_S = 20.0


@dataclass(frozen=True)
class DemoOptions:
    """What the demo shows."""

    out: Path
    leader: Path | None = None  # CSV of a leader's motion; None: generated human-like reaches
    board: str = "mega"
    arm: Path | None = None
    speed: str = "max"
    duration_s: float = 20.0  # of the generated motion
    seed: int = 1


def run(options: DemoOptions, progress: Progress | None = None) -> DemoResult:
    """Tell the story; everything it shows is in the folder `options.out` afterwards."""
    report = progress or (lambda what, fraction: None)
    started = time.monotonic()
    motion = _motion(options)
    if options.arm is not None:
        load_arm(options.arm)  # the bench loads it again; a bad one must not leave a folder behind
    _make_folder(options.out)
    played = options.leader or options.out / "leader.csv"
    if options.leader is None:
        save_leader(played, motion)
    report("starting the bench", 0.0)
    with BenchProcess(*_bench_options(options, played)) as bench:
        hello = flash.flash(bench.port, options.board, progress=report)
        runs = [_one_run(bench, options.out, motion, *names, report) for names in RUNS]
    title = f"Follower on the bench: {options.leader.name if options.leader else 'generated reaches'}"
    picture = options.out / "following.png"
    report("drawing", 0.0)
    draw_following(picture, [trace(read_log(one.log), one.name) for one in runs], title)
    result = DemoResult(
        leader=str(options.leader) if options.leader else f"generated, seed {options.seed}",
        board=hello.board.key,
        firmware=f"{hello.fw_major}.{hello.fw_minor}.{hello.fw_patch}",
        runs=tuple(runs),
        picture=picture,
        wall_s=time.monotonic() - started,
    )
    write_text(options.out / "summary.json", json.dumps(result.as_dict(), indent=2) + "\n")
    return result


def _motion(options: DemoOptions) -> Trajectory:
    if options.leader is not None:
        return load_leader(options.leader)
    if not SHORTEST_S <= options.duration_s <= LONGEST_S:
        raise UserError(
            f"the duration is {options.duration_s:g} s; it must be {SHORTEST_S:g} to {LONGEST_S:g} s.", BAD_USAGE
        )
    return human_reaches(options.seed, options.duration_s)


def _one_run(
    bench: BenchProcess, out: Path, motion: Trajectory, name: str, file: str, table: str, report: Progress
) -> Run:
    """Upload one set of controllers and let the follower follow the whole motion."""
    log = out / f"{file}.csv"

    def told(what: str, fraction: float) -> None:
        report(f"{name}: {what}", fraction)

    with Device(bench.port) as device:
        crc = upload_controller(device, paper_table(table), told).param_crc
        _wait_for_the_arms(device, motion)
        recording = record(device, log, LEAD_S + motion.duration_s + SETTLE_S, enable=True, progress=told)
    return Run(name, log, crc, recording.rows, recording.dropped, evaluate(read_log(log)))


def _wait_for_the_arms(device: Device, motion: Trajectory) -> None:
    """Until the person at the bench has brought both arms to the start of the motion."""
    scale = schema.Sample.LSB["leader"]
    home = motion.angles[0]
    for one in stream(device, 10):
        arms = np.array([one.sample.leader, one.sample.follower]) * scale
        if np.abs(arms - home).max() < READY_RAD:
            device.telemetry(0)
            return
        if one.elapsed > READY_WAIT_S * 1000:
            raise UserError(
                f"the arms are up to {np.abs(arms - home).max():.2f} rad away from the start of the motion "
                f"{READY_WAIT_S:g} s after the motors went off; this is a fault of the bench, please report it."
            )


def _bench_options(options: DemoOptions, leader: Path) -> list[str]:
    arm = [] if options.arm is None else ["--arm", str(options.arm)]
    return [
        *("--board", options.board, "--blank", "--leader", str(leader), "--speed", options.speed),
        *("--seed", str(options.seed)),
        *arm,
    ]


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"{folder}: cannot be made: {because(error)}.") from None
