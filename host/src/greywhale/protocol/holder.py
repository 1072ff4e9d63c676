"""Who has a port open, as far as the system tells this user: for the person who wants it free."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from greywhale.base import system
from greywhale.base.errors import cut

PROCESSES = Path("/proc")  # not there on every system


def holder_of(port: str) -> str | None:
    """The process that has locked a port, else one that has it open, in words; None where the system does not tell."""
    pid = _locker(port) or next(_users(port), None)
    return None if pid is None else describe(pid)


def describe(pid: int) -> str:
    """A process by its number and its command, where that can be read."""
    if pid == os.getpid():
        return "this program itself"
    try:
        words = (PROCESSES / str(pid) / "cmdline").read_bytes().decode("utf-8", "replace").split("\0")
    except OSError:
        words = []
    command = " ".join([*map(os.path.basename, words[:2]), *words[2:]]).strip()  # python greywhale record
    return f"process {pid} ({cut(command)})" if command else f"process {pid}"


def _locker(port: str) -> int | None:
    """Who has the lock that greywhale, and other programs, put on a port's device."""
    try:
        found = os.stat(port)
        lines = (PROCESSES / "locks").read_text(encoding="ascii").splitlines()
    except OSError:
        return None
    major, minor = system.numbers(found.st_dev)
    place = f"{major:02x}:{minor:02x}:{found.st_ino}"
    for line in lines:
        match line.split():  # 1: FLOCK ADVISORY WRITE 4711 00:1a:9 0 EOF
            case [_, "FLOCK", _, _, pid, at, *_] if at == place:
                return int(pid)
    return None


def _users(port: str) -> Iterator[int]:
    """Who has it open, of this user's processes."""
    try:
        device = system.device_in(os.stat(port))
    except OSError:
        return
    for link in PROCESSES.glob("[0-9]*/fd/*"):
        try:
            if device and system.device_in(os.stat(link)) == device:
                yield int(link.parts[2])
        except OSError:  # it has ended, or closed it
            continue
