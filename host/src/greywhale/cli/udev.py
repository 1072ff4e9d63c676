"""`greywhale udev`: rules that let this machine's user open an Arduino's port."""

from __future__ import annotations

from typing import TypedDict

import click

from greywhale.board.doctor.port import RULES_FILE, udev_rules
from greywhale.cli.output import json_option, show


class UdevAnswer(TypedDict):
    file: str  # where the rules belong
    rules: str


@click.command("udev")
@json_option(UdevAnswer)
def command(as_json: bool) -> None:
    """Print udev rules for Linux: whoever sits at the machine may open an Arduino's port, no modem software does.

    Install them with: greywhale udev | sudo tee /etc/udev/rules.d/60-greywhale.rules
    """
    answer: UdevAnswer = {"file": RULES_FILE, "rules": udev_rules()}
    show(as_json, answer, answer["rules"])
