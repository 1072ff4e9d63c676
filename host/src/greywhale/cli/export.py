"""`greywhale export`: logs, controllers and arms in the formats of other programs."""

from __future__ import annotations

from pathlib import Path
from typing import TypedDict

import click

from greywhale.base.formats.whole import refuse_inputs, write_text
from greywhale.cli import completion
from greywhale.cli.output import FILE, json_option, option, overwrite_option, show, warn
from greywhale.files.exchange.formats import FORMATS, require_possible
from greywhale.files.exchange.formats import write as write_logs
from greywhale.files.exchange.recording import ExportOptions, Recording
from greywhale.files.log import read_log
from greywhale.files.outputs import require_new

DRAWS = 2000  # plants of a model, of which the file says the intervals


class ExportAnswer(TypedDict):
    written: list[str]  # files


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
@option("--urdf", metavar="ARM.toml", help="An arm for ROS, Pinocchio and others.")
@option("--mjcf", metavar="ARM.toml", help="An arm for MuJoCo.")
@option("--gears", is_flag=True, help="With --mjcf: a second hinge a joint, with the gear's gap and teeth.")
@option("--out", "-o", required=True, type=FILE, help="The file to write.")
@option("--joint", type=click.IntRange(0, 3), help="With --fis: this joint only, into OUT itself. --to bam needs it.")
@option("--mass", type=float, help="With --to bam: the pendulum's mass, kg.")
@option("--length", type=float, help="With --to bam: its length, m.")
@overwrite_option
@json_option(ExportAnswer)
def command(
    logs: tuple[Path, ...],
    to: str | None,
    fis: Path | None,
    urdf: str | None,
    mjcf: str | None,
    gears: bool,
    out: Path,
    joint: int | None,
    mass: float | None,
    length: float | None,
    overwrite: bool,
    as_json: bool,
) -> None:
    """Write a log in a format of other programs, a controller as MATLAB's .fis, or an arm as URDF or MuJoCo's MJCF.

    A .fis holds one fuzzy controller: without --joint there are four, named OUT_joint0.fis to OUT_joint3.fis. Its
    inputs are Kp e and Kd ce within [-1, 1], its sets those that the firmware stores. Controllers and arms
    are files, or names that come with greywhale: before_tuning, table_8, table_9, table_10; default, worn, two_joints,
    white_box, grey_box, sticky_grey_box.
    """
    if sum(source is not None for source in (to, fis, urdf, mjcf)) != 1 or (to is not None) != bool(logs):
        raise click.UsageError("Give logs and --to, or exactly one of --fis, --urdf and --mjcf.")
    if to is None and (mass is not None or length is not None):
        raise click.UsageError("--mass and --length go with --to bam.")
    if gears and mjcf is None:
        raise click.UsageError("--gears goes with --mjcf: the other formats have no word for them.")
    if to is not None:
        written = _export_logs(logs, to, out, ExportOptions(joint, mass, length), overwrite)
    elif fis is not None:
        written = _export_fis(fis, out, joint, overwrite)
    elif joint is not None:
        raise click.UsageError("--joint goes with --fis: an arm is written whole.")
    else:
        written = [_export_arm(urdf, mjcf, gears, out, overwrite)]
    answer: ExportAnswer = {"written": [str(path) for path in written]}
    show(as_json, answer, "\n".join(answer["written"]))


def _export_logs(logs: tuple[Path, ...], to: str, out: Path, options: ExportOptions, overwrite: bool) -> list[Path]:
    require_possible(to, len(logs), options)
    refuse_inputs(out, *logs)
    require_new(overwrite, out)
    read = [read_log(path) for path in logs]
    warn(remark for log in read for remark in log.remarks)
    return write_logs(to, [Recording(log) for log in read], out, options)


def _export_fis(source: Path, out: Path, joint: int | None, overwrite: bool) -> list[Path]:
    from greywhale.fuzzy.export_fis import export_fis
    from greywhale.fuzzy.settings import load_joints

    joints = load_joints(source)
    stem = out.with_suffix("") if out.suffix == ".fis" else out
    names = [stem.with_name(f"{stem.name}_joint{number}.fis") for number in range(len(joints))]
    files = dict(enumerate(names)) if joint is None else {joint: out}
    for path in files.values():
        refuse_inputs(path, source)
        require_new(overwrite, path)
    for number, path in files.items():
        sets = {key: float(value) for key, value in joints[number].set_values().items()}
        export_fis(path, f"{source.stem}, joint {number}", sets)
    return list(files.values())


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

        drawn = sampled_plants(arm, DRAWS)
    text = export.urdf(arm, drawn) if urdf is not None else export.mjcf(arm, drawn, gears)
    write_text(out, text)
    return out
