"""The journal of a commissioning: what each step gave, so that an interrupted commissioning can go on.

It is a file of checked lines (base/formats/checked_lines.py), one for a step, in the folder that also keeps logs,
models and controllers. A step that is in it is not done again; what lies between follows from the steps alone.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from greywhale.base.closing import Closing
from greywhale.base.errors import BadUsage, UserError
from greywhale.base.formats.checked_lines import CheckedLines, Kind
from greywhale.base.formats.whole import make_folder

NAME = "commission.journal"


class AnewError(UserError):
    """An error that the same command would meet again: `--resume` does not help."""


class CommissioningJournal(Closing):
    """Facts of the steps that are done, by the step's name. `request` says what was asked for. Use as a context."""

    def __init__(self, folder: Path, request: dict[str, Any], resume: bool) -> None:
        self.folder = folder
        path = folder / NAME
        if resume and not path.exists():
            raise BadUsage(f"{folder}: no interrupted commissioning is there to go on with; leave --resume out.")
        if not resume and _has_steps(path):
            raise BadUsage(
                f"{folder}: a commissioning is in this folder already; go on with it (--resume), or give another --out."
            )
        make_folder(folder)
        self._lines = CheckedLines(path, KIND, request, keep=resume)
        self._steps: dict[str, dict[str, Any]] = {line["step"]: line["facts"] for line in self._lines.found}

    def get(self, step: str) -> dict[str, Any] | None:
        """The facts of a step, None where it was not done."""
        return self._steps.get(step)

    def note(self, step: str, facts: dict[str, Any]) -> None:
        """A step is done; when this returns its line is on its way to the disk."""
        self._lines.append({"step": step, "facts": facts})
        self._steps[step] = facts

    def path(self, name: str) -> Path:
        """A file of this commissioning."""
        return self.folder / name

    def close(self) -> None:
        self._lines.close()

    def __getstate__(self) -> dict[str, Any]:
        """A copy in another process reads what was noted until then; it notes nothing."""
        return {"folder": self.folder, "_steps": self._steps}


def _has_steps(path: Path) -> bool:
    try:
        return path.read_bytes().count(b"\n") > 1
    except OSError:
        return False


def _is_step(value: dict[str, Any]) -> bool:
    return isinstance(value.get("step"), str) and isinstance(value.get("facts"), dict)


KIND = Kind(
    mark="greywhale_commission",
    version=5,
    noun="journal",
    subject="commissioning",
    anew="begin anew in another folder",
    again="with --resume",
    is_line=_is_step,
)
