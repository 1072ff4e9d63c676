"""`greywhale doctor`: what is wrong with this set-up, and how to mend it."""

from __future__ import annotations

from pathlib import Path

import click

from greywhale.base.errors import BadUsage, counted, require_between
from greywhale.base.telling import Column, Row, Sentences, Step, Table, Telling
from greywhale.board.doctor import Finding, Verdict, examine, worst
from greywhale.board.limits import DOCTOR
from greywhale.cli.output import FILE, OnPort, json_option, option, port_option, progress, require_supply, show
from greywhale.protocol.ports import choose_port

_COLUMNS = (Column(width=5, left=True), Column(width=14, left=True), Column(width=1, left=True))


class DoctorAnswer(OnPort):
    verdict: Verdict  # the gravest
    findings: list[Finding]


@click.command("doctor")
@port_option
@option("--params", type=FILE, metavar="FILE", help="A parameter file that the board should run.")
@option("--seconds", default=DOCTOR.link_s, help="How long the link is loaded.")
@option("--supply", type=float, metavar="VOLTS", help="What you measured at the motors' supply.")
@option(
    "--image", is_flag=True, help="Also read the firmware back and compare it with the shipped one; the board restarts."
)
@option("--hex", "hex_file", type=FILE, metavar="FILE", help="With --image: compare with this file.")
@json_option(DoctorAnswer)
@click.pass_context
def command(
    context: click.Context,
    port: str | None,
    params: Path | None,
    seconds: float,
    supply: float | None,
    image: bool,
    hex_file: Path | None,
    as_json: bool,
) -> None:
    """Look at port, firmware, parameters, potentiometers and link: what is wrong, and how to mend it.

    The motors stay off. Keep both arms still. The exit code is 1 when something must be mended.
    """
    require_between("--seconds", seconds, "", (0.5, 3600.0))
    if supply is not None:
        require_supply(supply)
    if hex_file is not None and not image:
        raise BadUsage("--hex belongs to --image; add that, or leave it out.")
    chosen = choose_port(port)
    with progress(brief=True) as report:
        findings = examine(chosen, params, seconds, supply, image, hex_file, report)
    verdict = worst(findings)
    answer: DoctorAnswer = {"port": chosen, "verdict": verdict, "findings": findings}
    rows = [Row((one.verdict.value, one.check, one.says), below=one.remedy) for one in findings]
    show(as_json, answer, Telling((Table(_COLUMNS, rows), Sentences((_summary(findings),))), _next(verdict, findings)))
    context.exit(int(verdict is Verdict.BAD))


def _next(verdict: Verdict, findings: list[Finding]) -> list[Step]:
    """Look again at what was mended, calibrate what is not, or let the arm be learnt."""
    if verdict is Verdict.BAD:
        return [Step("doctor", "Look again")]
    if any(one.check == "calibration" and one.verdict is not Verdict.GOOD for one in findings):
        return [Step("calibrate", "Calibrate the potentiometers")]
    return [Step("commission", "Find and prove controllers on this arm")]


def _summary(findings: list[Finding]) -> str:
    bad = sum(one.verdict is Verdict.BAD for one in findings)
    notes = sum(one.verdict is Verdict.NOTE for one in findings)
    if bad:
        good = sum(one.verdict is Verdict.GOOD for one in findings)
        return f"Mend {counted(bad, 'finding')} before the arm moves; {good} of {len(findings)} are good."
    return f"Nothing must be mended{f'; {notes} note' + 's' * (notes > 1) if notes else ''}."
