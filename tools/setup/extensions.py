"""Builds and installs greywhale and greywhale-sim, editable and with native extensions.

The build leaves the .venv alone, so that it may run beside what else uses the .venv; the installation takes a second.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from tools import ROOT
from tools.setup import stamps, system, venv
from tools.setup.console import run, say

WHEELS = ROOT / "build" / "editable"
BUILD = (
    "import sys; from scikit_build_core.build import build_editable as b; b(sys.argv[1], {sys.argv[2]: sys.argv[3]})"
)


@dataclass(frozen=True)
class Package:
    """A package, its stub, what it is compiled from, and where its modules lie that an editable wheel must name."""

    name: str
    place: Path
    stub: str
    sources: tuple[str, ...]
    modules: str
    expected_s: int

    @property
    def wheels(self) -> Path:
        return WHEELS / self.name

    def inputs(self) -> str:
        names = [str(path) for path in stamps.files_below(self.modules) if path.suffix == ".py"]
        return stamps.digest(stamps.files_below("requirements.txt", "LICENSE", *self.sources), *names)


ROOMS = ("codes", "fuzzy_pdi", "signal_chain")  # of the firmware
PACKAGES = (
    Package(
        "greywhale",
        ROOT,
        "host/src/greywhale/_native.pyi",
        ("pyproject.toml", "host/native", "sim/arm", *(f"firmware/lib/{room}" for room in ROOMS)),
        "host/src/greywhale",
        40,
    ),
    Package(
        "greywhale-sim",
        ROOT / "sim",
        "sim/bench/greywhale_sim/_board.pyi",
        ("sim/pyproject.toml", "sim/CMakeLists.txt", "sim/board"),
        "sim/bench/greywhale_sim",
        10,
    ),
)


def build(checks: bool) -> None:
    """Build the wheels that are not current. For checks a warning is an error."""
    for package in PACKAGES:
        if stamps.is_current(package.name, package.inputs(), checks) and (ROOT / package.stub).exists():
            continue
        say(f"building {package.name} ({package.expected_s} s)")
        stamps.forget(package.name)
        package.wheels.mkdir(parents=True, exist_ok=True)
        for old in package.wheels.iterdir():
            old.unlink()
        setting = ("cmake.define.GREYWHALE_WERROR", "ON" if checks else "OFF")
        command: list[str | Path] = [venv.PYTHON, "-c", BUILD, package.wheels, *setting]
        # Else the compiler that Python itself was built with is taken, which may not be here.
        compiler = {"CXX": system.cxx_compiler() or "c++"}
        run(command, what=f"Building {package.name}", env={**venv.environment(), **compiler}, cwd=package.place)


def install(checks: bool) -> None:
    """Install the wheels that were built."""
    fresh = [package for package in PACKAGES if not stamps.is_current(package.name, package.inputs(), checks)]
    if not fresh:
        return
    wheels = [wheel for package in fresh for wheel in package.wheels.glob("*.whl")]
    venv.pip_install("--no-index", "--no-deps", "--force-reinstall", *wheels, what="Installing greywhale")
    name_places_from_here()
    for package in fresh:
        stamps.set_current(package.name, package.inputs(), checks)


def name_places_from_here() -> None:
    """Name our folders in .pth files by their way from there, which is ASCII.

    Python reads these files in the locale's encoding, and does not start where a folder's name is not in it.
    """
    for file in venv.site_packages().glob("_editable_skbc_greywhale*.pth"):
        lines = file.read_text(encoding="utf-8").splitlines()
        lines = [os.path.relpath(line, file.parent) if os.path.isabs(line) else line for line in lines]
        file.write_text("\n".join(lines) + "\n", encoding="ascii")
