"""The one exception that carries a sentence for the person at the keyboard.

Library code raises it, and only the command line prints it: what went wrong, where, which value, and what to do.
"""

from __future__ import annotations

FAILED = 1
BAD_USAGE = 2


class UserError(Exception):
    """A failure the user can act on; `message` is one whole sentence, `exit_code` is 1 (failed) or 2 (bad usage)."""

    def __init__(self, message: str, exit_code: int = FAILED) -> None:
        super().__init__(message)
        self.message = message
        self.exit_code = exit_code


def os_reason(error: OSError) -> str:
    """The operating system's own reason, in lower case, ready to stand inside a sentence."""
    reason = error.strerror or str(error) or type(error).__name__
    return reason[:1].lower() + reason[1:]
