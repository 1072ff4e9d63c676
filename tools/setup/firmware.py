"""Builds the firmware of both boards."""

from __future__ import annotations

from pathlib import Path

from tools import ROOT
from tools.setup import platformio, stamps, venv
from tools.setup.console import run, say

BOARDS = ("megaatmega2560", "nanoatmega328")
BUILD = ROOT / "firmware" / ".pio" / "build"
SCRIPTS = ("firmware/image_record.py", "firmware/source_digest.py", "firmware/strict_warnings.py")
SOURCES = ("firmware/src", "firmware/lib", "firmware/platformio.ini", *SCRIPTS)


def step(checks: bool) -> None:
    tools = stamps.files_below(*SOURCES, "tools/setup", "requirements.txt")
    wanted = stamps.digest(tools, str(platformio.FINISHED.exists()))
    if stamps.is_current("firmware", wanted) and all((BUILD / board / "firmware.hex").exists() for board in BOARDS):
        return
    say(f"building the firmware for {' and '.join(BOARDS)}")
    command: list[str | Path] = [venv.PYTHON, "-m", "platformio", "run", "--project-dir", ROOT / "firmware"]
    for board in BOARDS:
        command += ["--environment", board]
    run(command, what="Building the firmware", env=platformio.environment())
    stamps.set_current("firmware", wanted)
