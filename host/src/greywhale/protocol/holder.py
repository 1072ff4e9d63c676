"""Finds who has a port open, as far as the system tells this user: for the person who wants it free."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterable, Iterator
from pathlib import Path

from greywhale.base import system
from greywhale.base.errors import cut

PROCESSES = Path("/proc")  # not there on every system


# Programs that open ports of their own accord, as another user, so that the system does not tell which: what keeps them
# away, by what the system calls their process.
_MEDDLERS = {
    "ModemManager": "run `greywhale udev`, whose rules keep ModemManager away, which runs here and opens new ports",
    "brltty": "end brltty, which runs here and takes USB bridges for braille displays",
    "gpsd": "take the port out of the settings of gpsd, which runs here and looks for GPS receivers",
}
# What udev keeps of a device, by its number, and what ModemManager looks for there before it opens a port.
UDEV = Path("/run/udev/data")
_LEFT_ALONE = ("E:ID_MM_DEVICE_IGNORE=1", "E:ID_MM_PORT_IGNORE=1")


def holder_of(port: str) -> str | None:
    """The process that has locked a port, else another one that has it open, in words; None where nobody tells."""
    pid = _locker(port) or next(_users(port), None)
    return None if pid is None else describe(pid)


def second_user_of(port: str) -> str | None:
    """Another process that has this process's port open, in words; None where the system tells of none.

    Whoever made a pseudo-terminal, such as the bench, is at its other end, and no second user.
    """
    pid = next(_users(port), None)
    return None if pid is None else describe(pid)


def meddler(port: str) -> str | None:
    """Advice against a program that runs here and may open the port of its own accord; None where none is known."""
    try:
        device = system.device_in(os.stat(port))
    except OSError:
        return None
    if system.pseudo_terminal_of(device) is not None:
        return None  # none of them looks there
    for name in PROCESSES.glob("[0-9]*/comm"):
        with contextlib.suppress(OSError):  # it has ended
            program = name.read_text(encoding="utf-8", errors="replace").strip()
            if program in _MEDDLERS and not (program == "ModemManager" and _left_alone(device)):
                return _MEDDLERS[program]
    return None


def _left_alone(device: int) -> bool:
    major, minor = system.numbers(device)
    try:
        facts = (UDEV / f"c{major}:{minor}").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return False
    return any(line in facts for line in _LEFT_ALONE)


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
    """The process with the lock that greywhale, and other programs, put on a port's device."""
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
    """The other processes that have it open, of those that the system shows to this user."""
    try:
        device = system.device_in(os.stat(port))
    except OSError:
        return
    links = _open_files() if device else []
    ours = {os.getpid(), *_makers(links, system.pseudo_terminal_of(device))}
    for link in links:
        with contextlib.suppress(OSError):  # it has ended, or closed it
            pid = int(link.parts[2])
            if pid not in ours and system.device_in(os.stat(link)) == device:
                yield pid


def _open_files() -> list[Path]:
    """The open files of the processes that the system shows to this user; some end meanwhile."""
    links: list[Path] = []
    for process in PROCESSES.glob("[0-9]*"):
        with contextlib.suppress(OSError):
            links += (process / "fd").iterdir()
    return links


def _makers(links: Iterable[Path], pseudo_terminal: int | None) -> Iterator[int]:
    """The processes that made a pseudo-terminal: they have its other end open."""
    if pseudo_terminal is None:
        return
    for link in links:
        with contextlib.suppress(OSError):
            if os.readlink(link).endswith("/ptmx"):
                facts = (link.parents[1] / "fdinfo" / link.name).read_text(encoding="ascii").split()
                if "tty-index:" in facts and facts[facts.index("tty-index:") + 1] == str(pseudo_terminal):
                    yield int(link.parts[2])
