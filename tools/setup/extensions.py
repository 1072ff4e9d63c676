"""Builds and installs the two packages, greywhale and greywhale-sim, editable and with their native extensions."""

from __future__ import annotations

from tools.setup import stamps, venv
from tools.setup.console import ROOT, say

SHARED = ("requirements.txt", "LICENSE")
NATIVE = ("pyproject.toml", "host/native", "sim/arm", "firmware/lib/fuzzy_pdi", "firmware/lib/signal_chain")
BOARD = ("sim/pyproject.toml", "sim/CMakeLists.txt", "sim/board")


def install(name: str, place: str, stub: str, sources: tuple[str, ...]) -> None:
    wanted = stamps.digest(stamps.files_below(*SHARED, *sources))
    if stamps.is_current(name, wanted) and (ROOT / stub).exists():
        return
    say(f"building {name}")
    venv.pip_install("--no-build-isolation", "--no-deps", "--editable", place, what=f"Building {name}")
    stamps.set_current(name, wanted)


def step() -> None:
    install("greywhale", ".", "host/src/greywhale/_native.pyi", NATIVE)
    install("greywhale-sim", "sim", "sim/bench/greywhale_sim/_board.pyi", BOARD)
