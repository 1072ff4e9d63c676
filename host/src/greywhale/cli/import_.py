"""`greywhale import`: logs from recordings of other programs."""

from __future__ import annotations

from pathlib import Path
from typing import TypedDict

import click

from greywhale.base.errors import counted
from greywhale.base.formats.whole import refuse_inputs
from greywhale.base.telling import Sentences, Step, Telling
from greywhale.cli.output import FILE, json_option, option, overwrite_option, show
from greywhale.files.exchange.columns import parse_rule
from greywhale.files.exchange.incoming import import_log
from greywhale.files.exchange.sources import READERS
from greywhale.files.outputs import require_new
from greywhale.protocol.joints import named


class ImportAnswer(TypedDict):
    written: str  # the log
    rows: int
    joints: list[int]  # that the file has; the columns of the others are 0
    remarks: list[str]  # doubts about units, a sentence each


@click.command("import")
@click.argument("file", type=FILE)
@option("--from", "format_", required=True, type=click.Choice(list(READERS)), help="The file's format.")
@option("--out", "-o", required=True, type=FILE, help="The log to write.")
@option(
    "--column",
    "columns",
    multiple=True,
    metavar="COLUMN=NAME[,UNIT[,SIGN[,OFFSET]]]",
    help="A column of the log and the file's column for it; may be said again.",
)
@option("--joint", type=click.IntRange(0, 3), help="With --from bam: the joint of the log.")
@overwrite_option
@json_option(ImportAnswer)
def command(
    file: Path, format_: str, out: Path, columns: tuple[str, ...], joint: int | None, overwrite: bool, as_json: bool
) -> None:
    """Write a recording of another program as a log.

    Columns with a log's names are taken as they are: time_s, leader_0 to follower_3, voltage_0 to voltage_3, state.
    Others are named one by one: --column follower_0=q1,deg,-1,12.5 makes follower_0, in rad, of the column q1, which is
    in degrees, as -q1 + 12.5 degrees. Units: s, ms, us, ns, min, h; rad, mrad, deg, rev; V, mV. A joint needs leader,
    follower and voltage; one without any is not in use. Without a column for state, the motors followed in every row. A
    file that `greywhale export` wrote gives back the log with its facts, unless a column is named.
    """
    refuse_inputs(out, file)
    require_new(overwrite, out)
    found = import_log(file, format_, out, dict(map(parse_rule, columns)), joint)
    answer: ImportAnswer = {
        "written": str(out),
        "rows": found.rows,
        "joints": list(found.joints),
        "remarks": list(found.remarks),
    }
    sentence = f"{out} is written: {counted(found.rows, 'row')} of {named(found.joints)}."
    notes = [f"Note: {remark}" for remark in found.remarks]
    step = Step("evaluate", "Measure how well the follower followed", {"logs": [str(out)]})
    show(as_json, answer, Telling([Sentences([sentence, *notes])], [step]))
