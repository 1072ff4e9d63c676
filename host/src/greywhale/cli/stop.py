"""`greywhale stop`: motors off, now."""

from __future__ import annotations

import click

from greywhale.board.device import Device
from greywhale.cli.output import json_option, port_option, show
from greywhale.protocol import schema
from greywhale.protocol.ports import choose_port


@click.command("stop")
@click.option("--clear-fault", is_flag=True, help="Also leave the fault state, if the cause has gone.")
@port_option
@json_option
def command(clear_fault: bool, port: str | None, as_json: bool) -> None:
    """Stop the motors; clear a fault."""
    with Device(choose_port(port)) as device:
        device.stop()
        if clear_fault:
            device.ask(schema.ClearFaultRequest())
        state = device.status().state
    show(as_json, {"port": device.port, "state": state.key}, f"{device.port}: motors off, state {state.key}.")
