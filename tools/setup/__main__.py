"""Everything that make needs, from a bare Debian on: `python3 -m tools.setup`; `python3 -m tools.setup page` leaves out
what only checks and tests need, and `python3 -m tools.setup run` the page of the dashboard too.

Needs only the system's Python. Each step checks whether it has anything to do, so that repeating it takes no time.
"""

from __future__ import annotations

import fcntl
import signal
import sys
import time

from tools import ROOT

if sys.version_info < (3, 11):  # noqa: UP036 (an older Python is what this is about)
    sys.exit(f"greywhale needs Python 3.11 or newer, but {sys.executable} is {sys.version.split()[0]}.")

from tools.setup import debian, extensions, firmware, page, page_modules, platformio, venv
from tools.setup.console import SetupError, say, side_by_side


def steps(with_page: bool, checks: bool) -> None:
    def what_needs_packages() -> None:
        venv.packages(with_page, checks)
        if with_page:
            page.step()
        platformio.step(checks)
        firmware.step(checks)

    debian.step(checks)
    venv.step(checks)
    side_by_side(extensions.step, what_needs_packages, *([page_modules.step] if checks else []))


def main(arguments: list[str]) -> int:
    with_page, checks = arguments != ["run"], not arguments
    start = time.monotonic()
    for request in (signal.SIGTERM, signal.SIGHUP):  # they end all as Ctrl-C does
        signal.signal(request, signal.default_int_handler)
    build = ROOT / "build"
    build.mkdir(exist_ok=True)
    with (build / "setup.lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            say("waiting for another set-up of this folder to finish")
            fcntl.flock(lock, fcntl.LOCK_EX)
        try:
            steps(with_page, checks)
        except SetupError as error:
            print(f"set-up: {error}", file=sys.stderr)
            return 1
        except KeyboardInterrupt:
            print("set-up: stopped; run it again to continue.", file=sys.stderr)
            return 1
    say(f"ready ({time.monotonic() - start:.1f} s)")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
