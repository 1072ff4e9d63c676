"""Runs a build tool so that it outlives neither its purpose nor its time: a program of its own between host and tool.

    python guard.py LIMIT_S PORT COMMAND...

A host that is killed cannot end its tools. A board that is being flashed should get the whole image all the same, so
the tool goes on. But avrdude never notices that its port has gone, and would hold a processor for ever. So without its
host the tool ends when the port goes away, or after its limit. The standard input is the host's end of a pipe, which
closes when the host dies. PORT is empty where there is none. The guard ends as the tool does.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time

LOOK_EVERY_S = 0.2
CANNOT_START = 127


def main(limit_s: float, port: str, command: list[str]) -> int:
    signal.signal(signal.SIGTERM, lambda *_: None)  # it is the tool's, which may need a moment to end
    first = _identity(port)
    try:
        tool = subprocess.Popen(command, stdin=subprocess.DEVNULL)
    except OSError as error:
        print(f"{command[0]}: {error.strerror}")
        return CANNOT_START
    threading.Thread(target=_watch, args=(tool, limit_s, port, first), daemon=True).start()
    code = tool.wait()
    if code < 0:  # end as the tool did
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        os.kill(os.getpid(), -code)
    return code


def _watch(tool: subprocess.Popen[bytes], limit_s: float, port: str, first: tuple[int, ...]) -> None:
    """Wait for the host's death; from then on look after the tool."""
    deadline = time.monotonic() + limit_s
    os.read(sys.stdin.fileno(), 1)
    while time.monotonic() < deadline and _identity(port) == first:
        time.sleep(LOOK_EVERY_S)
    if sys.platform != "win32":
        os.killpg(0, signal.SIGKILL)  # with all that the tool has started, and this process
    tool.kill()


def _identity(port: str) -> tuple[int, ...]:
    """What tells a port from a later one of the same name; empty where there is none."""
    try:
        found = os.stat(port)
    except OSError:
        return ()
    return found.st_dev, found.st_ino, found.st_ctime_ns


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1]), sys.argv[2], sys.argv[3:]))
