"""Keeps generated files current, or names those that are stale."""

from __future__ import annotations

import sys
from collections.abc import Mapping

from tools import ROOT


def keep_current(texts: Mapping[str, str], check: bool) -> int:
    """Write the text of each path below the root where it differs; with `check` name the path instead, and return 1."""
    stale = [path for path, text in texts.items() if not _holds(path, text)]
    for path in stale:
        if check:
            print(f"{path} is stale; run `python -m tools.generate`.", file=sys.stderr)
        else:
            (ROOT / path).write_text(texts[path], encoding="utf-8")
            print(f"wrote {path}")
    return 1 if check and stale else 0


def _holds(path: str, text: str) -> bool:
    return (ROOT / path).is_file() and (ROOT / path).read_text(encoding="utf-8") == text
