"""`greywhale upload`: a controller.toml into a board."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import click

from greywhale.base.errors import UserError, counted
from greywhale.base.telling import Step, told
from greywhale.board.device import Device
from greywhale.board.upload import UploadFacts, change_parameters, read_parameters
from greywhale.cli import completion
from greywhale.cli.output import FILE, OnPort, json_option, option, port_option, progress, show, tell
from greywhale.cli.person import Terminal
from greywhale.files import controller as controller_file
from greywhale.protocol.ports import choose_port
from greywhale.protocol.table import ParameterTable

MOST_NAMED = 3  # margins or joints in a warning
_RECORD = Step("record", "Record how the arm follows now", {"enable": True, "out": "following.csv"})


class UploadAnswer(OnPort, UploadFacts):
    controller: str  # the file
    source: str  # what the file says of its numbers
    warnings: list[str]


@click.command("upload")
@click.argument("controller", type=FILE, shell_complete=completion.controllers)
@option("--yes", "-y", is_flag=True, help="Store it without a question, also where a joint may swing or follow worse.")
@port_option
@json_option(UploadAnswer)
def command(controller: Path, yes: bool, port: str | None, as_json: bool) -> None:
    """Run and store the controllers of a controller.toml, or of one that comes with greywhale.

    Those are before_tuning, and table_8, table_9 and table_10 of the paper.
    The board takes the set over only when all of it has arrived and passed its checks, with the motors off. All other
    parameters (potentiometers, limits, directions) keep their values. Where a joint may swing that did not before, or
    follow worse, a terminal is asked first.
    """
    checked = controller_file.load(controller)
    with Device(choose_port(port)) as device:
        with progress(brief=True) as report:
            running = read_parameters(device, report)
        warnings = _warnings(checked.tuning or {}, running)
        for warning in warnings:  # while Ctrl-C still leaves everything as it was
            tell(f"Warning: {warning}")
        asked = _is_worse(checked.tuning or {}) and not (yes or as_json) and sys.stdin.isatty()
        if asked and not _agrees():
            raise UserError(f"{device.port}: nothing was uploaded; the board keeps its controllers.")
        with progress(brief=True) as report:
            uploaded = change_parameters(device, checked.raw_values(), report, running)
    count = len(uploaded.changed)
    what = f"{counted(count, 'parameter')} changed" if count else "nothing had to change"
    answer: UploadAnswer = {
        "port": device.port,
        "controller": str(controller),
        "source": checked.source,
        "warnings": warnings,
        **uploaded.as_dict(),
    }
    text = f"{controller} runs and is stored on {device.port}: {what}, parameter CRC {uploaded.param_crc:#06x}."
    show(as_json, answer, told(text, steps=[_RECORD]))


def _warnings(tuning: Mapping[str, Any], table: ParameterTable) -> list[str]:
    """Warn where the board is not the one that was tuned for, or where the tuning's result is not what it should be."""
    warnings = []
    if str(tuning.get("status", "complete")) != "complete":
        warnings.append("the tuning of this controller is not finished.")
    if _margins_fail(tuning):
        warnings.append(f"a joint may swing if the arm is not quite as its model; {_failing(tuning)}.")
    if worse := _worse_followers(tuning):
        warnings.append(f"by its model, a joint follows worse than before the tuning: {_some(worse)}.")
    made_for = tuning.get("board")
    if isinstance(made_for, str) and made_for != table.board.key:
        warnings.append(f"it was tuned for the board {made_for}, but this board is a {table.board.key}.")
    for key, name, scale in (("period_ms", "period_ms", 1.0), ("supply_v", "supply_mv", 1e-3)):
        tuned = tuning.get(key)
        if not isinstance(tuned, int | float):
            continue
        board = table[name] * scale
        if abs(board - tuned) > 0.02 * board:
            warnings.append(f"it was tuned for {name} = {tuned / scale:g}, but this board has {board / scale:g}.")
    return warnings


def _agrees() -> bool:
    with contextlib.closing(Terminal()) as person:
        return person.agrees("Store these controllers all the same?")


def _margins_fail(tuning: Mapping[str, Any]) -> bool:
    return tuning.get("margins_hold") is False


def _worse_followers(tuning: Mapping[str, Any]) -> list[str]:
    found = tuning.get("follows_worse")
    return list(map(str, found)) if isinstance(found, list) else []


def _is_worse(tuning: Mapping[str, Any]) -> bool:
    """True for a tuning that is worse in some respect than what was before it."""
    return _margins_fail(tuning) or bool(_worse_followers(tuning))


def _some(found: Sequence[str]) -> str:
    """The first few, and how many more there are."""
    more = f" and {len(found) - MOST_NAMED} more" if len(found) > MOST_NAMED else ""
    return "; ".join(found[:MOST_NAMED]) + more


def _failing(tuning: Mapping[str, Any]) -> str:
    """The first few margins that do not hold, each as joint and case."""
    notes = tuning.get("notes")
    failing = [str(note).partition(":")[0] for note in notes] if isinstance(notes, list) else []
    return f"these margins do not hold: {_some(failing)}" if failing else "a margin does not hold"
