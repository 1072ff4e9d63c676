"""Episodes: logs of one task after the other, numbered in a folder. The header has the task in a person's words.

The words stand there as a JSON string in ASCII, so that quotes, commas, lines and every alphabet come back. The check
does not cover them: a person may correct them, or add them to a log.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path

KEY = "task"
# A spreadsheet takes a quote behind one of its separators for the beginning of a cell, which would have no end.
_BEFORE_QUOTE = re.compile(r'[,;|](?="$)')
# A name is such as episode_007.csv.
PREFIX, DIGITS, SUFFIX = "episode_", 3, ".csv"
NAME = re.compile(rf"{PREFIX}([0-9]{{{DIGITS},9}})\b.*{re.escape(SUFFIX)}")


def task_line(task: str) -> str:
    """The task as a line of a header, without its `#`."""
    words = _BEFORE_QUOTE.sub(lambda found: f"\\u{ord(found[0]):04x}", json.dumps(task))
    return f"{KEY}: {words}"


def task_in(facts: Mapping[str, str]) -> str | None:
    """The task in the facts of a header, also where a person wrote it without quotes; None where it states none."""
    text = facts.get(KEY, "")
    try:
        task = json.loads(text)
    except ValueError:
        task = None
    return task if isinstance(task, str) else text or None


def next_episode(folder: Path) -> Path:
    """The log of the episode after those in a folder, finished or not."""
    found = (NAME.match(path.name) for path in folder.glob(f"{PREFIX}*"))
    numbers = [int(one[1]) for one in found if one]
    return folder / f"{PREFIX}{max(numbers, default=-1) + 1:0{DIGITS}d}{SUFFIX}"
