"""Suggests the closest known name for a misspelt one."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator
from difflib import get_close_matches
from pathlib import Path

from greywhale.base.errors import UserError

_MOST_SUGGESTED = 3
_LONGEST_NAME = 60  # letters: nobody's slip is longer, and the search takes a time that grows with it


def did_you_mean(name: str, names: Iterable[str]) -> str:
    """A question to end a sentence with, " Did you mean joint0.kp?"; "" where no name is like it."""
    close = get_close_matches(name, list(names), _MOST_SUGGESTED) if len(name) <= _LONGEST_NAME else []
    return f" Did you mean {' or '.join(close)}?" if close else ""


@contextlib.contextmanager
def suggesting(source: str | Path, names: Iterable[str]) -> Iterator[None]:
    """Around the reading of `source`, a file or one of `names`: where there is no such file, ask for a name like it."""
    try:
        yield
    except UserError as error:
        if Path(source).exists():
            raise
        raise UserError(error.message + did_you_mean(str(source), names), error.exit_code) from None
