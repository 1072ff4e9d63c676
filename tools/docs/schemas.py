"""The JSON schemas of the documentation: where they are, and whether an answer of a verb is what its schema says."""

from __future__ import annotations

import json
from typing import Any

from jsonschema import Draft202012Validator

from tools import ROOT

SCHEMAS = ROOT / "docs" / "schemas"


def schema_name(verb: str) -> str:
    """The file of a verb's schema: params-get.json of `params get`."""
    return f"{verb.replace(' ', '-')}.json"


def read_answer(text: str) -> Any:
    """What a verb printed with --json: one line that holds one object, without the NaN that Python would let pass."""
    if text.count("\n") != 1:
        raise ValueError(f"{text.count(chr(10))} lines, where there must be one")
    return json.loads(text, parse_constant=_refuse)


def validate(verb: str, answer: Any) -> None:
    """Raise jsonschema.ValidationError where an answer is not what the verb's schema says."""
    schema = json.loads((SCHEMAS / schema_name(verb)).read_text(encoding="utf-8"))
    Draft202012Validator(schema).validate(answer)


def _refuse(name: str) -> Any:
    raise ValueError(f"{name} is no JSON")
