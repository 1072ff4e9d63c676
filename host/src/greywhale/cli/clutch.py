"""`greywhale clutch`: the leader arm is moved without the follower, and takes it up again from there."""

from __future__ import annotations

from typing import Annotated

import click

from greywhale.base.errors import UserError
from greywhale.board.device import Device
from greywhale.board.meeting import CLUTCH
from greywhale.board.session import ask_for_clutch
from greywhale.cli.output import OnPort, json_option, port_option, show
from greywhale.protocol import schema
from greywhale.protocol.holder import describe
from greywhale.protocol.ports import choose_port

RESET = "reset"
NEXT = {
    schema.Clutch.ENGAGED: "the follower goes where the leader is, times the ratio.",
    schema.Clutch.DISENGAGED: "move the leader; `greywhale clutch engage` takes the follower up from there.",
    schema.Clutch.SHIFTED: "the follower goes on from where it was; `greywhale clutch reset` ends that.",
}


class ClutchAnswer(OnPort):
    clutch: Annotated[str | None, ("enum", [*(one.key for one in schema.Clutch), None])]  # null: a session was asked
    asked: int | None  # the process that holds the port and has sent it to the board


@click.command("clutch")
@click.argument("action", type=click.Choice((*CLUTCH, RESET)))
@port_option
@json_option(ClutchAnswer)
def command(action: str, port: str | None, as_json: bool) -> None:
    """Disengage the leader arm, engage it where it is, or reset that.

    While it is disengaged the follower holds its pose and the leader can be moved. Engaged, the follower goes on from
    where it is, without a jump, wherever the leader is by now.

    This works while another terminal records (`record --enable --disengaged` begins so), and so does a pedal between
    the board's pin of the clutch and ground. A motion that a host leads does not end by it. A reset needs a free port
    and motors that are off: then the leader's angles count as they are. A restart of the board does the same.
    """
    chosen = choose_port(port)
    holder = ask_for_clutch(chosen, action) if action in CLUTCH else None
    if holder is not None:
        answer: ClutchAnswer = {"port": chosen, "clutch": None, "asked": holder}
        show(as_json, answer, f"{chosen}: {describe(holder)} has told the board to {action} the clutch.")
        return
    with Device(chosen, restart=False) as device:
        clutch = device.clutch(schema.ClutchAction[action.upper()])
    if clutch is schema.Clutch.DISENGAGED and action != "disengage":
        raise UserError(f"{chosen}: the clutch stays disengaged by its pedal; release it, or set clutch_input to 0.")
    answer = {"port": chosen, "clutch": clutch.key, "asked": None}
    show(as_json, answer, f"{chosen}: clutch {clutch.key}: {NEXT[clutch]}")
