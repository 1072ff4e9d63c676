"""The verbs that a page may start, their arguments, and the words of the command line that these make."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal, TypedDict

from greywhale.base.errors import BadUsage, cut
from greywhale.dashboard.folder import Folder
from greywhale.dashboard.limits import REQUESTS

# How a verb uses a board. Taken: it has the port itself, and the page sees nothing meanwhile.
BoardUse = Literal["none", "lent", "taken"]


class ArgumentFacts(TypedDict):
    """One argument; `option` is its word on the command line, "" where its place alone tells."""

    name: str
    option: str
    label: str  # in words, for a person
    unit: str  # of a number, "" without one
    first: bool  # it matters first; the others stand under "More"
    # Answers: those to the questions of `arm new`.
    kind: Literal["flag", "number", "choice", "file", "text", "answers"]
    shape: str  # of a text: J:MIN:MAX; "" for any
    files: list[str]  # kinds of the folder's files that it takes, none where it names a new one
    choices: list[str]
    least: float | None  # of a number
    most: float | None
    default: Any  # null: none
    required: bool
    many: bool  # it takes a list of values
    help: str


class VerbFacts(TypedDict):
    verb: str  # such as "params backup"
    title: str  # as a person would ask for it
    group: str
    help: str  # one sentence
    board: BoardUse
    arguments: list[ArgumentFacts]


def command_line(verb: VerbFacts, given: Mapping[str, Any], folder: Folder) -> list[str]:
    """The verb and its words; what is unknown, or leads out of the folder, is a UserError."""
    known = {one["name"] for one in verb["arguments"]}
    for name in given:
        if name not in known:
            raise BadUsage(f"{verb['verb']} has no argument {cut(repr(name))}.")
    options: list[str] = []
    places: list[str] = []
    for argument in verb["arguments"]:
        value = given.get(argument["name"])
        if value is None:
            continue
        if argument["kind"] == "flag":
            options += [argument["option"]] if _flag(argument, value) else []
            continue
        for text in _texts(argument, value, folder):
            (options if argument["option"] else places).append(
                f"{argument['option']}={text}" if argument["option"] else text
            )
    return [*verb["verb"].split(), *options, "--", *places]


def _flag(argument: ArgumentFacts, value: object) -> bool:
    if not isinstance(value, bool):
        raise BadUsage(f"{argument['label']} is {cut(repr(value))}, but it must be true or false.")
    return value


def _texts(argument: ArgumentFacts, value: object, folder: Folder) -> Iterator[str]:
    """The values of an argument. A name is looked at whatever it is called: any text may be a file's."""
    values: Sequence[object] = value if isinstance(value, list) and argument["many"] else [value]
    if len(values) > REQUESTS.most_values:
        raise BadUsage(
            f"{argument['label']} has {len(values)} values, but at most {REQUESTS.most_values} may be given."
        )
    for one in values:
        text = str(one)
        fits = isinstance(one, str | int | float) and not isinstance(one, bool)
        if not fits or not text or not text.isprintable() or len(text) > REQUESTS.longest_value_letters:
            raise BadUsage(f"{argument['label']} is {cut(repr(one))}, but it must be text or a number.")
        if isinstance(one, str):
            folder.argument(text)
        yield text
