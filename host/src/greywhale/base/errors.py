"""The one exception that carries a sentence for the person at the keyboard.

Library code raises it, and only the command line prints it: what went wrong, where, which value, and what to do.
"""

from __future__ import annotations

import os

FAILED = 1
BAD_USAGE = 2
INTERRUPTED = 130  # after Ctrl-C, as shells have it: 128 + SIGINT


# A sentence is no longer than this: what a file holds may be as long as it likes.
LONGEST_SENTENCE = 1000  # letters


# No seed is larger: what it is multiplied with and added to must fit into the native code's 64 bits.
MOST_SEED = (1 << 31) - 1
# So many processes or threads no machine of today keeps busy; more would only take its memory.
MOST_WORKERS = 1024


class UserError(Exception):
    """A failure the user can act on; `message` is one whole sentence, `exit_code` is 1 (failed) or 2 (bad usage).

    Nothing that a file or a board says reaches a terminal as a control character, or without end.
    """

    def __init__(self, message: str, exit_code: int = FAILED) -> None:
        self.message = cut(printable(message), LONGEST_SENTENCE)
        super().__init__(self.message)
        self.exit_code = exit_code


class BadUsage(UserError):
    """The request was wrong, and nothing was done."""

    def __init__(self, message: str) -> None:
        super().__init__(message, BAD_USAGE)


def require_within(what: str, value: int, least: int, most: int) -> None:
    """Refuse a whole number that is out of its range, as bad usage."""
    if value < least:
        raise BadUsage(f"{what} is {value}, but it must be at least {least}.")
    if value > most:
        raise BadUsage(f"{what} is {value}, but it must be at most {most}.")


def require_between(what: str, value: float, unit: str, ends: tuple[float, float]) -> None:
    """Refuse a number that is out of its range, or none, as bad usage."""
    if not ends[0] <= value <= ends[1]:
        of_unit = f" {unit}" if unit else ""
        raise BadUsage(f"{what} is {value:g}{of_unit}; it must be {ends[0]:g} to {ends[1]:g}{of_unit}.")


def counted(number: int, thing: str) -> str:
    """A number of things: 1 sample, 2 samples."""
    return f"{number} {thing}{'' if number == 1 else 's'}"


def printable(text: str) -> str:
    """Text without control characters, which a terminal would obey; lines stay lines."""
    if text.isprintable():
        return text
    return "".join(one if one.isprintable() or one == "\n" else one.encode("unicode_escape").decode() for one in text)


def cut(text: str, most: int = 60) -> str:
    """Text of at most so many characters; what is too much is left out before its last third."""
    if len(text) <= most:
        return text
    end = most // 3
    return f"{text[: most - end - 3]}...{text[-end:]}"


def os_reason(error: OSError) -> str:
    """The operating system's own reason, in lower case, ready to stand inside a sentence."""
    reason = error.strerror or str(error) or type(error).__name__
    if error.errno and "[errno " in reason:  # pyarrow puts words of its own around it
        reason = os.strerror(error.errno)
    return reason[:1].lower() + reason[1:]
