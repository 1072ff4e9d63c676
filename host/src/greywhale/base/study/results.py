"""The results file of a study: a checked line for every task that is done."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from greywhale.base.closing import Closing
from greywhale.base.formats.checked_lines import CheckedLines, Kind
from greywhale.base.study.plain import decode, encode
from greywhale.base.study.same import versions
from greywhale.base.study.task import Task


class Results(Closing):
    """Results by the tasks' keys. Without a path they are kept in memory alone. Use as a context."""

    def __init__(self, path: Path | None, tasks: Sequence[Task], about: Mapping[str, Any]) -> None:
        self.path = path
        self._found: dict[str, Any] = {}
        kind = replace(KIND, choices=(*about, "versions", "number of tasks"))
        self._lines = None if path is None else CheckedLines(path, kind, _identity(tasks, about), keep=True)
        for line in () if self._lines is None else self._lines.found:
            self._found[line["task"]] = decode(line["result"])

    def __contains__(self, key: str) -> bool:
        return key in self._found

    def __len__(self) -> int:
        return len(self._found)

    def tell(self, key: str, result: str) -> None:
        """Keep a result, given as JSON; when this returns it is on its way to the disk."""
        value = json.loads(result)
        if self._lines is not None:
            self._lines.append({"task": key, "result": value})
        self._found[key] = decode(value)

    def of(self, tasks: Sequence[Task]) -> dict[str, Any]:
        """The results known so far, in the tasks' order."""
        return {task.key: self._found[task.key] for task in tasks if task.key in self._found}

    def close(self) -> None:
        if self._lines is not None:
            self._lines.close()


def _identity(tasks: Sequence[Task], about: Mapping[str, Any]) -> dict[str, Any]:
    """The identity of a study: its user's words, the versions, and every task with its seed and arguments."""
    identities = json.dumps([task.identity for task in tasks], separators=(",", ":"), allow_nan=False)
    digest = hashlib.sha256(identities.encode()).hexdigest()[:16]
    own = {"versions": versions(), "number of tasks": len(tasks), "list of tasks": digest}
    return {**encode(about), **own}


KIND = Kind(
    mark="greywhale_study",
    version=1,
    noun="results file",
    subject="study",
    anew="name another file",
    again="with the same file",
    is_line=lambda value: isinstance(value.get("task"), str) and "result" in value,
)
