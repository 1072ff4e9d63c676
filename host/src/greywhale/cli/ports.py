"""`greywhale ports`: the serial ports of this machine and the running benches, without opening any of them."""

from __future__ import annotations

from typing import TypedDict

import click

from greywhale.cli.output import json_option, show
from greywhale.protocol.ports import PortFacts, find_ports


class PortsAnswer(TypedDict):
    ports: list[PortFacts]


@click.command("ports")
@json_option(PortsAnswer)
def command(as_json: bool) -> None:
    """List the serial ports and what is behind them.

    No port is opened, because opening resets an Arduino; `greywhale info` asks a board who it is.
    """
    ports = find_ports()
    width = max((len(port.device) for port in ports), default=0)
    lines = [f"{port.device:<{width}}  {port.description}" for port in ports]
    text = "\n".join(lines) or "No serial ports; plug a board in, or start a simulated one with `greywhale sim`."
    answer: PortsAnswer = {"ports": [port.as_dict() for port in ports]}
    show(as_json, answer, text)
