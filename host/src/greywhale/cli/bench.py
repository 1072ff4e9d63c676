"""The options of verbs that start a bench."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypedDict

import click

from greywhale.cli.output import FILE, Command, option, show

_MISTAKE = "Wire it wrongly, NAME or NAME:PLACE; `--mistake list` names all."
_OPTIONS = {
    "board": option("--board", type=click.Choice(["mega", "nano"]), default="mega", help="The board."),
    "driver": option("--driver", default="drv8838", help="The motor drivers' chip; a wrong name lists all."),
    "eeprom": option("--eeprom", type=FILE, help="File that keeps the EEPROM between starts."),
    "firmware": option("--firmware", type=FILE, help="HEX file to start with, as if flashed."),
    "blank": option("--blank", is_flag=True, help="Start with nothing but the bootloader."),
    "faults": option("--mistake", "faults", multiple=True, metavar="NAME", help=_MISTAKE),
}


class Mistakes(TypedDict):
    mistakes: dict[str, str]  # with --mistake list: name to what is wrong then


def bench_options(command: Command) -> Command:
    """The options that say which board stands on the bench, in which state, and what is wired wrongly."""
    for add in reversed(_OPTIONS.values()):
        command = add(command)
    return command


def words_of(options: Mapping[str, Any]) -> dict[str, list[str]]:
    """Those of `bench_options` that are set, by parameter, as words for a bench in a process of its own."""
    words: dict[str, list[str]] = {}
    for name in _OPTIONS:
        flag = "--mistake" if name == "faults" else f"--{name}"
        values = options[name] if isinstance(options[name], tuple) else (options[name],)
        words[name] = []
        for value in values:
            words[name] += [] if value in (None, False) else [flag] if value is True else [flag, str(value)]
    return {name: one for name, one in words.items() if one}


def show_mistakes(as_json: bool) -> None:
    """All mistakes that `--mistake` knows."""
    from greywhale_sim.faults import FAULTS, listed

    answer: Mistakes = {"mistakes": {one.name: one.says for one in FAULTS}}
    show(as_json, answer, listed())
