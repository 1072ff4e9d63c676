"""`greywhale export`: logs, controllers and arms in the formats of other programs."""

from __future__ import annotations

from pathlib import Path
from typing import NotRequired, TypedDict

import click
import numpy as np

from greywhale.base.formats.whole import refuse_inputs, write_text
from greywhale.cli import completion
from greywhale.cli.export_controller import HeaderFacts, export_fis, export_headers, facts_of, has_joints, tell_headers
from greywhale.cli.output import FILE, json_option, option, overwrite_option, show, warn
from greywhale.files.exchange.formats import FORMATS, require_possible
from greywhale.files.exchange.formats import write as write_logs
from greywhale.files.exchange.recording import ExportOptions, JointColumns, Recording
from greywhale.files.log import Log, read_log
from greywhale.files.outputs import require_new, require_new_folder


class ExportAnswer(TypedDict):
    written: list[str]  # files
    headers: NotRequired[list[HeaderFacts]]  # with --header, one a file


_LINES = [f"{name}, {one.does.rstrip('.')}" for name, one in FORMATS.items()]


@click.command("export")
@click.argument("logs", metavar="[LOG]...", nargs=-1, type=FILE)
@option("--to", type=click.Choice(list(FORMATS)), help=f"Logs as: {'; '.join(_LINES)}.")
@option(
    "--fis",
    metavar="CONTROLLER.toml",
    type=FILE,
    shell_complete=completion.controllers,
    help="A controller for MATLAB.",
)
@option("--header", metavar="FILE", type=FILE, help="A law (.fis or controller.toml) as one C++ header.")
@option("--urdf", metavar="ARM.toml", help="An arm for ROS, Pinocchio and others.")
@option("--mjcf", metavar="ARM.toml", help="An arm for MuJoCo.")
@option("--gears", is_flag=True, help="With --mjcf: a second hinge a joint, with the gear's gap and teeth.")
@option("--out", "-o", required=True, type=FILE, help="The file to write, or with --to lerobot the folder.")
@option("--joint", type=click.IntRange(0, 3), help="Of a controller: this joint alone, into OUT. --to bam needs it.")
@option("--mass", type=float, help="With --to bam: the pendulum's mass, kg.")
@option("--length", type=float, help="With --to bam: its length, m.")
@option("--fps", type=click.IntRange(1, 1000), help="With --to lerobot: frames a second.  [default: 30]")
@option("--task", metavar="TEXT", help="With --to lerobot: the task in words, for logs that name none or another.")
@option("--model", shell_complete=completion.arms, help="With --to: add the torque from outside, by this model.toml.")
@overwrite_option
@json_option(ExportAnswer)
def command(
    logs: tuple[Path, ...],
    to: str | None,
    fis: Path | None,
    header: Path | None,
    urdf: str | None,
    mjcf: str | None,
    gears: bool,
    out: Path,
    joint: int | None,
    mass: float | None,
    length: float | None,
    fps: int | None,
    task: str | None,
    model: str | None,
    overwrite: bool,
    as_json: bool,
) -> None:
    """Write a log for other programs, a controller as .fis (MATLAB) or C++ header, or an arm as URDF or MuJoCo's MJCF.

    A .fis holds one fuzzy controller: without --joint there are four, named OUT_joint0.fis to OUT_joint3.fis. Its
    inputs are Kp e and Kd ce within [-1, 1], its sets those that the firmware stores. Controllers and arms
    are files, or names that come with greywhale: before_tuning, table_8, table_9, table_10; default, worn, two_joints,
    white_box, grey_box, sticky_grey_box.

    A header holds one law in integers for any chip or PC, without heap or float: its tables, a PD+I, test vectors, and
    how far it is from the exact centroid. It takes a controller as --fis does, or any .fis of two inputs and one
    output, with triangles and trapezoids and up to 7 x 7 rules, that has no hole.
    """
    if sum(source is not None for source in (to, fis, header, urdf, mjcf)) != 1 or (to is not None) != bool(logs):
        raise click.UsageError("Give logs and --to, or exactly one of --fis, --header, --urdf and --mjcf.")
    options = ExportOptions(joint, mass, length, fps, task, model)
    if to is None and options != ExportOptions(joint):
        raise click.UsageError("--mass, --length, --fps, --task and --model are for logs; give --to.")
    if gears and mjcf is None:
        raise click.UsageError("--gears goes with --mjcf: the other formats have no word for them.")
    if joint is not None and to is None and not has_joints(fis or header):
        raise click.UsageError("--joint goes with a controller: anything else is written whole.")
    if header is not None:
        headers = export_headers(header, out, joint, overwrite)
        facts: ExportAnswer = {"written": [str(path) for path in headers], "headers": facts_of(headers)}
        show(as_json, facts, tell_headers(headers))
        return
    if to is not None:
        written = _export_logs(logs, to, out, options, overwrite)
    elif fis is not None:
        written = export_fis(fis, out, joint, overwrite)
    else:
        written = [_export_arm(urdf, mjcf, gears, out, overwrite)]
    answer: ExportAnswer = {"written": [str(path) for path in written]}
    show(as_json, answer, "\n".join(answer["written"]))


def _export_logs(logs: tuple[Path, ...], to: str, out: Path, options: ExportOptions, overwrite: bool) -> list[Path]:
    require_possible(to, len(logs), options)
    refuse_inputs(out, *logs)
    if FORMATS[to].folder:
        require_new_folder(overwrite, out, *FORMATS[to].folder)
    else:
        require_new(overwrite, out)
    recordings = (_read(path, options.model) for path in logs)  # one at a time: a log of an hour is large
    return write_logs(to, recordings, out, options)


def _read(path: Path, model: str | None) -> Recording:
    log = read_log(path)
    warn(log.remarks)
    return Recording(log, _torque(log, model))


def _torque(log: Log, model: str | None) -> tuple[JointColumns, ...]:
    """The torque from outside (0 where it cannot be told), half of its interval's width, and 1 where it is told."""
    if model is None:
        return ()
    from greywhale.files.arm import load_arm
    from greywhale.observe import estimate_external_torque

    found = estimate_external_torque(log, load_arm(model))
    return (
        JointColumns("external_torque", "N m", found.torque * found.told),
        JointColumns("external_torque_half_width", "N m", found.half_width),
        JointColumns("external_torque_told", "", found.told.astype(np.float64)),
    )


def _export_arm(urdf: str | None, mjcf: str | None, gears: bool, out: Path, overwrite: bool) -> Path:
    from greywhale.arm import export
    from greywhale.arm.plants import plant_row
    from greywhale.files.arm import load_arm

    refuse_inputs(out, urdf, mjcf)
    require_new(overwrite, out)
    arm = load_arm(urdf if urdf is not None else str(mjcf))
    drawn = plant_row(arm)[None]
    if "covariance" in (arm.identification or {}):
        from greywhale.identify import sampled_plants

        drawn = sampled_plants(arm, 2000)  # the file says their intervals
    text = export.urdf(arm, drawn) if urdf is not None else export.mjcf(arm, drawn, gears)
    write_text(out, text)
    return out
