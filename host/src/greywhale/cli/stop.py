"""`greywhale stop`: motors off, now, also while another terminal uses the port."""

from __future__ import annotations

from typing import Any, NotRequired

import click

from greywhale.base.errors import UserError
from greywhale.board.device import Device
from greywhale.board.session import ask_to_stop
from greywhale.cli.output import OnPort, json_option, option, port_option, show
from greywhale.protocol import schema
from greywhale.protocol.ports import choose_port
from greywhale.protocol.transport import PortBusyError


class StopAnswer(OnPort):
    state: str | None  # of the board
    restarted: NotRequired[bool]  # whether opening the port restarted the board
    ended: NotRequired[int]  # process that held the port, and ends
    goes_on: NotRequired[int]  # process that held the port, and takes the board again: a dashboard


@click.command("stop")
@option("--clear-fault", is_flag=True, help="Also leave the fault state, if the cause has gone.")
@port_option
@json_option(StopAnswer)
def command(clear_fault: bool, port: str | None, as_json: bool) -> None:
    """Stop the motors; clear a fault.

    What holds the port (record, replay, commission, demo, a notebook) is ended as Ctrl-C would, in whatever terminal it
    runs: it turns the motors off at once, without a restart of the board, and keeps what it recorded. A dashboard goes
    on: it ends the verb that moves the arm, and starts no motor before a person asks anew.

    A free port is opened without a restart of the board too, if a greywhale had it last; after any other program, or
    after the cable was plugged in, opening it restarts an Arduino, which also turns the motors off and clears a fault.
    """
    chosen = choose_port(port)
    session = ask_to_stop(chosen, wait_for_end=clear_fault)
    if session is not None and not clear_fault:
        answer: StopAnswer = {"port": chosen, "state": session["state"]}
        holder = _tell_holder(answer, session)
        state = f", state {session['state']}" if session["state"] else ""
        show(as_json, answer, f"{chosen}: motors off{state}; {holder}.")
        return
    with _open(chosen) as device:
        device.stop()
        if clear_fault:
            device.ask(schema.ClearFaultRequest())
        state = device.status().state.key
    answer = {"port": device.port, "state": state, "restarted": device.restarted}
    if session is not None:
        _tell_holder(answer, session)
    restart = " Opening the port restarted the board." if device.restarted else ""
    show(as_json, answer, f"{device.port}: motors off, state {state}.{restart}")


def _tell_holder(answer: StopAnswer, session: dict[str, Any]) -> str:
    """Write into the answer what became of the process that held the port; the same in words."""
    if "goes_on" in session:
        answer["goes_on"] = session["pid"]
        return f"the dashboard (process {session['pid']}) goes on, and starts no motor before a person asks anew"
    answer["ended"] = session["pid"]
    return f"what held the port (process {session['pid']}) ends"


def _open(port: str) -> Device:
    """The board on a port that no session of this user holds."""
    try:
        return Device(port, restart=False)
    except PortBusyError as busy:
        raise UserError(
            f"Switch the motors' supply off: `greywhale stop` cannot reach the arm. {busy.message}"
        ) from None
