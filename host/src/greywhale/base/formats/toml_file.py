"""Reads a TOML file into a pydantic model; whatever is wrong becomes one sentence that names file, key, value and
range.

Unknown keys and non-finite numbers are refused for every model, whatever its own configuration says. So is what only a
broken or malicious file has: depth, length and integers that would keep the parser busy for ever or overflow numbers.
"""

from __future__ import annotations

import datetime
import json
import math
import re
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Any, ClassVar, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import ErrorDetails

from greywhale.base import sentences
from greywhale.base.errors import UserError, cut, os_reason
from greywhale.base.formats.kinds import Kind, refuse_other_kind
from greywhale.base.formats.whole import refuse_devices

Model = TypeVar("Model", bound=BaseModel)

# Limits of any file that greywhale writes; what is beyond would only keep the parser busy.
LONGEST_TEXT = 1 << 22  # letters
DEEPEST_LEVEL = 24  # of brackets, and parts of a key
LARGEST_INTEGER = 1 << 63  # as TOML has them
_BARE = re.compile(r"[A-Za-z0-9_-]+")
# How the first line of a log or a motion begins, and one of a TOML file: a key, or a table's name.
CSV_LINE = re.compile(r'"?time_s"?[,;\t]')
TOML_LINE = re.compile(r"""[ \t]*(("[^"]*"|'[^']*'|[A-Za-z0-9_-]+)[ \t]*[.=]|\[\[?[ \t]*["'A-Za-z0-9_-])""")
# Strings and comments as a whole, so that nothing in them counts, and all else one by one. Spaces may stand between the
# parts of a key.
_TOKEN = re.compile(
    r"""(?P<part>\"{3}(?:[^\\]|\\.)*?\"{3}|'{3}.*?'{3}|"(?:[^"\\\n]|\\.)*"|'[^'\n]*'|[^\W]+|-+|[^\S\n]+)"""
    r"""|\#[^\n]*|.""",
    re.DOTALL,
)


class Table(BaseModel):
    """Base for a table of a TOML file: no unknown key, no silent conversion (text to number), no inf or nan,
    immutable. `kinds` are the kinds of file that a whole file of this table may be.
    """

    kinds: ClassVar[tuple[Kind, ...]] = ()

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)


def load(path: str | Path, model: type[Model]) -> Model:
    return check(read(path), model, str(path))


def loads(text: str, model: type[Model], name: str) -> Model:
    """Check TOML text against `model`; `name` stands for the file in error sentences."""
    return check(parse(text, name), model, name)


def read(path: str | Path) -> dict[str, Any]:
    """The parsed but unchecked content of a TOML file."""
    try:
        refuse_devices(path)
        text = Path(path).read_bytes().decode("utf-8")  # ends of lines as they are: the parser knows which are none
    except OSError as error:
        raise UserError(f"{path}: cannot be read: {os_reason(error)}.") from None
    except UnicodeDecodeError as error:
        raise UserError(f"{path}: {sentences.NOT_UTF8.format(at=error.start)}") from None
    return parse(text, str(path))


def check(data: dict[str, Any], model: type[Model], name: str) -> Model:
    _refuse_odd_values(data, name)
    try:
        # Through JSON, so that in strict mode arrays may still become tuples, and words may become enumerations.
        return model.model_validate_json(json.dumps(data, default=str), extra="forbid")
    except ValidationError as error:
        if issubclass(model, Table) and model.kinds:
            refuse_other_kind(data, name, *model.kinds)
        sentence = _sentence(name, model, error)
    # Not within `except`: the collector cannot look into pydantic's error, and would keep all that the frames hold.
    raise UserError(sentence)


def advice(key: str, known: Iterable[str]) -> str:
    """Advice about an unknown key: the one that was probably meant, if there is one."""
    meant = get_close_matches(key, list(known), 1)
    return sentences.PERHAPS.format(key=meant[0]) if meant else sentences.CHECK_SPELLING


def key_path(location: Sequence[str | int]) -> str:
    """A key as people write it: joint[2].sets.Ne_c."""
    path = ""
    for part in location:
        word = part if isinstance(part, int) or _BARE.fullmatch(part) else json.dumps(part)
        path += f"[{word}]" if isinstance(word, int) else f".{cut(word)}" if path else cut(word)
    return cut(path, 120) or "the file"


def parse(text: str, name: str) -> dict[str, Any]:
    text = text.removeprefix("\ufeff")  # Windows Notepad puts it there
    _refuse_depth(text, name)
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        if _is_csv(text):
            raise UserError(f"{name}: {sentences.CSV_IN_ITS_PLACE}") from None
        sentence = sentences.NO_TOML.format(why=_lower_first(cut(str(error), 200)))
        if (line := _no_toml_line(text)) is not None:
            sentence = sentences.NO_TOML_LINE.format(line=line)
        raise UserError(f"{name}: {sentence}") from None
    except RecursionError:
        raise UserError(f"{name}: {sentences.NO_TOML.format(why='it is nested too deeply')}") from None
    except ValueError:  # Python reads no integer of thousands of digits
        raise UserError(f"{name}: {sentences.NO_TOML.format(why='a number in it has too many digits')}") from None
    if not data:
        raise UserError(f"{name}: {sentences.COMMENTS_ALONE if text.strip() else sentences.EMPTY}")
    _refuse_odd_values(data, name)
    return data


def _is_csv(text: str) -> bool:
    return CSV_LINE.match(_first_line(text)[1]) is not None


def _no_toml_line(text: str) -> int | None:
    """The number of the first line that says something, if no TOML file begins so; else None."""
    number, line = _first_line(text)
    return None if not line or TOML_LINE.match(line) else number


def _first_line(text: str) -> tuple[int, str]:
    """The first line that is neither empty nor a comment, and its number."""
    lines = enumerate(text.split("\n"), 1)
    return next(((number, line) for number, line in lines if line.strip() and not line.startswith("#")), (0, ""))


def _refuse_depth(text: str, name: str) -> None:
    """Refuse what would keep the parser busy: a file, a key or brackets beyond any that greywhale writes."""
    if len(text) > LONGEST_TEXT:
        raise UserError(f"{name}: {sentences.TOO_LONG.format(count=len(text), most=LONGEST_TEXT)}")
    depth = parts = 0
    for found in _TOKEN.finditer(text):
        token = found.group()
        if token in ("[", "{"):
            depth += 1
        elif token in ("]", "}"):
            depth -= 1
        elif token == ".":
            parts += 1
            continue
        if found.lastgroup != "part":
            parts = 0
        if depth > DEEPEST_LEVEL or parts > DEEPEST_LEVEL:
            line = text.count("\n", 0, found.start()) + 1
            raise UserError(f"{name}, line {line}: {sentences.TOO_DEEP.format(most=DEEPEST_LEVEL)}")


def _refuse_odd_values(data: dict[str, Any], name: str) -> None:
    """Refuse numbers beyond any range, and dates, of which each parser has another opinion."""
    for location, value in _odd_values(data, ()):
        if isinstance(value, datetime.date | datetime.time):
            raise UserError(f"{name}: {sentences.DATE.format(key=key_path(location))}")
        if isinstance(value, int) and abs(value) > LARGEST_INTEGER:
            # Python writes no integer of thousands of digits, but reads one from hexadecimal digits.
            shown = cut(str(value), 30) if value.bit_length() < 1000 else f"a number of {value.bit_length()} bits"
            raise UserError(f"{name}: {sentences.BEYOND_ANY_RANGE.format(key=key_path(location), value=shown)}")
        if not math.isfinite(value):
            raise UserError(f"{name}: {sentences.NOT_FINITE.format(key=key_path(location), value=value)}")


_Odd = int | float | datetime.date | datetime.time


def _odd_values(value: object, location: tuple[str | int, ...]) -> Iterator[tuple[tuple[str | int, ...], _Odd]]:
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _odd_values(item, (*location, key))
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from _odd_values(item, (*location, index))
    elif isinstance(value, _Odd):
        yield location, value


def _sentence(name: str, model: type[BaseModel], error: ValidationError) -> str:
    # A misspelt key is also a missing one, and says more.
    problems = sorted(error.errors(), key=lambda one: one["type"] != "extra_forbidden")
    # An array with a bad item is also reported as too short; that is no problem of its own.
    above = {other["loc"][:size] for other in problems for size in range(len(other["loc"]))}
    whole = [one for one in problems if one["type"] != "too_short" or one["loc"] not in above]
    text = f"{name}: {_problem(whole[0], model)}"
    if len(whole) > 1:
        text += sentences.MORE.format(count=len(whole) - 1)
    return text + "."


def _problem(problem: ErrorDetails, model: type[BaseModel]) -> str:
    location, kind, value = problem["loc"], problem["type"], problem["input"]
    key = key_path(location)
    if kind == "extra_forbidden":
        known = _at(model.model_json_schema(), location[:-1]).get("properties", ())
        return sentences.UNKNOWN_KEY.format(key=key, advice=advice(str(location[-1]), known))
    if kind == "missing":
        return sentences.MISSING_KEY.format(key=key)
    if kind in _BOUNDS:  # pydantic names only the end of the range that was missed
        here = _at(model.model_json_schema(), location)
        bounds = " and ".join(f"{words} {here[bound]:g}" for bound, words in BOUND_WORDS.items() if bound in here)
        rule = sentences.WITHIN.format(bounds=bounds)
        return sentences.WRONG_VALUE.format(key=key, value=cut(json.dumps(value)), rule=rule)
    if kind in ("too_short", "too_long") and isinstance(value, list):
        here = _at(model.model_json_schema(), location)
        count = here.get("minItems")
        if count is not None and count == here.get("maxItems"):
            of_tables = all(isinstance(one, dict) for one in value)
            words = sentences.COUNT_OF_TABLES if of_tables else sentences.COUNT_OF_VALUES
            return words.format(count=len(value), key=key, exactly=count)
    message = rule_of(problem["msg"])
    if isinstance(value, dict | list):
        # A rule over a whole table words its own sentence; printing the table itself would not help.
        return sentences.WRONG_TABLE.format(key=key, rule=message) if location else message
    return sentences.WRONG_VALUE.format(key=key, value=cut(json.dumps(value)), rule=message)


def rule_of(message: str) -> str:
    """The demand of a message of pydantic, ready to stand inside a sentence."""
    message = _lower_first(message.removeprefix("Value error, ").removeprefix("Assertion failed, "))
    return message.replace("input should", "it should").rstrip(".")


# Kinds of complaint about a number out of range; the words for each bound in a JSON schema.
_BOUNDS = ("greater_than", "greater_than_equal", "less_than", "less_than_equal")
BOUND_WORDS = {
    "minimum": "at least",
    "exclusiveMinimum": "greater than",
    "maximum": "at most",
    "exclusiveMaximum": "less than",
}


def _at(schema: dict[str, Any], location: Sequence[str | int]) -> dict[str, Any]:
    """The schema of the value at `location`."""
    here = schema
    for part in location:
        here = _resolve(schema, here)
        if isinstance(part, int):
            fixed = here.get("prefixItems", ())
            here = fixed[part] if part < len(fixed) else here.get("items", {})
        else:
            properties = here.get("properties", {})
            here = properties[part] if part in properties else here.get("additionalProperties", {})
    return _resolve(schema, here)


def _resolve(schema: dict[str, Any], here: dict[str, Any]) -> dict[str, Any]:
    """Follow a reference; of alternatives (a number or nothing) take the one with bounds."""
    for choice in here.get("anyOf", ()):
        found = _resolve(schema, choice)
        if found.get("type") != "null":
            return found
    if "$ref" not in here:
        return here
    found = schema
    for part in here["$ref"].removeprefix("#/").split("/"):
        found = found[part]
    return found


def _lower_first(text: str) -> str:
    return text[:1].lower() + text[1:]
