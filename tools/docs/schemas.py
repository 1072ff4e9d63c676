"""The JSON schemas of what verbs print with --json, made from the types of their answers."""

from __future__ import annotations

import inspect
import json
import pkgutil
import re
import sys
import types
import typing
from collections.abc import Iterator
from dataclasses import is_dataclass
from enum import Enum
from pathlib import Path
from typing import Annotated, Any, Literal, NotRequired, Union

import click

from greywhale.cli.entry import Failure
from greywhale.cli.output import ANSWER
from greywhale.cli.verbs import greywhale

PLAIN = {str: "string", bool: "boolean", int: "integer", float: "number", types.NoneType: "null"}
CLASS = re.compile(r"^class \w+\((.*)\):$", re.MULTILINE)
KEY = re.compile(r"^    (\w+): .*?  # (.+)$", re.MULTILINE)


def answers() -> dict[str, Any]:
    """The type that each verb answers with, by its words, and that of a failure under "error"."""
    found = {"error": Failure}
    for verb, command in commands(greywhale):
        answer = getattr(command.callback, ANSWER)
        found[verb] = pkgutil.resolve_name(answer) if isinstance(answer, str) else answer
    return found


def schemas() -> dict[str, dict[str, Any]]:
    """The schemas of all answers."""
    return {
        verb: {
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            "title": f"JSON of greywhale: {verb}",
            **schema_of(answer),
        }
        for verb, answer in answers().items()
    }


def write_schemas(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for verb, schema in schemas().items():
        (folder / schema_name(verb)).write_text(json.dumps(schema, indent=1, ensure_ascii=False) + "\n", "utf-8")


def schema_name(verb: str) -> str:
    """The file of a verb's schema: params-get.json of `params get`."""
    return f"{verb.replace(' ', '-')}.json"


def schema_of(kind: Any) -> dict[str, Any]:
    """The schema of a type; TypeError where JSON has none."""
    origin, inner = typing.get_origin(kind), typing.get_args(kind)
    if isinstance(kind, type) and kind in PLAIN:
        return {"type": PLAIN[kind]}
    if origin is Annotated:
        return schema_of(inner[0]) | dict(inner[1:])
    if origin is Literal:
        return {"enum": list(inner)}
    if origin in (Union, types.UnionType):
        return {"anyOf": [schema_of(one) for one in inner]}
    if origin is NotRequired:
        return schema_of(inner[0])
    if origin is dict:
        return {"type": "object", "additionalProperties": schema_of(inner[1])}
    if origin is list or (origin is tuple and inner[1:] == (...,)):
        return {"type": "array", "items": schema_of(inner[0])}
    if isinstance(kind, type) and issubclass(kind, Enum):
        return {"enum": [one.value for one in kind]}
    if typing.is_typeddict(kind) or is_dataclass(kind):
        return _object_of(kind)
    raise TypeError(f"{kind!r} is no type of an answer")


def _object_of(kind: Any) -> dict[str, Any]:
    keys, notes = typing.get_type_hints(kind, include_extras=True), notes_of(kind)
    return {
        "type": "object",
        "properties": {
            key: schema_of(value) | ({"description": notes[key]} if key in notes else {}) for key, value in keys.items()
        },
        "required": [key for key, value in keys.items() if typing.get_origin(value) is not NotRequired],
        "additionalProperties": False,
    }


def notes_of(kind: Any) -> dict[str, str]:
    """The comments behind the keys of a class, and of those that it extends."""
    source = inspect.getsource(kind)
    found: dict[str, str] = {}
    for bases in CLASS.findall(source):
        for base in bases.split(", "):
            if base != "TypedDict":
                found |= notes_of(getattr(sys.modules[kind.__module__], base))
    return found | dict(KEY.findall(source))


def commands(group: click.Group, above: str = "") -> Iterator[tuple[str, click.Command]]:
    """The commands that run something, by their words."""
    context = click.Context(group)
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        assert command is not None
        if isinstance(command, click.Group):
            yield from commands(command, f"{above}{name} ")
        else:
            yield f"{above}{name}", command
