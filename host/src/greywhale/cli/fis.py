"""`greywhale fis`: what a .fis holds, what can run it, and its sets in a controller."""

from __future__ import annotations

from pathlib import Path
from typing import NotRequired, TypedDict

import click

from greywhale.base.errors import counted
from greywhale.base.formats.whole import refuse_inputs
from greywhale.cli import completion
from greywhale.cli.output import FILE, json_option, option, overwrite_option, show
from greywhale.files import fis as fis_file
from greywhale.files.outputs import require_new
from greywhale.protocol.firmware import JOINTS


class VariableFacts(TypedDict):
    name: str
    low: float
    high: float
    sets: list[str]  # NAME: kind [numbers]


class FisAnswer(TypedDict):
    name: str
    type: str
    inputs: list[VariableFacts]
    outputs: list[VariableFacts]
    rules: int
    remarks: list[str]  # what is odd in the file
    not_on_an_arm: list[str]  # why the firmware cannot run it; empty where it can
    not_in_a_header: list[str]  # why `export --header` does not take it; empty where it does
    written: NotRequired[list[str]]  # with --controller


@click.command("fis")
@click.argument("file", type=FILE)
@option(
    "--controller",
    metavar="CONTROLLER.toml",
    type=FILE,
    shell_complete=completion.controllers,
    help="Take the file's sets into a joint of this controller.",
)
@option("--joint", type=click.IntRange(0, JOINTS - 1), help="With --controller: the joint.")
@option("--out", "-o", type=FILE, help="With --controller: the file to write.")
@overwrite_option
@json_option(FisAnswer)
def command(
    file: Path, controller: Path | None, joint: int | None, out: Path | None, overwrite: bool, as_json: bool
) -> None:
    """Tell what a .fis of MATLAB holds, and what can run it.

    A .fis that `greywhale export --fis` wrote, or one with the same three sets a variable and the same rules, runs on
    an arm: --controller takes its sets into one joint of a copy of that controller, and leaves gains and the other
    joints. Many others become a C++ header: `greywhale export --header`.
    """
    if len({controller is None, joint is None, out is None}) != 1:
        raise click.UsageError("--controller, --joint and --out go together.")
    if out is not None:
        refuse_inputs(out, file, controller)
        require_new(overwrite, out)
    answer, text = _describe(fis_file.load(file), str(file))
    if controller is not None and joint is not None and out is not None:
        _write(file, controller, joint, out)
        answer["written"] = [str(out)]
        text = str(out)
    show(as_json, answer, text)


def _describe(fis: fis_file.Fis, path: str) -> tuple[FisAnswer, str]:
    from greywhale.base.errors import UserError
    from greywhale.fuzzy.header_proof import require_no_hole
    from greywhale.fuzzy.import_fis import firmware_obstacles
    from greywhale.fuzzy.table_law import from_fis, obstacles

    not_in_a_header = obstacles(fis)
    if not not_in_a_header:
        try:
            require_no_hole(from_fis(fis, path))
        except UserError as error:
            not_in_a_header = [error.message.removeprefix(f"{path}: ").removesuffix(".")]
    answer: FisAnswer = {
        "name": fis.name,
        "type": fis.method("type", "mamdani")[0],
        "inputs": [_facts(one) for one in fis.inputs],
        "outputs": [_facts(one) for one in fis.outputs],
        "rules": len(fis.rules),
        "remarks": list(fis.remarks),
        "not_on_an_arm": firmware_obstacles(fis),
        "not_in_a_header": not_in_a_header,
    }
    return answer, _text(answer)


def _facts(variable: fis_file.Variable) -> VariableFacts:
    sets = [f"{one.name}: {one.kind} [{' '.join(f'{number:g}' for number in one.numbers)}]" for one in variable.sets]
    return {"name": variable.name, "low": variable.low, "high": variable.high, "sets": sets}


def _text(answer: FisAnswer) -> str:
    lines = [f"{answer['name']}: {answer['type']}, {counted(answer['rules'], 'rule')}"]
    for kind, variables in (("input", answer["inputs"]), ("output", answer["outputs"])):
        for one in variables:
            lines.append(f"{kind} {one['name']}, {one['low']:g} to {one['high']:g}")
            lines += [f"  {each}" for each in one["sets"]]
    lines += [f"odd: {remark}" for remark in answer["remarks"]]
    for where, reasons in (
        ("On an arm (--controller)", answer["not_on_an_arm"]),
        ("As a header (greywhale export --header)", answer["not_in_a_header"]),
    ):
        lines.append(f"{where}: {'no' if reasons else 'yes'}.")
        lines += [f"  {reason}" for reason in reasons]
    return "\n".join(lines)


def _write(file: Path, controller: Path, joint: int, out: Path) -> None:
    from dataclasses import replace

    from greywhale.files import controller as controller_file
    from greywhale.fuzzy.import_fis import sets_of
    from greywhale.fuzzy.settings import SET_UNIT, JointSettings

    sets = sets_of(fis_file.load(file), str(file))
    base = controller_file.load(controller)
    joints = [JointSettings.of(one) for one in base.joint]
    joints[joint] = replace(joints[joint], **{name: round(value * SET_UNIT) for name, value in sets.items()})
    travel = None if base.travel is None else {one.name: one.to_raw(value) for one, value in base.travel.parameters()}
    controller_file.save(
        out,
        [one.as_tuple() for one in joints],
        f"{controller.name}, the sets of joint {joint} from {file.name}",
        travel=travel,
        stall_volts=base.stall_volts,
    )
