"""Collects what greywhale and greywhale-paper depend on as wheels in build/wheelhouse: to install in tests."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from tools import ROOT, lock
from tools.setup import stamps, venv
from tools.setup.console import run, say

VERSIONS = ROOT / "build" / "versions.txt"


def place(python: Path = venv.PYTHON) -> Path:
    """The folder with the wheels for this Python's version."""
    code = "import sys; print('%d.%d' % sys.version_info[:2])"
    version = subprocess.run([python, "-c", code], capture_output=True, text=True, check=True).stdout.strip()
    return ROOT / "build" / "wheelhouse" / version


def step(python: Path = venv.PYTHON) -> None:
    """Fetch them for this Python."""
    needed, folder = [*lock.runtime(), *lock.paper()], place(python)
    wanted = stamps.digest([venv.REQUIREMENTS], *needed)
    stamp = f"wheelhouse-{folder.name}"
    if stamps.is_current(stamp, wanted) and folder.is_dir():
        return
    say(f"fetching what greywhale depends on, for installations without a network (Python {folder.name})")
    shutil.rmtree(folder, ignore_errors=True)
    pip = [str(python), "-m", "pip", "wheel", "--quiet", "--disable-pip-version-check", "--no-input"]
    # Where a file has digests, pip takes nothing that is not pinned on the command line; versions alone will do.
    VERSIONS.write_text("\n".join(lock.versions()) + "\n", encoding="utf-8")
    constraint = ["--constraint", str(VERSIONS), "--wheel-dir", str(folder)]
    run([*pip, *constraint, *needed], what="Fetching wheels", env=venv.environment())
    stamps.set_current(stamp, wanted)


if __name__ == "__main__":
    step()
