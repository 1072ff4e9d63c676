"""Installs greywhale-paper, editable: two verbs in Python alone, so there is nothing to compile."""

from __future__ import annotations

from tools import ROOT
from tools.setup import extensions, stamps, venv
from tools.setup.console import run, say

FOLDER = ROOT / "studies" / "paper"
WHEELS = ROOT / "build" / "editable_paper"
BUILD = "import sys; from scikit_build_core.build import build_editable as b; b(sys.argv[1])"
STAMP = "paper"


def step() -> None:
    """Install it if that is not current. An editable one finds new modules by itself."""
    if stamps.is_current(STAMP, inputs()):
        return
    say("installing greywhale-paper (2 s)")
    stamps.forget(STAMP)
    WHEELS.mkdir(parents=True, exist_ok=True)
    for old in WHEELS.glob("*.whl"):
        old.unlink()
    run([venv.PYTHON, "-c", BUILD, WHEELS], what="Building greywhale-paper", env=venv.environment(), cwd=FOLDER)
    flags = ("--no-index", "--no-deps", "--force-reinstall")
    venv.pip_install(*flags, *WHEELS.glob("*.whl"), what="Installing greywhale-paper")
    extensions.name_places_from_here()
    stamps.set_current(STAMP, inputs())


def inputs() -> str:
    """The digest of what is installed."""
    return stamps.digest(
        stamps.files_below("studies/paper/pyproject.toml", "studies/paper/README.md", "LICENSE", "requirements.txt")
    )
