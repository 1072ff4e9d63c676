"""Reads a TOML file into a pydantic model; whatever is wrong becomes one sentence that names file, key, value and
range.

Unknown keys and non-finite numbers are refused for every model, whatever its own configuration says.
"""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from greywhale.errors import UserError, because

Model = TypeVar("Model", bound=BaseModel)


class Table(BaseModel):
    """Base for a table of a TOML file: no unknown key, no silent conversion (text to number), no inf or nan,
    immutable.
    """

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)


def load(path: str | Path, model: type[Model]) -> Model:
    """Read `path` and check it against `model`."""
    return check(read(path), model, str(path))


def loads(text: str, model: type[Model], name: str) -> Model:
    """Check TOML text against `model`; `name` stands for the file in error sentences."""
    return check(_parse(text, name), model, name)


def read(path: str | Path) -> dict[str, Any]:
    """The parsed but unchecked content of a TOML file."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise UserError(f"{path}: cannot be read: {because(error)}.") from None
    except UnicodeDecodeError as error:
        raise UserError(f"{path}: byte {error.start} is not UTF-8; TOML files must be UTF-8 text.") from None
    return _parse(text, str(path))


def check(data: dict[str, Any], model: type[Model], name: str) -> Model:
    """Check parsed TOML against `model`."""
    for location, value in _numbers(data, ()):
        if not math.isfinite(value):
            raise UserError(f"{name}: {key_path(location)} is {value}; it must be a finite number.")
    try:
        # Through JSON, so that in strict mode arrays may still become tuples and words may become enumerations.
        return model.model_validate_json(json.dumps(data, default=str), extra="forbid")
    except ValidationError as error:
        raise UserError(_sentence(name, error)) from None


def key_path(location: Sequence[str | int]) -> str:
    """A key as people write it: joint[2].sets.Ne_c."""
    path = ""
    for part in location:
        path += f"[{part}]" if isinstance(part, int) else f".{part}" if path else part
    return path or "the file"


def _parse(text: str, name: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise UserError(f"{name}: not valid TOML: {_lower_first(str(error))}.") from None


def _numbers(value: object, location: tuple[str | int, ...]) -> Iterator[tuple[tuple[str | int, ...], float]]:
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _numbers(item, (*location, key))
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from _numbers(item, (*location, index))
    elif isinstance(value, float):
        yield location, value


def _sentence(name: str, error: ValidationError) -> str:
    problems = error.errors(include_url=False)
    text = f"{name}: {_problem(problems[0])}"
    if len(problems) > 1:
        text += f" (and {len(problems) - 1} more in this file)"
    return text + "."


def _problem(problem: Any) -> str:
    key = key_path(problem["loc"])
    kind = problem["type"]
    if kind == "extra_forbidden":
        return f"unknown key {key}; remove it or check its spelling"
    if kind == "missing":
        return f"{key} is missing"
    message = problem["msg"].removeprefix("Value error, ").removeprefix("Assertion failed, ").rstrip(".")
    message = message.replace("Input should", "it should").replace("List should", "it should")
    value = problem["input"]
    if isinstance(value, dict | list):
        # A rule over a whole table words its own sentence; the table itself would be noise.
        return f"{key}: {_lower_first(message)}" if problem["loc"] else _lower_first(message)
    return f"{key} is {json.dumps(value)}, but {_lower_first(message)}"


def _lower_first(text: str) -> str:
    return text[:1].lower() + text[1:]
