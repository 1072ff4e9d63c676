"""`greywhale calibrations`: the calibrations that a board has had, and the way back to one."""

from __future__ import annotations

from datetime import datetime

import click

from greywhale.base.telling import Part, Sentences, Step, Telling
from greywhale.board.calibrate import history
from greywhale.board.calibrate.earlier import KeptFacts, earlier
from greywhale.board.device import Device
from greywhale.board.upload import change_parameters, read_parameters
from greywhale.cli.output import OnPort, json_option, option, port_option, progress, show
from greywhale.protocol.ports import choose_port

# The reasons for a file, as its name says them.
WHY = {
    history.FOUND: "as the board was found",
    "calibrate": "after greywhale calibrate",
    "page": "after Calibrate in the page",
    "set": "after a change of parameters",
    "restore": "after greywhale params restore",
    "back": "after going back",
}


class CalibrationsAnswer(OnPort):
    folder: str  # of this board's calibrations
    back_to: int | None  # with --back: the number that the board went back to
    calibrations: list[KeptFacts]  # the oldest first; the last one is what the board has


@click.command("calibrations")
@option("--back", type=click.IntRange(min=1), metavar="N", help="Go back: run and store calibration N.")
@port_option
@json_option(CalibrationsAnswer)
def command(back: int | None, port: str | None, as_json: bool) -> None:
    """List the calibrations that a board has had, with what changed, and go back to one.

    Going back changes zero, scale, limits and motor_sign alone: controllers and everything else stay. What the board
    has is kept first, so that no calibration is lost.
    """
    with Device(choose_port(port)) as device, progress(brief=True) as report:
        folder = history.folder_of(device.port)
        wanted = None if back is None else history.find(folder, back)
        changes = {} if wanted is None else wanted.values()
        running = read_parameters(device, report)
        history.keep(folder, running, history.FOUND)
        if changes:
            with history.keeping(device.port, running, running.with_raw(changes), "back"):
                change_parameters(device, changes, report, running)
    found = earlier(folder)
    answer: CalibrationsAnswer = {
        "port": device.port,
        "folder": str(folder),
        "back_to": back,
        "calibrations": found,
    }
    show(as_json, answer, Telling(_tell(answer), _next(found)))


def _tell(answer: CalibrationsAnswer) -> list[Part]:
    """Each with its date by this computer's clock, and below it what changed."""
    parts: list[Part] = []
    for one in answer["calibrations"]:
        when = datetime.fromisoformat(one["when"]).astimezone()
        title = f"{one['number']}: {when:%Y-%m-%d %H:%M}, {WHY.get(one['why'], one['why'])}"
        lines = [one["problem"]] if one["problem"] is not None else one["changed"]
        first = not parts
        parts.append(Sentences(lines or (["the first that was kept"] if first else []), title, listed=True))
    newest = answer["calibrations"][-1]["number"]
    if answer["back_to"] is not None:
        parts.append(Sentences([f"The board runs and keeps calibration {answer['back_to']} again, as {newest}."]))
    else:
        parts.append(Sentences([f"The board has calibration {newest}; all are files in {answer['folder']}."]))
    return parts


def _next(found: list[KeptFacts]) -> list[Step]:
    if len(found) == 1:
        return [Step("calibrate", "Calibrate")]
    earlier = found[-2]["number"]
    return [Step("calibrations", f"Go back to calibration {earlier}", {"back": earlier})]
