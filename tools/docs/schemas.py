"""Where the JSON schemas of the documentation are, and what each of them is about."""

from __future__ import annotations

from pathlib import Path

SCHEMAS = Path(__file__).resolve().parents[2] / "docs" / "schemas"


def schema_name(verb: str) -> str:
    """The file of a verb's schema: params-get.json of `params get`."""
    return f"{verb.replace(' ', '-')}.json"
