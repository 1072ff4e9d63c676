"""The project's own Python environment, .venv: the packages of requirements.txt, down to the bytes of their files."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from tools.setup import stamps
from tools.setup.console import ROOT, run, say

VENV = ROOT / ".venv"
PYTHON = VENV / "bin" / "python"
REQUIREMENTS = ROOT / "requirements.txt"


def environment() -> dict[str, str]:
    """What commands of the .venv need: its programs first on the PATH."""
    return {"PATH": f"{VENV / 'bin'}{os.pathsep}{os.environ['PATH']}", "VIRTUAL_ENV": str(VENV)}


def pip_install(*arguments: str | Path, what: str) -> None:
    quiet = ["--quiet", "--disable-pip-version-check", "--no-input"]
    run([PYTHON, "-m", "pip", "install", *quiet, *arguments], what=what, env=environment())


def works() -> bool:
    """Whether .venv is there and belongs to this folder (a copied or moved one does not)."""
    if not PYTHON.exists():
        return False
    question = [str(PYTHON), "-c", "import pip, sys; print(sys.prefix)"]
    answer = subprocess.run(question, capture_output=True, text=True, check=False)
    return answer.returncode == 0 and Path(answer.stdout.strip()) == VENV


def step() -> None:
    wanted = stamps.digest([REQUIREMENTS], sys.version)
    if not works():
        say("making the Python environment .venv")
        run([sys.executable, "-m", "venv", "--clear", VENV], what="Making .venv")
    elif stamps.is_current("venv", wanted):
        return
    say("installing the pinned Python packages (about a minute the first time)")
    pinned = ("--require-hashes", "--no-deps", "--requirement", REQUIREMENTS)
    pip_install(*pinned, what="Installing the Python packages of requirements.txt")
    stamps.set_current("venv", wanted)
