"""Everything that make needs, from a bare system on: `python3 -m tools.setup`; `python3 -m tools.setup site` leaves out
what only checks and tests need, `... page` the documentation too, and `... run` the page as well.

Needs only the system's Python. Each step checks whether it has anything to do, so that repeating it takes no time. What
runs side by side shares nothing: it reads the .venv, which is whole by then, and writes to places of its own.
"""

from __future__ import annotations

import fcntl
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

from tools import ROOT
from tools.setup import extensions, firmware, page, page_modules, paper, platformio, stamps, system, venv
from tools.setup.console import SetupError, say, side_by_side
from tools.setup.goal import Goal


@contextmanager
def lock_folder() -> Iterator[None]:
    """One set-up of this folder at a time."""
    build = ROOT / "build"
    try:
        build.mkdir(exist_ok=True)
        lock = (build / "setup.lock").open("w")
    except OSError as error:
        raise SetupError(f"{build} cannot be written ({error.strerror}): build in a folder of your own.") from None
    with lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            say("waiting for another set-up of this folder to finish")
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def tell_how_long() -> None:
    """Tell a person how long it takes, where nothing is done yet (docs/setup.md has the times)."""
    if not stamps.STAMPS.exists():
        say("the first time this takes about 2 minutes, on a busy or slow computer up to 6; after that a second")


def steps(goal: Goal) -> None:
    source = platformio.choose()
    checks = goal >= Goal.ALL
    system.step(goal, avr_compiler=source == "system")
    venv.step(goal, compiler=source != "registry")

    def build_firmware() -> None:
        platformio.step(source)
        firmware.step(source, checks)

    def build_page() -> None:
        if goal >= Goal.PAGE:
            page_modules.step(goal)
            page.step()

    side_by_side(lambda: extensions.build(checks), build_firmware, build_page)
    extensions.install(checks)
    paper.step()


def main(arguments: list[str]) -> int:
    goal = Goal[arguments[0].upper()] if arguments else Goal.ALL
    start = time.monotonic()
    for request in (signal.SIGTERM, signal.SIGHUP):  # they end all as Ctrl-C does
        signal.signal(request, signal.default_int_handler)
    try:
        with lock_folder():
            tell_how_long()
            steps(goal)
    except SetupError as error:
        print(f"set-up: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("set-up: stopped; the same command goes on from there.", file=sys.stderr)
        return 1
    say(f"ready ({time.monotonic() - start:.1f} s)")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
