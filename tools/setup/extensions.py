"""Builds and installs greywhale and greywhale-sim, editable and with native extensions."""

from __future__ import annotations

from tools import ROOT
from tools.setup import stamps, venv
from tools.setup.console import say

SHARED = ("requirements.txt", "LICENSE")
ROOMS = ("codes", "fuzzy_pdi", "signal_chain")  # of the firmware
NATIVE = ("pyproject.toml", "host/native", "sim/arm", *(f"firmware/lib/{room}" for room in ROOMS))
BOARD = ("sim/pyproject.toml", "sim/CMakeLists.txt", "sim/board")


def install(name: str, place: str, stub: str, sources: tuple[str, ...], modules: str | None = None) -> None:
    """Install what is not current. An editable package finds only the modules below `modules` that it was made with."""
    names = [] if modules is None else [str(path) for path in stamps.files_below(modules) if path.suffix == ".py"]
    wanted = stamps.digest(stamps.files_below(*SHARED, *sources), *names)
    if stamps.is_current(name, wanted) and (ROOT / stub).exists():
        return
    say(f"building {name}")
    venv.pip_install("--no-build-isolation", "--no-deps", "--editable", place, what=f"Building {name}")
    stamps.set_current(name, wanted)


def step() -> None:
    install("greywhale", ".", "host/src/greywhale/_native.pyi", NATIVE, "host/src/greywhale")
    install("greywhale-sim", "sim", "sim/bench/greywhale_sim/_board.pyi", BOARD, "sim/bench/greywhale_sim")
