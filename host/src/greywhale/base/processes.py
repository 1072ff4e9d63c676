"""Starts other programs, which shall import nothing from the current folder: a `numpy.py` that lies there would run.

`python -m` and `python -c` look there first. PYTHONSAFEPATH forbids it to them, and to those that they start in turn.
PYTHONPATH stays what the user chose.
"""

from __future__ import annotations

import contextlib
import os
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

_SAFE_PATH = "PYTHONSAFEPATH"


def start(
    command: Sequence[str], environment: Mapping[str, str] | None = None, **options: Any
) -> subprocess.Popen[bytes]:
    """`subprocess.Popen` with this environment, without one with that of this process."""
    given = os.environ if environment is None else environment
    return subprocess.Popen(command, env={**given, _SAFE_PATH: "1"}, **options)


@contextlib.contextmanager
def safe_path() -> Iterator[None]:
    """Keep what others start in this context (multiprocessing) from importing modules of the current folder."""
    before = os.environ.get(_SAFE_PATH)
    os.environ[_SAFE_PATH] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ[_SAFE_PATH]
        else:
            os.environ[_SAFE_PATH] = before
