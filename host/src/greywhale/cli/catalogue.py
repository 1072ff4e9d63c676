"""`python -m greywhale.cli.catalogue`: the verbs that a page may start, with their arguments, as JSON.

It is a process of its own because the modules of all verbs take seconds to import, in which a server must not stand
still.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

from greywhale.cli.form_words import GROUPS, FormWords, words_of
from greywhale.cli.group import command_of
from greywhale.cli.verbs import greywhale
from greywhale.dashboard.verbs import ArgumentFacts, BoardUse, VerbFacts

TAKES_PORT = {"flash"}
# Of all verbs: what the server adds by itself. Of some: what needs the port itself or a terminal, or would leave out
# the countdown on the page.
_SERVERS = {"as_json", "port"}
_NOT_HERE = {
    "doctor": {"image", "hex_file"},
    "record": {"reconnect", "yes", "episodes", "task"},
    "replay": {"yes"},
    "commission": {"yes"},
    "info": {"watch", "seconds", "model"},
}


def catalogue() -> list[VerbFacts]:
    """The verbs from which a page makes its forms, in groups and in the order of use."""
    return [_facts(group, verb, words) for group, verbs in GROUPS.items() for verb, words in verbs.items()]


def _facts(group: str, verb: str, words: FormWords) -> VerbFacts:
    command = command_of(greywhale, verb)
    hidden = _SERVERS | _NOT_HERE.get(verb, set())
    shown = [one for one in command.params if one.name not in hidden]
    places = {name: place for place, name in enumerate(words.first)}
    shown.sort(key=lambda one: places.get(one.name or "", len(places)))
    labels = {_option(one): words_of(verb, one.name or "").label for one in shown if _option(one)}
    return {
        "verb": verb,
        "title": words.title,
        "group": group,
        "help": command.get_short_help_str(200),
        "board": _board_use(verb, command),
        "arguments": [_argument(verb, one, labels, one.name in places) for one in shown],
    }


def _board_use(verb: str, command: click.Command) -> BoardUse:
    if verb in TAKES_PORT:
        return "taken"
    return "lent" if any(one.name == "port" for one in command.params) else "none"


def _argument(verb: str, parameter: click.Parameter, labels: Mapping[str, str], first: bool) -> ArgumentFacts:
    words, kind = words_of(verb, parameter.name or ""), _kind(verb, parameter)
    choices = list(map(str, parameter.type.choices)) if isinstance(parameter.type, click.Choice) else []
    span = parameter.type if isinstance(parameter.type, click.IntRange | click.FloatRange) else None
    said = (parameter.help or "") if isinstance(parameter, click.Option) else ""
    return {
        "name": parameter.name or "",
        "option": _option(parameter),
        "label": words.label,
        "unit": words.unit,
        "first": first or parameter.required,
        "kind": kind,  # type: ignore[typeddict-item] # one of them
        "shape": (parameter.metavar or "") if kind == "text" else "",
        "files": list(words.kinds),
        "choices": choices,
        "least": None if span is None else span.min,
        "most": None if span is None else span.max,
        "default": _plain(parameter.default),
        "required": parameter.required,
        "many": bool(parameter.multiple or parameter.nargs == -1),
        "help": _OPTION.sub(lambda found: labelled(found[0], labels), said),
    }


_OPTION = re.compile(r"--[a-z][a-z-]*")


def labelled(option: str, labels: Mapping[str, str]) -> str:
    """The label in the place of an option, as a form shows it."""
    return f'"{labels[option]}"' if option in labels else option


def _option(parameter: click.Parameter) -> str:
    """The longest word of an option on the command line; of an argument none."""
    return max(parameter.opts, key=len) if isinstance(parameter, click.Option) else ""


def _kind(verb: str, parameter: click.Parameter) -> str:
    if (verb, parameter.name) == ("arm new", "answers"):
        return "answers"
    if isinstance(parameter, click.Option) and parameter.is_flag:
        return "flag"
    if isinstance(parameter.type, click.Choice):
        return "choice"
    if isinstance(parameter.type, click.types.IntParamType | click.types.FloatParamType):
        return "number"
    is_file = isinstance(parameter.type, click.Path) or words_of(verb, parameter.name or "").kinds
    return "file" if is_file else "text"


def _plain(default: object) -> Any:
    if isinstance(default, Path):
        return str(default)
    return default if isinstance(default, str | int | float | bool) else None


if __name__ == "__main__":
    click.echo(json.dumps(catalogue()))
