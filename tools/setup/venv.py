"""The project's own Python environment, .venv: the packages that are pinned, down to the bytes of their files."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from tools import ROOT
from tools.setup import stamps
from tools.setup.console import run, say

VENV = ROOT / ".venv"
PYTHON = VENV / "bin" / "python"
REQUIREMENTS = ROOT / "requirements.txt"  # what it takes to build and run
FOR_CHECKS = ROOT / "tools" / "requirements.txt"


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


def step(checks: bool) -> None:
    if not works():
        say("making the Python environment .venv")
        stamps.forget()  # nothing is installed in it
        run([sys.executable, "-m", "venv", "--clear", VENV], what="Making .venv")
    files = [REQUIREMENTS, FOR_CHECKS] if checks else [REQUIREMENTS]
    missing = [file for file in files if not stamps.is_current(_stamp(file), stamps.digest([file], sys.version))]
    if not missing:
        return
    names = " and ".join(str(file.relative_to(ROOT)) for file in missing)
    say(f"installing the Python packages of {names} (about a minute the first time)")
    given = [word for file in missing for word in ("--requirement", file)]
    pip_install("--require-hashes", "--no-deps", *given, what=f"Installing the Python packages of {names}")
    for file in missing:
        stamps.set_current(_stamp(file), stamps.digest([file], sys.version))


def _stamp(requirements: Path) -> str:
    return "venv-checks" if requirements == FOR_CHECKS else "venv-run"
