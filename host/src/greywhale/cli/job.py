"""`python -m greywhale.cli.job PROGRESS LINE PORT VERB ...`: a verb as the terminal runs it, for the page's server.

PROGRESS and LINE are numbers of open files. The first gets what a terminal would show, as JSON: an object a line, whose
keys are those of `dashboard.job.Facts`. The second is
a socket that stands for PORT, which the server holds and lends; where the verb needs no board, LINE is -.
"""

from __future__ import annotations

import contextlib
import json
import os
import socket
import sys

from greywhale.base.telling import Telling
from greywhale.cli import entry, output
from greywhale.protocol.lent_line import lend


class Reporter:
    """A `Watcher` that writes what a verb reports, but not each of thousands of samples."""

    def __init__(self, descriptor: int) -> None:
        self._file = os.fdopen(descriptor, "w", encoding="utf-8", buffering=1)
        self._last_report: tuple[str, float, str] = ("", -1.0, "")

    def __call__(self, what: str, fraction: float, note: str = "") -> None:
        before = self._last_report
        if (what, note) == (before[0], before[2]) and abs(fraction - before[1]) < 0.002:  # 500 reports at most
            return
        self._last_report = (what, fraction, note)
        self._tell(progress={"text": what, "done": fraction, "total": 1.0, "note": note})

    def counts(self, left: int) -> None:
        self._tell(countdown=left)

    def tells(self, telling: Telling) -> None:
        self._tell(telling=telling.as_dict())

    def _tell(self, **facts: object) -> None:
        with contextlib.suppress(OSError):  # whoever watched has gone; the work goes on
            print(json.dumps(facts), file=self._file)


def main() -> None:
    progress, line, port, *arguments = sys.argv[1:]
    output.watcher = Reporter(int(progress))
    if line != "-":
        lend(port, socket.socket(fileno=int(line)))
    sys.argv[1:] = arguments
    entry.main()


if __name__ == "__main__":
    main()
