"""`greywhale upload`: a controller.toml into a board."""

from __future__ import annotations

from pathlib import Path

import click

from greywhale.cli.output import json_option, port_option, progress, show
from greywhale.config import controller as controller_file
from greywhale.link.device import Device
from greywhale.link.ports import choose_port
from greywhale.link.upload import upload_controller


@click.command("upload")
@click.argument("controller", type=click.Path(path_type=Path))
@port_option
@json_option
def command(controller: Path, port: str | None, as_json: bool) -> None:
    """Run and store the controllers of a controller.toml.

    The board takes the set over only when all of it has arrived and passed its checks, with the motors off. All other
    parameters (potentiometers, limits, directions) keep their values.
    """
    checked = controller_file.load(controller)
    with Device(choose_port(port)) as device, progress(as_json) as report:
        uploaded = upload_controller(device, controller, report)
    count = len(uploaded.changed)
    what = f"{count} parameters changed" if count else "nothing had to change"
    show(
        as_json,
        {"port": device.port, "controller": str(controller), "source": checked.source, **uploaded.as_dict()},
        f"{controller} runs and is stored on {device.port}: {what}, parameter CRC {uploaded.param_crc:#06x}.",
    )
