"""lerobot in an environment of its own, with what it takes without a GPU, and greywhale's plug-in for it.

It needs Python 3.12 or later, pyenv's or the system's. Where there is none, its tests are left out and say so.
"""

from __future__ import annotations

import os
from pathlib import Path

from tools import ROOT
from tools.setup import stamps, venv
from tools.setup.console import run, say

PINNED = ROOT / "tools/oracles/lerobot.txt"
PLUGIN = ROOT / "studies/lerobot_robot_greywhale"
PLACE = ROOT / "build" / "lerobot"
PYTHON = PLACE / "bin" / "python"
VERSIONS = ("3.12", "3.13")  # for which lerobot and what it takes have wheels
WHEEL = "import sys; from scikit_build_core.build import build_wheel as b; b(sys.argv[1])"


def find_python() -> Path | None:
    """A Python for lerobot; None where there is none."""
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    for version in VERSIONS:
        for python in (*sorted(pyenv.glob(f"{version}.*/bin/python3")), Path(f"/usr/bin/python{version}")):
            if python.exists():
                return python
    return None


def step() -> None:
    python = find_python()
    if python is None:
        say(f"there is no Python {' or '.join(VERSIONS)} here, so the tests with lerobot are left out")
        return
    wanted = stamps.digest([PINNED, *stamps.files_below("studies/lerobot_robot_greywhale")], str(python))
    if stamps.is_current("lerobot", wanted) and PYTHON.exists():
        return
    say("installing lerobot without its GPU packages (some hundred megabytes)")
    run([python, "-m", "venv", "--clear", PLACE], what="Making build/lerobot")
    wheels = PLACE / "wheels"
    wheels.mkdir()
    run([venv.PYTHON, "-c", WHEEL, wheels], what="Building lerobot_robot_greywhale", env=venv.environment(), cwd=PLUGIN)
    pip: list[str | Path] = [
        PYTHON,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
        "--no-input",
        "--no-deps",
    ]
    run([*pip, "--require-hashes", "--requirement", PINNED], what="Installing lerobot")
    run([*pip, "--no-index", *wheels.glob("*.whl")], what="Installing lerobot_robot_greywhale")
    stamps.set_current("lerobot", wanted)
