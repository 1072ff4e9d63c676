"""`greywhale demo`: bench, flash, record, identify, tune, upload and record again in one go."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from greywhale.base import system
from greywhale.base.errors import MOST_SEED
from greywhale.cli import completion
from greywhale.cli.output import FILE, json_option, option, progress, show, warn
from greywhale.files import controller as controller_file
from greywhale.files.arm import load_arm
from greywhale.files.leader import load_leader
from greywhale.files.outputs import require_folder


@click.command("demo")
@option("--out", "-o", type=FILE, default="demo", help="Folder for logs and pictures.")
@option("--leader", type=FILE, help="CSV with the leader's motion; without it, a generated one.")
@option("--board", type=click.Choice(["mega", "nano"]), default="mega", help="The simulated board.")
@option("--arm", type=FILE, help="TOML with the arm; without it, the built-in one.")
@option(
    "--speed",
    type=click.Choice(["1", "max"]),
    default="max" if system.HAS_BENCH_PORTS else "1",
    help="Real time or faster.",
)
@option("--duration", "duration_s", type=float, default=20.0, help="Seconds of generated motion.")
@option("--seed", type=click.IntRange(0, MOST_SEED), default=1, help="Seed of the generated motion.")
@option(
    "--controller",
    type=FILE,
    shell_complete=completion.controllers,
    help="Show this controller.toml instead of identifying and tuning.",
)
@option("--practice", "practice_s", type=float, default=20.0, help="Seconds of motion to identify the arm from.")
@option(
    "--budget",
    type=click.IntRange(1, 1_000_000),
    help="Controllers tried for each joint; without it, as many as `tune` tries.",
)
@option("--prove", is_flag=True, help="Also prove the tuned controllers on the arm, as `commission` does.")
@json_option("greywhale.cli.story.result:DemoAnswer")
def command(
    out: Path, leader: Path | None, arm: Path | None, controller: Path | None, as_json: bool, **options: Any
) -> None:
    """The whole story on the simulated bench in one go, pictures at the end.

    Flashes the real firmware onto a simulated Arduino and lets the arm follow a leader with untuned controllers. Then
    it records practice motions, identifies the arm from them, tunes on the identified model, uploads the result, and
    lets the arm follow the same leader again. Neither identification nor tuning sees that motion or the arm's data.
    """
    require_folder(out, "logs and pictures")
    _check_inputs(leader, arm, controller)
    from greywhale.cli import story

    demo = story.DemoOptions(out=out, leader=leader, arm=arm, controller=controller, **options)
    with progress() as report:
        result = story.run(demo, report)
    show(as_json, result.as_dict(), result.text())


def _check_inputs(leader: Path | None, arm: Path | None, controller: Path | None) -> None:
    """Refuse wrong files before all that a demo needs is imported, which takes seconds."""
    if leader is not None:
        warn(load_leader(leader).remarks)
    if arm is not None:
        load_arm(arm)
    if controller is not None:
        controller_file.load(controller)
