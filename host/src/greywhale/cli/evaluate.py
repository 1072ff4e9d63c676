"""`greywhale evaluate`: the measures of a log, and its picture; with --repeatability, those of visits of poses."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NotRequired, TypedDict

import click

from greywhale.base.errors import BadUsage, counted
from greywhale.base.formats.whole import refuse_inputs
from greywhale.base.telling import Column, Motions, Part, Row, Sentences, Step, Table, Telling
from greywhale.cli import completion, torque
from greywhale.cli.output import FILE, json_option, option, overwrite_option, show
from greywhale.cli.repeatability import Measured, RepeatabilityAnswer, draw
from greywhale.files.arm import load_arm
from greywhale.files.log import Log, read_log
from greywhale.files.log.check import Check
from greywhale.files.log.condition import Gap
from greywhale.files.log.driven import tell_powerless
from greywhale.files.outputs import require_new
from greywhale.measure import Evaluation, evaluate
from greywhale.measure.evaluate import EvaluationFacts, JointMeasures
from greywhale.observe import ExternalTorque, estimate_external_torque
from greywhale.observe.torque import TorqueFacts
from greywhale.pictures.kinds import kind_of
from greywhale.protocol.joints import named, unused
from greywhale.protocol.table import ParameterTable

# They stand within 80 columns.
_COLUMNS = (
    Column("", width=7, left=True),
    Column("MSE\n", "rad²", 9),
    Column("steady-state\nerror", "rad", 12),
    Column("settling\nerr.", "rad", 10),
    Column("delay\n", "s", 7),
    Column("onset\ndelay", "s", 9),
    Column("overshoot\n", "%", 10),
    Column("settling\ntime", "s", 9),
)


class LogFacts(EvaluationFacts):
    log: str  # the file
    dropped: int  # samples that the link lost
    complete: bool  # whether nothing ended the recording early
    ended_by: str  # what did
    check: Check  # shortened: rows are missing; changed: rows or header are others; unchecked: it has no check
    gaps: list[Gap]  # where more than ten samples in a row are missing
    remarks: list[str]  # check, gaps and missing voltages in sentences
    external_torque: TorqueFacts | None  # null without --model


class EvaluateAnswer(TypedDict):
    logs: list[LogFacts]  # in the order given
    picture: NotRequired[str]  # with --picture


@click.command("evaluate")
@click.argument("logs", metavar="LOG...", nargs=-1, required=True, type=FILE)
@option("--picture", type=FILE, help="Draw angles, errors and voltages, or visits (.png, .svg or .pdf).")
@option("--repeatability", is_flag=True, help="Measure how exactly the arm came back to poses, by ISO 9283.")
@option(
    "--arm",
    "arm_file",
    shell_complete=completion.arms,
    help="With --repeatability: your arm.toml or a model.toml, for the tip and for play that is known.",
)
@option(
    "--model",
    shell_complete=completion.arms,
    help="A model.toml of `greywhale identify`: tell the torques that acted from outside, and contacts.",
)
@overwrite_option
@json_option(EvaluateAnswer | RepeatabilityAnswer)
def command(
    logs: tuple[Path, ...],
    picture: Path | None,
    repeatability: bool,
    arm_file: str | None,
    model: str | None,
    overwrite: bool,
    as_json: bool,
) -> None:
    """Measure how well the follower followed in a log.

    Per joint: the mean squared error (the total is the sum over the joints), the steady-state error (mean absolute
    error in the last half second of each of the leader's rests), the settling error (the same from half a second after
    the leader came to rest), and the time delay (the lag at which the follower resembles the leader most). For steps
    out of a rest also the time between both onsets, as the paper measures it, the overshoot (how far the follower gets
    beyond the leader's new place, in % of the step), and the settling time (until it stays within 5 % of the step, or
    0.02 rad, of that place); of several steps, the worst.
    Several logs are measured one by one and drawn into one picture. A log that is not as it was recorded, or has gaps,
    is measured too, with a warning.

    With --repeatability a log of `greywhale record --poses`, or any in which the leader rests at the same poses again
    and again, coming from either side. Per joint, and with --arm at the tip: the repeatability RP and accuracy AP of
    ISO 9283, and the lost motion, its multidirectional variation vAP. Several logs, such as without and with a load,
    are also compared with the first, pose by pose.

    With --model also per joint the torque that acted from outside, where it can be told: not at rest, where friction
    holds, not in the gap of a gear, and not just after a turn. No sensor is needed; `known to` is half of the interval
    that holds it in nine cases of ten.
    """
    refuse_inputs(picture, *logs, arm_file, model)
    require_new(overwrite, picture)
    if picture is not None:
        kind_of(picture)
    if repeatability:
        if model is not None:
            raise BadUsage("--model tells torques, and --repeatability places; leave one of them out.")
        _measure_visits(logs, picture, arm_file, as_json)
        return
    if arm_file is not None:
        raise BadUsage("--arm belongs to --repeatability; add that, or leave it out.")
    arm = None if model is None else load_arm(model)
    read, evaluations, warnings = [], [], []
    found: list[ExternalTorque | None] = []
    for path in logs:
        log = read_log(path)
        evaluations.append(evaluate(log))
        warnings.append(_remarks(log))
        found.append(None if arm is None else estimate_external_torque(log, arm))
        read.append(log if picture is not None else log.without_samples())
    results: list[LogFacts] = [
        {
            "log": log.name,
            "dropped": log.dropped,
            "complete": log.complete,
            "ended_by": log.ended_by,
            "check": log.condition.check,
            "gaps": list(log.condition.gaps),
            "remarks": remarks,
            "external_torque": None if outside is None else outside.as_dict(),
            **evaluation.as_dict(),
        }
        for log, evaluation, remarks, outside in zip(read, evaluations, warnings, found, strict=True)
    ]
    parts = [part for one in zip(read, evaluations, warnings, found, strict=True) for part in _tell(*one)]
    answer: EvaluateAnswer = {"logs": results}
    if picture is not None:
        _draw(picture, read, evaluations)
        answer["picture"] = str(picture)
        parts.append(Sentences([f"Picture: {picture}"]))
    followed = [log for log, evaluation in zip(read, evaluations, strict=True) if evaluation.following]
    find = Step("identify", "Find the arm that made this", {"logs": [log.name for log in followed]})
    steps = [find] if followed and not any(map(_is_tuned, followed)) else []
    show(as_json, answer, Telling(parts, steps))


def _measure_visits(logs: tuple[Path, ...], picture: Path | None, arm_file: str | None, as_json: bool) -> None:
    measured = Measured(None if arm_file is None else load_arm(arm_file))
    remarks = []
    for path in logs:
        log = read_log(path)
        measured.take(log)
        remarks.append(_remarks(log))
    parts = [part for number, said in enumerate(remarks) for part in measured.tell(number, said)]
    parts.append(measured.tell_unseen())
    answer: RepeatabilityAnswer = {"logs": [measured.facts(number, said) for number, said in enumerate(remarks)]}
    if picture is not None:
        draw(picture, measured)
        answer["picture"] = str(picture)
        parts.append(Sentences([f"Picture: {picture}"]))
    show(as_json, answer, Telling(parts))


def _is_tuned(log: Log) -> bool:
    """True where other controllers ran than a board's as it is shipped: then a model was found before."""
    return log.origin.table is not None and log.origin.table.controllers != ParameterTable.defaults().controllers


def _remarks(log: Log) -> list[str]:
    return [*log.remarks, *(f"{log.name}: {sentence}." for sentence in tell_powerless(log))]


def _draw(picture: Path, logs: list[Log], evaluations: list[Evaluation]) -> None:
    # Matplotlib takes a second to import, and most evaluations draw nothing.
    from greywhale.pictures.follow import draw_following, trace
    from greywhale.pictures.names import distinct_names

    names = distinct_names([log.name for log in logs])
    each = zip(logs, names, evaluations, strict=True)
    traces = [trace(log, name, measured=measures) for log, name, measures in each]
    draw_following(picture, traces, "Leader and follower")


def _tell(log: Log, evaluation: Evaluation, warnings: list[str], outside: ExternalTorque | None) -> Iterator[Part]:
    notes = [f"{counted(evaluation.samples, 'sample')}, {_covered(evaluation)}"]
    if log.dropped:
        notes.append(f"{log.dropped} dropped")
    if not log.complete:
        notes.append("recording interrupted" + (f" ({log.ended_by.rstrip('.')})" if log.ended_by else ""))
    if not evaluation.following:
        notes.append("the motors never followed; the whole log is measured")
    yield Sentences([f"{log.name}: {', '.join(notes)}"])
    rows = [_row(number, evaluation.joints[number]) for number in evaluation.joints_in_use]
    yield Table(_COLUMNS, [*rows, Row(["total", f"{evaluation.total_mse:.6f}"])], near=True)
    ripples = [evaluation.joints[number].ripple_v for number in evaluation.joints_in_use]
    lines = []
    if None not in ripples:
        lines.append(f"Ripple of the voltage above 20 Hz, V rms: {', '.join(f'{volts:.2f}' for volts in ripples)}")
    idle = unused(evaluation.joints_in_use)
    if idle:
        lines.append(f"{named(idle).capitalize()} {'is' if len(idle) == 1 else 'are'} not in use.")
    yield Sentences(lines, near=True)
    if outside is not None:
        yield from torque.tell(outside, evaluation.joints_in_use)
    lost = [
        f"Joint {number} does not follow its leader at all: check its potentiometers, its motor and their signs."
        for number, joint in enumerate(evaluation.joints)
        if evaluation.following and not joint.follows
    ]
    yield Sentences([*lost, *(f"Warning: {one}" for one in warnings)], grave=True, near=True)
    yield Motions({"follower": log.name})


def _covered(evaluation: Evaluation) -> str:
    """The measured time, and of how much where it is not all of the log."""
    measured, span = f"{evaluation.duration_s:.2f} s", f"{evaluation.span_s or 0.0:.2f} s"
    return measured if measured == span else f"{measured} of the log's {span}"


def _row(number: int, joint: JointMeasures) -> Row:
    errors = f"{joint.mse:.6f}", _number(joint.steady_state_error), _number(joint.settling_error)
    delays = _number(joint.delay_s), _number(joint.onset_delay_s)
    steps = _number(joint.overshoot_percent, ".1f"), joint.settling(".3f") or "n/a"
    return Row([f"joint {number}", *errors, *delays, *steps])


def _number(value: float | None, form: str = ".4f") -> str:
    return "n/a" if value is None else f"{value:{form}}"
