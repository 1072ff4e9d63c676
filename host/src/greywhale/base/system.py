"""The differences between operating systems, so that a port to another one is a matter of trying it. Those of sockets
are in `sockets`.

Linux is tried. Of Windows and macOS only the names and types are checked (`make lint`). What they do in another way, or
not at all, is said at each function. The simulated bench needs a pseudo-terminal, which Windows does not have.
"""

from __future__ import annotations

import contextlib
import errno
import io
import os
import re
import select
import signal
import stat
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TextIO

if sys.platform == "win32":
    import _thread
    import msvcrt
    import subprocess
else:
    import fcntl
    import grp
    import termios
    import tty

NOT_ON_WINDOWS = ("fcntl", "termios", "tty")  # modules of Python, which the simulated bench needs

if sys.platform == "win32":
    HANG_UP = signal.SIGBREAK  # of a console that is closed, and Ctrl-Break
    WAKE = signal.SIGILL  # Windows never sends it
else:
    HANG_UP = signal.SIGHUP  # of a terminal that is closed
    WAKE = signal.SIGURG  # nobody else uses it
ENDING = (signal.SIGINT, signal.SIGTERM, HANG_UP)
RENAMES_OPEN_FILES = sys.platform != "win32"
HANDS_DOWN_DESCRIPTORS = sys.platform != "win32"  # to the programs that it starts
WAITS_FOR_PIPES = sys.platform != "win32"  # select, for what a program prints
WAITS_FOR_SOCKETS = sys.platform != "win32"  # asyncio's usual loop, for any of them
# Pseudo-terminals that tell how far they were read; elsewhere a bench serves a TCP port.
HAS_BENCH_PORTS = sys.platform == "linux"

# How a file is opened: as it is on the disk, and not where a link leads.
_PLAIN = getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0)
PSEUDO_TERMINALS = range(136, 144)  # major numbers of devices
_CFLAG, _SPEED, _CHARACTERS = 2, 5, 6  # places in what termios returns


# --- files and folders ------------------------------------------------------------------------------------------------


def open_plain(path: Path, flags: int) -> int:
    """A descriptor of a file that is no link; no child inherits it."""
    return os.open(path, flags | _PLAIN, 0o666)


def lock(descriptor: int, wait: bool = False) -> None:
    """Hold an open file until it is closed or this process ends, however it ends: BlockingIOError where another process
    holds it, another OSError where a file system knows no locks.
    """
    if sys.platform == "win32":
        place = os.lseek(descriptor, 0, os.SEEK_CUR)
        os.lseek(descriptor, 1 << 40, os.SEEK_SET)  # others cannot read what is locked; no file is so long
        try:
            msvcrt.locking(descriptor, msvcrt.LK_LOCK if wait else msvcrt.LK_NBLCK, 1)
        except PermissionError as error:
            raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN)) from error
        finally:
            os.lseek(descriptor, place, os.SEEK_SET)
    else:
        fcntl.flock(descriptor, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))


def state_folder() -> Path:
    """The folder in which this user's programs keep what they remember: RuntimeError where the user has no home."""
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData/Local")
    if sys.platform == "darwin":
        return Path.home() / "Library/Application Support"
    return Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local/state")


@contextlib.contextmanager
def inside(folder: Path) -> Iterator[None]:
    """Work in a folder for a while."""
    if sys.platform == "win32":
        with contextlib.chdir(folder):
            yield
        return
    before = os.open(".", getattr(os, "O_PATH", os.O_RDONLY))  # its name may have gone
    try:
        os.chdir(folder)
        yield
    finally:
        os.fchdir(before)
        os.close(before)


# --- signals and processes --------------------------------------------------------------------------------------------


def user() -> int:
    """This user's number; Windows has none, and says 0 of every file's owner too."""
    if sys.platform == "win32":
        return 0
    else:
        return os.geteuid()


@contextlib.contextmanager
def no_interrupts_for_children() -> Iterator[None]:
    """Programs that are started meanwhile do not hear Ctrl-C, where a system can tell them so."""
    if sys.platform == "win32":
        yield
        return
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def hear_interrupts() -> None:
    """End what `no_interrupts_for_children` began in the process that started this one."""
    if sys.platform != "win32":
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


def signal_main_thread(number: signal.Signals) -> None:
    """Send it there, which ends a system call that waits; on Windows the handler runs after the call."""
    if sys.platform == "win32":
        _thread.interrupt_main(number)
    else:
        signal.pthread_kill(threading.main_thread().ident or 0, number)


def end_group(leader: int, by_force: bool) -> None:
    """End a process that began a session, and all that it has started; on Windows by force in any case."""
    if sys.platform == "win32":
        subprocess.run(["taskkill", "/F", "/T", "/PID", str(leader)], check=False, capture_output=True)
        return
    with contextlib.suppress(ProcessLookupError):
        os.killpg(leader, signal.SIGKILL if by_force else signal.SIGTERM)


def give_way(niceness: int) -> None:
    """Let other processes go first; on Windows this one competes with them."""
    if sys.platform != "win32":
        os.setpriority(os.PRIO_PROCESS, 0, niceness)


# --- terminals --------------------------------------------------------------------------------------------------------


def in_foreground() -> bool:
    """True if a terminal's Ctrl-C reaches this process."""
    try:
        with open("CONIN$" if sys.platform == "win32" else "/dev/tty", "rb", buffering=0) as terminal:
            return sys.platform == "win32" or os.tcgetpgrp(terminal.fileno()) == os.getpgrp()
    except OSError:
        return False


def has_typed(stream: TextIO, wait: bool) -> bool:
    """True if something can be read; `wait` until it can. On Windows a key is enough: reading waits for its line."""
    if sys.platform == "win32":
        return wait or not stream.isatty() or msvcrt.kbhit()
    return bool(select.select([stream], [], [], None if wait else 0.0)[0])


def forget_typed(terminal: TextIO) -> None:
    """Nobody reads what was typed so far."""
    if sys.platform == "win32":
        while msvcrt.kbhit():
            msvcrt.getwch()
    else:
        termios.tcflush(terminal, termios.TCIFLUSH)


@contextlib.contextmanager
def pressed_keys(terminal: TextIO) -> Iterator[Callable[[], str]]:
    """Keys of a terminal, unseen and without Enter: a function that returns what was pressed since its last call.

    Where no more can come it is Ctrl-D. What is typed for another program is left.
    """
    forget_typed(terminal)
    if sys.platform == "win32":
        yield lambda: "".join(iter(lambda: msvcrt.getwch() if msvcrt.kbhit() else "", ""))
    else:

        def read() -> str:
            if not has_typed(terminal, wait=False) or not in_foreground():
                return ""
            try:
                return os.read(terminal.fileno(), 64).decode("utf-8", "replace") or "\x04"
            except OSError:  # it was closed
                return "\x04"

        before = termios.tcgetattr(terminal)
        tty.setcbreak(terminal, termios.TCSADRAIN)
        try:
            yield read
        finally:
            with contextlib.suppress(termios.error):
                termios.tcsetattr(terminal, termios.TCSADRAIN, before)


def readable(descriptors: list[int], pause_s: float | None) -> set[int]:
    """Those that have something to read, or have ended, after at most the pause; Windows takes sockets only."""
    if sys.platform == "win32":
        return set(select.select(descriptors, [], [], pause_s)[0])
    poll = select.poll()
    for descriptor in descriptors:
        poll.register(descriptor, select.POLLIN)
    return {descriptor for descriptor, _ in poll.poll(None if pause_s is None else pause_s * 1000)}


# --- serial ports -----------------------------------------------------------------------------------------------------


def device_of(port: str) -> str | None:
    """The device behind a port by its number, whatever it is called; None where no device is. On Windows its name.

    A pseudo-terminal's number is soon another one's, so the time at which it was made counts too.
    """
    if sys.platform == "win32":
        return port.upper() if re.fullmatch(r"(?i)COM\d+", port) else None
    try:
        found = os.stat(port)
    except (OSError, ValueError):
        return None
    if not stat.S_ISCHR(found.st_mode):
        return None
    made = f":{found.st_ctime_ns}" if os.major(found.st_rdev) in PSEUDO_TERMINALS else ""
    return f"{os.major(found.st_rdev)}:{os.minor(found.st_rdev)}{made}"


def numbers(device: int) -> tuple[int, int]:
    """Major and minor number of a device; Windows has none."""
    if sys.platform == "win32":
        return 0, 0
    else:
        return os.major(device), os.minor(device)


def device_in(found: os.stat_result) -> int:
    """The number of the device that a file stands for, 0 where it stands for none, and on Windows."""
    if sys.platform == "win32":
        return 0
    else:
        return found.st_rdev


def exists(port: str) -> bool:
    return device_of(port) is not None if sys.platform == "win32" else os.path.exists(port)


def may_open(port: str) -> bool:
    """True if this user has the right to; on Windows everybody has."""
    return sys.platform == "win32" or os.access(port, os.R_OK | os.W_OK)


def group_of(port: str) -> str:
    """The group that owns the port; "" where there is none."""
    if sys.platform == "win32":
        return ""
    else:
        try:
            return grp.getgrgid(os.stat(port).st_gid).gr_name
        except (KeyError, OSError):
            return ""


def is_own_terminal(port: str) -> bool:
    """True if a person types there: to open it as a port would spoil it."""
    if sys.platform == "win32":
        return False
    device = os.stat(port).st_rdev
    return device == os.makedev(5, 0) or any(  # /dev/tty, whichever terminal that is
        os.isatty(stream) and os.fstat(stream).st_rdev == device for stream in range(3)
    )


def open_errno(error: OSError) -> int | None:
    """The errno of a port that pyserial could not open. Windows says it in words: access denied if it is in use."""
    if sys.platform != "win32":
        return error.errno
    code = re.search(r"Error\((\d+),", str(error))
    number = None if code is None else int(code[1])
    return errno.EBUSY if number == errno.EACCES else number


def keeps_dtr(line: io.RawIOBase) -> bool:
    """True if DTR stays up when an open port is closed; on Windows it falls."""
    if sys.platform == "win32":
        return False
    else:
        try:
            return not termios.tcgetattr(line.fileno())[_CFLAG] & termios.HUPCL
        except termios.error:
            return False


def keep_dtr(line: io.RawIOBase, up: bool) -> None:
    """Say whether DTR stays up when an open port is closed, where a system can be told."""
    if sys.platform != "win32":
        with contextlib.suppress(termios.error):  # an unplugged cable has no DTR
            flags = termios.tcgetattr(line.fileno())
            flags[_CFLAG] = flags[_CFLAG] & ~termios.HUPCL if up else flags[_CFLAG] | termios.HUPCL
            termios.tcsetattr(line.fileno(), termios.TCSANOW, flags)


def line_settings(line: io.RawIOBase) -> tuple[int, ...] | None:
    """The settings of an open port: flags and speeds. None where the system has hung it up, and on Windows."""
    if sys.platform == "win32":
        return None
    else:
        try:
            found: list[int] = termios.tcgetattr(line.fileno())[:_CHARACTERS]
        except (termios.error, OSError, TypeError):  # TypeError: pyserial's, of a port that is closed
            return None
        found[_CFLAG] &= ~termios.HUPCL  # which this side changes itself
        return tuple(found)


def speed_in(settings: tuple[int, ...]) -> int | None:
    """The speed (baud) among a port's settings, None for one without a name."""
    if sys.platform == "win32":
        return None
    else:
        names = [name for name in dir(termios) if re.fullmatch(r"B\d+", name)]
        return next((int(name[1:]) for name in names if getattr(termios, name) == settings[_SPEED]), None)


def keep_others_out(line: io.RawIOBase, keep: bool) -> None:
    """Let no other program but a superuser's open a port that this one has open.

    Not a pseudo-terminal: whoever made it has it open too, so that it would stay closed after a process that was
    killed. Windows does so by itself.
    """
    if sys.platform != "win32":
        with contextlib.suppress(OSError):
            if os.major(os.fstat(line.fileno()).st_rdev) not in PSEUDO_TERMINALS:
                fcntl.ioctl(line.fileno(), termios.TIOCEXCL if keep else termios.TIOCNXCL)


def pseudo_terminal_of(device: int) -> int | None:
    """The number of a pseudo-terminal, 3 for /dev/pts/3; None where a device is none."""
    if sys.platform != "linux" or os.major(device) not in PSEUDO_TERMINALS:
        return None
    return (os.major(device) - PSEUDO_TERMINALS.start) * 256 + os.minor(device)
