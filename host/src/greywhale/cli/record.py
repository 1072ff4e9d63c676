"""`greywhale record`: a log of leader, follower and voltages; on request of a motion that this host leads."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NotRequired, TypedDict

import click

from greywhale.base.errors import MOST_SEED, BadUsage, counted
from greywhale.base.formats.whole import make_folder, refuse_inputs
from greywhale.base.telling import Motions, Sentences, Step, Telling
from greywhale.base.types import Floats, NotedProgress
from greywhale.board.device import Device
from greywhale.board.episodes import EpisodePlan, Episodes, Person, record_episodes
from greywhale.board.pots import FOLLOWERS, require_good_pots
from greywhale.board.reconnect import record_through_losses
from greywhale.board.record import (
    LedRecording,
    LedRecordingFacts,
    Recording,
    RecordingFacts,
    check_every_led,
    pose_of,
    record,
    record_led,
)
from greywhale.board.stream import LeaseLostError
from greywhale.board.upload import read_parameters
from greywhale.cli import completion
from greywhale.cli.countdown import prepare_motion, warn_page, yes_option
from greywhale.cli.keys import person_at_hand
from greywhale.cli.output import FILE, OnPort, json_option, option, overwrite_option, port_option, progress, show, warn
from greywhale.files.leader import save_leader
from greywhale.files.outputs import require_folder, require_new
from greywhale.files.trajectory import Trajectory
from greywhale.loop.leader_motions import poses as visits_of_poses
from greywhale.protocol.holder import meddler
from greywhale.protocol.ports import choose_port
from greywhale.protocol.table import ParameterTable

if TYPE_CHECKING:
    from greywhale.identify.excite import Design

USUAL_LOG = "log.csv"
USUAL_RECORDING_S = 10.0  # without --seconds
# Options that mean nothing without a motion that this host leads, and those that belong to --excite alone.
_OF_LED = {"arm_file": "--arm", "ranges": "--range", "save_motion": "--save-motion"}
_OF_EPISODES = {"task": "--task"}
_OF_EXCITE = {"seed": "--seed", "budget": "--budget"}


class RecordAnswer(OnPort, RecordingFacts):
    pass


class RecordEpisodesAnswer(OnPort):
    task: str  # as the header of each log has it
    episodes: list[RecordingFacts]  # that were kept
    discarded: int  # episodes whose files are gone


class DesignFacts(TypedDict):
    seconds: float  # length of the motion
    log_det: float  # logarithm of the information's determinant
    expected_deviation: dict[str, float]  # parameter to standard deviation
    left_open: list[str]  # parameters that the motion will not show
    largest_lag_rad: float  # on the arms that it was tried on
    evaluations: int  # motions tried


class Saved(TypedDict):
    motion: NotRequired[str]  # with --save-motion


class RecordPosesAnswer(OnPort, LedRecordingFacts, Saved):
    visits: int  # of each pose, from below and from above


class RecordExciteAnswer(OnPort, LedRecordingFacts, Saved):
    design: DesignFacts


@click.command("record")
@option("--out", "-o", type=FILE, default=USUAL_LOG, help="The log.")
@option("--seconds", "-s", type=float, help="Length, by the board's clock.  [default: 10; with --excite: 20]")
@option("--every", type=int, default=1, help="One sample every so many ticks of 1 ms.")
@option("--enable", is_flag=True, help="Turn the motors on: the follower follows while the log is recorded.")
@option(
    "--disengaged", is_flag=True, help="With --enable: begin with the clutch disengaged, so the leader may be anywhere."
)
@option(
    "--reconnect",
    is_flag=True,
    help="Motors off: if the port goes away, wait for it until the end of --seconds, and go on after the gap.",
)
@option(
    "--episodes",
    metavar="N",
    type=click.IntRange(1, 1000),
    help="Record N logs into a folder, --out or else episodes, begun and ended by keys; without a terminal each takes "
    "--seconds.",
)
@option("--task", metavar="TEXT", help="With --episodes: what the arm does in each, for their headers.")
@option("--excite", is_flag=True, help="Turn the motors on and lead the arm along the motion that shows most about it.")
@option(
    "--poses",
    metavar="N",
    type=click.IntRange(2, 100),  # more would take longer than an hour
    help="Turn the motors on and lead the arm N times to each of five poses from either side, for `evaluate "
    "--repeatability`; ISO 9283 has 30, which takes some 11 minutes.",
)
@option(
    "--arm",
    "arm_file",
    shell_complete=completion.arms,
    help="With --excite or --poses: your arm.toml or a model.toml.  [default: white_box]",
)
@option(
    "--range",
    "ranges",
    multiple=True,
    metavar="J:MIN:MAX",
    help="With --excite or --poses: range of a joint in rad, instead of 1 rad to either side of where it is.",
)
@option("--seed", type=click.IntRange(0, MOST_SEED), help="With --excite: another seed, another motion.  [default: 0]")
@option(
    "--budget", type=int, help="With --excite: motions to try; more take longer and show a little more.  [default: 300]"
)
@option(
    "--save-motion", type=FILE, help="With --excite or --poses: also write the motion, for `replay` or `sim --leader`."
)
@overwrite_option
@yes_option
@port_option
@json_option(RecordAnswer | RecordExciteAnswer | RecordPosesAnswer | RecordEpisodesAnswer)
def command(
    out: Path,
    seconds: float | None,
    every: int,
    enable: bool,
    disengaged: bool,
    reconnect: bool,
    episodes: int | None,
    task: str | None,
    excite: bool,
    poses: int | None,
    arm_file: str | None,
    ranges: tuple[str, ...],
    seed: int | None,
    budget: int | None,
    save_motion: Path | None,
    overwrite: bool,
    yes: bool,
    port: str | None,
    as_json: bool,
) -> None:
    """Record leader, follower and voltages into a CSV log.

    Without --enable the motors stay off and the log shows what the potentiometers say. With it the log begins when the
    soft start is over. Ctrl-C stops the motors and keeps what was recorded, marked as interrupted.
    With --disengaged too, the arm holds its pose until `greywhale clutch engage`, or the pedal, takes it up.
    A recording that is killed leaves what it has in log.unfinished.csv beside log.csv, which all verbs read.
    A port that goes away ends the log, which is whole and says so; with --reconnect it goes on when the port is back.
    That never starts a motor.

    With --episodes the follower follows between the logs too, while you set the scene up anew. Enter, the space bar or
    the right arrow begins and ends an episode; Backspace, d or the left arrow discards the one that runs, or the last;
    Esc or q ends it all. The next call goes on with the next number.

    With --excite nobody needs to move the leader: this program leads the arm along a motion designed for `identify`,
    from where the arm is and back; with --poses to five poses again and again. It keeps the joints' limits, but knows
    of no table and no link in the way: clear the arm's surroundings, or narrow the joints' --range. A countdown on the
    terminal comes first, but not on the simulated bench.
    """
    led = [name for name, said in (("--excite", excite), ("--poses", poses is not None)) if said]
    if reconnect and (enable or led):
        raise BadUsage(
            "--reconnect is for logs with the motors off: after a lost port they stay off, so a log of their motion "
            "ends there; leave it out."
        )
    if disengaged and not enable:
        raise BadUsage("--disengaged is for a leader that the follower follows; add --enable.")
    if not excite:
        _refuse(_OF_EXCITE, "--excite", seed=seed, budget=budget)
    if episodes is None:
        _refuse(_OF_EPISODES, "--episodes", task=task)
    elif led or reconnect or overwrite:
        other = led[0] if led else "--reconnect" if reconnect else "--overwrite"
        raise BadUsage(f"--episodes is for motions that a person leads, in new files; leave {other} out.")
    if not led:
        _refuse(_OF_LED, "--excite or --poses", arm_file=arm_file, ranges=ranges, save_motion=save_motion)
        if episodes is not None:
            folder = Path("episodes") if out == Path(USUAL_LOG) else out
            wanted = EpisodePlan(folder, task or "", episodes, seconds, every, enable, disengaged)
            _record_episodes(wanted, port, as_json)
            return
        require_new(overwrite, out)
        chosen, length = choose_port(port), USUAL_RECORDING_S if seconds is None else seconds
        if reconnect:
            with progress() as report:
                recorded = record_through_losses(chosen, out, length, every, report)
        else:
            with Device(chosen) as device, progress() as report, _naming_every():
                if enable:
                    warn_page()
                recorded = record(device, out, length, every, enable, report, disengaged)
        answer: RecordAnswer = {"port": chosen, **recorded.as_dict()}
        show(as_json, answer, tell_recording(chosen, recorded, followed=enable))
        return
    if len(led) > 1:
        raise BadUsage("--excite and --poses are two motions; record one after the other.")
    if enable:
        raise BadUsage(f"{led[0]} turns the motors on by itself; leave --enable out.")
    check_every_led(every)
    refuse_inputs(out, arm_file)
    refuse_inputs(save_motion, arm_file)
    require_new(overwrite, out, save_motion)
    if save_motion is not None and save_motion.resolve() == out.resolve():
        raise BadUsage(f"{out}: the log and the motion cannot be one file; give --save-motion another.")
    plan = _plan_poses(arm_file, ranges, seconds, poses) if poses else _plan(arm_file, ranges, seconds, seed, budget)
    chosen = choose_port(port)
    count_down = prepare_motion(chosen, yes)
    with Device(chosen) as device:
        with progress() as report:
            running = read_parameters(device, report)
            require_good_pots(device, running, FOLLOWERS)
            if arm_file is not None:
                _doubt(arm_file, running)
            designed = plan(pose_of(device), table=running, report=report)
        if save_motion is not None:
            save_leader(save_motion, designed.motion)
        count_down()
        with progress() as report:
            recording = record_led(device, out, designed.motion, every, report, running)
    saved: Saved = {} if save_motion is None else {"motion": str(save_motion)}
    result: RecordExciteAnswer | RecordPosesAnswer
    if isinstance(designed, Visits):
        result = {"port": device.port, **recording.as_dict(), "visits": designed.visits, **saved}
        show(as_json, result, tell_visits(chosen, recording, designed))
    else:
        result = {"port": device.port, **recording.as_dict(), "design": _facts(designed), **saved}
        show(as_json, result, tell_designed(chosen, recording, designed, arm_file))


def _doubt(arm_file: str, table: ParameterTable) -> None:
    """Say now what would be refused when the model of this log is tuned on."""
    from greywhale.files.arm import load_arm
    from greywhale.tune.model_checks import doubt_other_board

    warn(f"{arm_file}: {one.reason}; {one.remedy}." for one in doubt_other_board(load_arm(arm_file), None, table))


def _record_episodes(plan: EpisodePlan, port: str | None, as_json: bool) -> None:
    if not plan.task.strip():
        raise BadUsage(
            '--episodes needs --task, which says what the arm does, such as --task "Put the cup on the plate".'
        )
    require_folder(plan.folder, "episodes")
    chosen = choose_port(port)
    with person_at_hand() as person:
        if person is None:
            plan = replace(plan, seconds=USUAL_RECORDING_S if plan.seconds is None else plan.seconds)
        with Device(chosen) as device, progress() as report, _naming_every():
            if plan.enable:
                warn_page()
            make_folder(plan.folder)
            made = record_episodes(device, plan, person or Person(), report)
    answer: RecordEpisodesAnswer = {
        "port": chosen,
        "task": plan.task,
        "episodes": [one.as_dict() for one in made.kept],
        "discarded": made.discarded,
    }
    show(as_json, answer, tell_episodes(chosen, made, followed=plan.enable))


def _facts(designed: Design) -> DesignFacts:
    rows = zip(designed.problem.parameters, designed.judgement.deviations, strict=True)
    return {
        "seconds": designed.motion.duration_s,
        "log_det": round(designed.judgement.log_det, 3),
        "expected_deviation": {one.name: float(f"{value:.3g}") for one, value in rows},
        "left_open": designed.left_open(),
        "largest_lag_rad": round(float(designed.judgement.tried.lag.max()), 3),
        "evaluations": designed.evaluations,
    }


def _plan(
    arm_file: str | None, ranges: tuple[str, ...], seconds: float | None, seed: int | None, budget: int | None
) -> Callable[..., Design]:
    """Make the design, and refuse whatever can be refused before a board is asked."""
    # Scipy and the native simulation take a moment to import.
    from greywhale.files.arm import load_arm
    from greywhale.identify.excite import BUDGET, SECONDS, check_effort, design, parse_range

    length, effort = SECONDS if seconds is None else seconds, BUDGET if budget is None else budget
    check_effort(length, effort)
    chosen = dict(parse_range(text) for text in ranges)
    return partial(
        design, load_arm(arm_file or "white_box"), ranges=chosen, seconds=length, seed=seed or 0, budget=effort
    )


@dataclass(frozen=True)
class Visits:
    """A motion to poses, again and again."""

    motion: Trajectory
    visits: int


def _plan_poses(
    arm_file: str | None, ranges: tuple[str, ...], seconds: float | None, visits: int
) -> Callable[..., Visits]:
    """Make the visits, and refuse whatever can be refused before a board is asked."""
    from greywhale.files.arm import load_arm
    from greywhale.identify.excite import parse_range, room_of

    if seconds is not None:
        raise BadUsage("--poses takes as long as its visits do; leave --seconds out.")
    arm, chosen = load_arm(arm_file or "white_box"), dict(parse_range(text) for text in ranges)

    def make(pose: Floats, table: ParameterTable, report: NotedProgress) -> Visits:
        return Visits(visits_of_poses(*room_of(arm, table, pose, chosen), visits), visits)

    return make


def _refuse(options: dict[str, str], owner: str, **given: object) -> None:
    for name, value in given.items():
        if value is not None and value != ():
            raise BadUsage(f"{options[name]} belongs to {owner}; add that, or leave it out.")


@contextlib.contextmanager
def _naming_every() -> Iterator[None]:
    """A computer that was late for its lease has more time with rarer samples."""
    try:
        yield
    except LeaseLostError as late:
        late.add_note("Or use a larger --every: 50 makes the lease a second.")
        raise


def tell_recording(port: str, recording: Recording, followed: bool = True) -> Telling:
    """A recording in sentences and as a picture; only one that followed tells about the arm."""
    log = str(recording.path)
    step = Step("evaluate", "Measure how well it followed", {"logs": [log]})
    return Telling(_told(port, recording), [step] if followed else [])


def tell_designed(port: str, recording: Recording, designed: Design, arm_file: str | None) -> Telling:
    """A recording of the motion that shows most about the arm of a file."""
    of_arm = {} if arm_file is None else {"arm_file": arm_file}
    step = Step("identify", "Find the arm that made this log", {"logs": [str(recording.path)], **of_arm})
    return Telling(_told(port, recording, designed.text()), [step])


def _told(port: str, recording: Recording, *more: str) -> tuple[Sentences, Motions]:
    return Sentences((describe(port, recording), *more)), Motions({"follower": str(recording.path)})


def tell_episodes(port: str, made: Episodes, followed: bool) -> Telling:
    """The episodes that were kept, in sentences."""
    gone = f" {counted(made.discarded, 'episode')} discarded." if made.discarded else ""
    logs = [str(one.path) for one in made.kept]
    parts = (Sentences((*(describe(port, one) for one in made.kept), f"{counted(len(logs), 'episode')} kept.{gone}")),)
    return Telling(
        parts, [Step("evaluate", "Measure how well it followed", {"logs": logs})] if followed and logs else ()
    )


def tell_visits(port: str, recording: Recording, made: Visits) -> Telling:
    """A recording of visits, which shows how exactly the arm comes back."""
    said = f"Each of five poses was visited {counted(made.visits, 'time')} from below and from above."
    given = {"logs": [str(recording.path)], "repeatability": True}
    return Telling(_told(port, recording, said), [Step("evaluate", "Measure how exactly it came back", given)])


def describe(port: str, recording: Recording) -> str:
    """A sentence on a recording from a port, and on the causes of lost samples, where those are known."""
    lost = f", {recording.dropped} dropped by the link" if recording.dropped else ""
    waits = slow = ""
    if isinstance(recording, LedRecording):
        if recording.waits:
            waits = f", the board waited {counted(recording.waits, 'time')} for this host"
        if recording.slowest < 1.0:
            slow = f", slowed down to {100 * recording.slowest:.0f} % where a follower lagged"
    gaps = "".join(f" The port was away for {length:g} s after {begin:g} s." for begin, length in recording.gaps)
    samples = counted(recording.rows, "sample")
    remedy = meddler(port) if recording.dropped else None
    loser = "" if remedy is None else f" If it loses samples again, {remedy}."
    return f"{recording.path}: {samples}{lost}, {recording.duration_s:g} s{waits}{slow}.{gaps}{loser}"
