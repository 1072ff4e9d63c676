"""`greywhale replay`: leads the arm along a motion from a file, and records a log of it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import click

from greywhale.base.formats.whole import refuse_inputs
from greywhale.board.device import Device
from greywhale.board.record import LedRecordingFacts, check_every_led, record_led
from greywhale.cli.countdown import prepare_motion, yes_option
from greywhale.cli.output import FILE, OnPort, json_option, option, overwrite_option, port_option, progress, show, warn
from greywhale.cli.record import tell_recording
from greywhale.files.leader import load_leader
from greywhale.files.names import suggesting
from greywhale.files.outputs import require_new
from greywhale.files.trajectory import Trajectory
from greywhale.loop import multi_steps, steps
from greywhale.protocol.firmware import FASTEST_LED_RAD_S
from greywhale.protocol.ports import choose_port

# The paper's motions by name, and the share of the fastest that a board can be led at which their edges use.
MOTIONS: dict[str, Callable[..., Trajectory]] = {"steps": steps, "multi-steps": multi_steps}
FASTEST_LED_SHARE = 0.9


class ReplayAnswer(OnPort, LedRecordingFacts):
    motion: str  # the file that was led
    warnings: list[str]  # of a log as the motion: that it is not as it was recorded, or has gaps


@click.command("replay")
@click.argument("motion", metavar="FILE", type=FILE)
@option("--out", "-o", type=FILE, default="log.csv", help="The log.")
@option("--every", type=int, default=1, help="One sample every so many ticks of 1 ms.")
@overwrite_option
@yes_option
@port_option
@json_option(ReplayAnswer)
def command(motion: Path, out: Path, every: int, overwrite: bool, yes: bool, port: str | None, as_json: bool) -> None:
    """Turn the motors on, lead the arm along the motion in FILE and record that.

    FILE has the columns time_s, leader_0 .. leader_3 (s, rad), or is a log. It may also be steps or multi-steps: the
    paper's motions, with edges as steep as a board can be led. The arm first goes slowly from where it is to the first
    pose, and at the end its motors go off. The board keeps the joints' limits; a motion faster than 7.7 rad/s is
    refused. A countdown on the terminal comes first, but not on the simulated bench.
    Ctrl-C stops the motors and keeps what was recorded, marked as interrupted.
    """
    check_every_led(every)
    refuse_inputs(out, motion)
    require_new(overwrite, out)
    made = MOTIONS.get(str(motion))
    with suggesting(motion, MOTIONS):
        trajectory = load_leader(motion) if made is None else made(fastest_rad_s=FASTEST_LED_SHARE * FASTEST_LED_RAD_S)
    warn(trajectory.remarks)  # while Ctrl-C still leaves the motors off
    chosen = choose_port(port)
    count_down = prepare_motion(chosen, yes)
    with Device(chosen) as device:
        count_down()
        with progress() as report:
            recording = record_led(device, out, trajectory, every, report)
    answer: ReplayAnswer = {
        "port": device.port,
        "motion": str(motion),
        "warnings": list(trajectory.remarks),
        **recording.as_dict(),
    }
    show(as_json, answer, tell_recording(chosen, recording))
