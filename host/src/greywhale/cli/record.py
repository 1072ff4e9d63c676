"""`greywhale record`: a log of leader, follower and voltages."""

from __future__ import annotations

from pathlib import Path

import click

from greywhale.cli.output import json_option, port_option, progress, show
from greywhale.link.device import Device
from greywhale.link.ports import choose_port
from greywhale.log.record import record


@click.command("record")
@click.option(
    "--out", "-o", type=click.Path(path_type=Path), default=Path("log.csv"), show_default=True, help="The log."
)
@click.option("--seconds", "-s", type=float, default=10.0, show_default=True, help="Length, by the board's clock.")
@click.option("--every", type=int, default=1, show_default=True, help="One sample every so many ticks of 1 ms.")
@click.option("--enable", is_flag=True, help="Turn the motors on: the follower follows while the log is recorded.")
@port_option
@json_option
def command(out: Path, seconds: float, every: int, enable: bool, port: str | None, as_json: bool) -> None:
    """Record leader, follower and voltages into a CSV log.

    Without --enable the motors stay off and the log shows what the potentiometers say. With it the log begins when the
    soft start is over. Ctrl-C stops the motors and keeps what was recorded, marked as interrupted.
    A recording that is killed leaves a hidden file beside the log, .NAME.*.part, that `evaluate` reads as unfinished.
    """
    with Device(choose_port(port)) as device, progress(as_json) as report:
        recording = record(device, out, seconds, every, enable, report)
    lost = f", {recording.dropped} dropped by the link" if recording.dropped else ""
    show(
        as_json,
        {"port": device.port, **recording.as_dict()},
        f"{out}: {recording.rows} samples{lost}, {recording.duration_s:g} s.",
    )
