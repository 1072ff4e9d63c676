"""The command line: `greywhale VERB`. One module a verb; `main` turns every failure into a sentence and an exit
code.
"""

from __future__ import annotations

import signal
from typing import NoReturn


def main() -> NoReturn:
    """Run the command line and exit."""
    # Until the verbs are there, Ctrl-C ends this process without a traceback of what was being imported.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from greywhale.cli import entry

    entry.main()
