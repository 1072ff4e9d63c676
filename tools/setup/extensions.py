"""Builds and installs greywhale, editable and with its native module.

The build leaves the .venv alone, so that it may run beside what else uses the .venv; the installation takes a second.
"""

from __future__ import annotations

import os
from pathlib import Path

from tools import ROOT
from tools.setup import stamps, system, venv
from tools.setup.console import run, say

WHEELS = ROOT / "build" / "editable"
BUILD = (
    "import sys; from scikit_build_core.build import build_editable as b; b(sys.argv[1], {sys.argv[2]: sys.argv[3]})"
)
ROOMS = ("codes", "fuzzy_pdi", "signal_chain")  # of the firmware
SOURCES = (
    *("pyproject.toml", "CMakeLists.txt", "requirements.txt", "LICENSE"),
    *("host/native", "sim/bench.cmake", "sim/arm", "sim/bind", "sim/board"),
    *(f"firmware/lib/{room}" for room in ROOMS),
)
MODULES = ("host/src/greywhale", "sim/bench/greywhale_sim")  # whose modules an editable wheel must name
STUB = ROOT / "host/src/greywhale/_native.pyi"
STAMP = "greywhale"


def build(checks: bool) -> None:
    """Build the wheel if it is not current. For checks a warning is an error."""
    if stamps.is_current(STAMP, inputs(), checks) and STUB.exists():
        return
    say("building greywhale (50 s)")
    stamps.forget(STAMP)
    WHEELS.mkdir(parents=True, exist_ok=True)
    for old in WHEELS.glob("*.whl"):
        old.unlink()
    setting = ("cmake.define.GREYWHALE_WERROR", "ON" if checks else "OFF")
    command: list[str | Path] = [venv.PYTHON, "-c", BUILD, WHEELS, *setting]
    # Else the compiler that Python itself was built with is taken, which may not be here.
    compiler = {"CXX": system.cxx_compiler() or "c++"}
    run(command, what="Building greywhale", env={**venv.environment(), **compiler}, cwd=ROOT)


def install(checks: bool) -> None:
    """Install the wheel that was built."""
    if stamps.is_current(STAMP, inputs(), checks):
        return
    flags = ("--no-index", "--no-deps", "--force-reinstall")
    venv.pip_install(*flags, *WHEELS.glob("*.whl"), what="Installing greywhale")
    name_places_from_here()
    stamps.set_current(STAMP, inputs(), checks)


def inputs() -> str:
    """The digest of what the wheel is built from."""
    names = [str(path) for path in stamps.files_below(*MODULES) if path.suffix == ".py"]
    bench = (path for path in stamps.files_below("sim/bench") if path.suffix in (".h", ".cpp"))
    return stamps.digest([*stamps.files_below(*SOURCES), *bench], *names)


def name_places_from_here() -> None:
    """Name our folders in .pth files by their way from there, which is ASCII.

    Python reads these files in the locale's encoding, and does not start where a folder's name is not in it.
    """
    for file in venv.site_packages().glob("_editable_skbc_greywhale*.pth"):
        lines = file.read_text(encoding="utf-8").splitlines()
        lines = [os.path.relpath(line, file.parent) if os.path.isabs(line) else line for line in lines]
        file.write_text("\n".join(lines) + "\n", encoding="ascii")
