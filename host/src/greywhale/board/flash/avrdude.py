"""Finds avrdude and lets it write an image through a bootloader."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable
from pathlib import Path

from greywhale.base.errors import UserError
from greywhale.base.types import Progress
from greywhale.board.flash.runner import Tool, run_tool
from greywhale.board.flash.targets import FlashBoard

UPLOAD_LIMIT_S = 180.0  # for a flash memory that is full

# Where the Arduino IDE and arduino-cli keep their tools: Linux, macOS, Windows.
_ARDUINO_FOLDERS = (".arduino15", "Library/Arduino15", "AppData/Local/Arduino15")


def find_avrdude() -> list[str] | None:
    """avrdude's command as the system has it, else as PlatformIO or Arduino fetched it; None where there is none.

    A fetched avrdude does not find its configuration file by itself.
    """
    found = shutil.which("avrdude")
    if found is not None:
        return [found]
    for folder in _tool_folders():
        for program in (folder / "bin" / "avrdude", folder / "bin" / "avrdude.exe", folder / "avrdude"):
            for settings in (folder / "avrdude.conf", folder / "etc" / "avrdude.conf"):
                if program.is_file() and settings.is_file():
                    return [str(program), "-C", str(settings)]
    return None


def need_avrdude() -> list[str]:
    command = find_avrdude()
    if command is None:
        raise UserError(
            "avrdude, which writes the firmware onto a board, is not installed; install it "
            "(Debian, Ubuntu: `sudo apt-get install avrdude`; macOS: `brew install avrdude`) and try again."
        )
    return command


def upload_image(port: str, board: FlashBoard, baud: int, image: Path, report: Progress) -> None:
    """Write the image and read it back."""
    command = [*need_avrdude(), "-c", board.programmer, "-p", board.part, "-P", port, "-D", "-U", f"flash:w:{image}:i"]
    tool = Tool("avrdude", [*command, "-b", str(baud)], dict(os.environ), UPLOAD_LIMIT_S, port)
    run_tool(tool, watch_upload(port, report))


def watch_upload(port: str, report: Progress) -> Callable[[str], None]:
    """Turns avrdude's rows of # into fractions; PlatformIO passes them on. avrdude itself never notices a lost port."""
    has_path = os.path.exists(port)  # a port of Windows has none

    def look(text: str) -> None:
        if has_path and not os.path.exists(port):
            raise UserError(f"{port} went away while it was being flashed; connect the board and flash it again.")
        for verb, stage in (("Reading", "verifying"), ("Writing", "writing")):  # the later one first
            rows = re.findall(rf"{verb} \| (#*)", text)
            if rows:
                report(stage, min(1.0, len(rows[-1]) / 50))
                return

    return look


def _tool_folders() -> list[Path]:
    """avrdude's folders in PlatformIO's and Arduino's homes, the latest version first."""
    core = Path(os.environ.get("PLATFORMIO_CORE_DIR") or Path.home() / ".platformio")
    folders = [core / "packages" / "tool-avrdude"]
    for name in _ARDUINO_FOLDERS:
        folders += sorted((Path.home() / name).glob("packages/arduino/tools/avrdude/*"), reverse=True)
    return folders
