"""`python -m greywhale.cli.catalogue`: the verbs that a page may start, with their arguments, as JSON.

It is a process of its own because the modules of all verbs take seconds to import, in which a server must not stand
still.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from greywhale.cli.verbs import greywhale
from greywhale.dashboard.verbs import ArgumentFacts, BoardUse, VerbFacts

VERBS = (
    *("record", "replay", "calibrate", "doctor", "info", "evaluate", "identify", "tune", "commission", "adapt"),
    *("upload", "params backup", "params restore", "params diff", "flash"),
)
TAKES_PORT = {"flash"}
# Of all verbs: what the server adds by itself. Of some: what needs the port itself or a terminal, or would leave out
# the countdown on the page.
_SERVERS = {"as_json", "port"}
_NOT_HERE = {
    "doctor": {"image", "hex_file"},
    "record": {"reconnect", "yes"},
    "replay": {"yes"},
    "commission": {"yes"},
    "info": {"watch", "seconds"},
}


def catalogue() -> list[VerbFacts]:
    """The verbs from which a page makes its forms."""
    return [_facts(verb) for verb in VERBS]


def _facts(verb: str) -> VerbFacts:
    command: click.Command = greywhale
    for word in verb.split():
        assert isinstance(command, click.Group)
        found = command.get_command(click.Context(command), word)
        assert found is not None
        command = found
    hidden = _SERVERS | _NOT_HERE.get(verb, set())
    return {
        "verb": verb,
        "help": command.get_short_help_str(200),
        "board": _board_use(verb, command),
        "arguments": [_argument(one) for one in command.params if one.name not in hidden],
    }


def _board_use(verb: str, command: click.Command) -> BoardUse:
    if verb in TAKES_PORT:
        return "taken"
    return "lent" if any(one.name == "port" for one in command.params) else "none"


def _argument(parameter: click.Parameter) -> ArgumentFacts:
    is_option = isinstance(parameter, click.Option)
    choices = list(map(str, parameter.type.choices)) if isinstance(parameter.type, click.Choice) else []
    return {
        "name": parameter.name or "",
        "option": max(parameter.opts, key=len) if is_option else "",
        "kind": _kind(parameter),  # type: ignore[typeddict-item] # one of them
        "choices": choices,
        "default": _plain(parameter.default),
        "required": parameter.required,
        "many": bool(parameter.multiple or parameter.nargs == -1),
        "help": (parameter.help or "") if isinstance(parameter, click.Option) else "",
    }


def _kind(parameter: click.Parameter) -> str:
    if isinstance(parameter, click.Option) and parameter.is_flag:
        return "flag"
    if isinstance(parameter.type, click.Choice):
        return "choice"
    if isinstance(parameter.type, click.types.IntParamType | click.types.FloatParamType):
        return "number"
    is_file = isinstance(parameter.type, click.Path) or (parameter.name or "").endswith("_file")
    return "file" if is_file else "text"


def _plain(default: object) -> Any:
    if isinstance(default, Path):
        return str(default)
    return default if isinstance(default, str | int | float | bool) else None


if __name__ == "__main__":
    click.echo(json.dumps(catalogue()))
