"""Flashes a board: PlatformIO builds and uploads the source tree, or avrdude alone uploads a HEX file; then the new
firmware is greeted, so that success means that it runs.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from greywhale.board.device import Device
from greywhale.board.flash.bootloader import find_speed
from greywhale.board.flash.runner import Tool, run_tool
from greywhale.errors import BAD_USAGE, UserError
from greywhale.protocol import schema
from greywhale.protocol.transport import BAUD, open_serial

Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class FlashBoard:
    """How a board is built for and spoken to: PlatformIO's environment, avrdude's part and programmer, its
    bootloader.
    """

    environment: str
    part: str
    programmer: str
    bauds: tuple[int, ...]
    identity: schema.Board


# Nanos are sold with two bootloaders that look alike from outside: which speed it is must be found out.
BOARDS = {
    "mega": FlashBoard("megaatmega2560", "atmega2560", "wiring", (115200,), schema.Board.MEGA2560),
    "nano": FlashBoard("nanoatmega328", "atmega328p", "arduino", (115200, 57600), schema.Board.NANO328),
}

# Longest time of a first build on a slow machine, and of an upload of a full flash memory.
_BUILD_LIMIT_S = 600.0
_UPLOAD_LIMIT_S = 180.0


def flash(
    port: str,
    board: str,
    firmware_dir: str | Path | None = None,
    hex_file: str | Path | None = None,
    progress: Progress | None = None,
) -> schema.HelloReply:
    """Flash the board on `port` and return the new firmware's greeting."""
    if board not in BOARDS:
        raise UserError(f"board {board!r} is unknown; choose one of {', '.join(BOARDS)}.", BAD_USAGE)
    report = progress or (lambda what, fraction: None)
    # avrdude waits for ever for a port that is not there, and breaks into one that is in use.
    open_serial(port, BAUD, read_wait_s=0.0).close()
    if hex_file is not None:
        _upload_hex(port, BOARDS[board], Path(hex_file), report)
    else:
        _build_and_upload(port, BOARDS[board], _firmware(firmware_dir), report)
    report("greeting the firmware", 0.0)
    with Device(port) as device:
        hello = device.hello
    if hello.board is not BOARDS[board].identity:
        raise UserError(
            f"{port}: flashed for {board}, but the firmware says it was built for {hello.board.description}; "
            "give a HEX file that was built for this board."
        )
    return hello


def _firmware(named: str | Path | None) -> Path:
    """The firmware's source tree: the one named, or that of the checkout this package runs from."""
    folder = Path(named) if named is not None else Path(__file__).resolve().parents[5] / "firmware"
    if not (folder / "platformio.ini").is_file():
        where = f"{folder} holds no platformio.ini" if named is not None else "the firmware's source is not installed"
        raise UserError(
            f"{where}; name the firmware folder of a checkout with --firmware, or a file with --hex.", BAD_USAGE
        )
    return folder


def _build_and_upload(port: str, board: FlashBoard, firmware: Path, report: Progress) -> None:
    pio = [
        sys.executable,
        "-m",
        "platformio",
        "run",
        "--project-dir",
        str(firmware),
        "--environment",
        board.environment,
    ]
    environment = platformio_environment(firmware)
    # Built first and on its own: a board is not touched before there is something to put on it.
    run_tool(Tool("PlatformIO's build", pio, environment, _BUILD_LIMIT_S), lambda text: report("building", 0.0))
    if len(board.bauds) > 1:
        # PlatformIO knows one speed a board.
        _upload_hex(port, board, _build_folder(firmware, environment) / board.environment / "firmware.hex", report)
        return
    upload = [*pio, "--target", "upload", "--upload-port", port]
    run_tool(Tool("the upload", upload, environment, _UPLOAD_LIMIT_S), _avrdude_progress(port, report))


def platformio_environment(firmware: Path) -> dict[str, str]:
    """Environment for PlatformIO, with the project's own core folder where the set-up assembled one."""
    environment = dict(os.environ)
    environment["PLATFORMIO_SETTING_ENABLE_TELEMETRY"] = "no"
    environment["PLATFORMIO_DISABLE_UPGRADE_CHECK"] = "true"
    environment["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), environment.get("PATH", os.defpath)])
    core = firmware.resolve().parent / "build" / "platformio"
    if (core / "assembled").exists():
        environment["PLATFORMIO_CORE_DIR"] = str(core)
    return environment


def _build_folder(firmware: Path, environment: dict[str, str]) -> Path:
    """Where PlatformIO builds, which its environment variables may move."""
    if "PLATFORMIO_BUILD_DIR" in environment:
        return Path(environment["PLATFORMIO_BUILD_DIR"])
    return Path(environment.get("PLATFORMIO_WORKSPACE_DIR", firmware / ".pio")) / "build"


def _upload_hex(port: str, board: FlashBoard, file: Path, report: Progress) -> None:
    if not file.is_file():
        raise UserError(f"{file}: there is no such file; build one with `pio run`, or leave --hex out.", BAD_USAGE)
    command = [*_avrdude(), "-c", board.programmer, "-p", board.part, "-P", port, "-D", "-U", f"flash:w:{file}:i"]
    report("looking for the bootloader", 0.0)
    baud = board.bauds[0] if len(board.bauds) == 1 else find_speed(port, board.bauds)
    tool = Tool("avrdude", [*command, "-b", str(baud)], dict(os.environ), _UPLOAD_LIMIT_S)
    run_tool(tool, _avrdude_progress(port, report))


def _avrdude() -> list[str]:
    """avrdude as the system has it, else as PlatformIO has fetched it, which needs its own configuration file named."""
    found = shutil.which("avrdude")
    if found is not None:
        return [found]
    core = os.environ.get("PLATFORMIO_CORE_DIR") or Path.home() / ".platformio"
    package = Path(core) / "packages" / "tool-avrdude"
    for program in (package / "bin" / "avrdude", package / "avrdude"):
        if program.is_file():
            return [str(program), "-C", str(package / "avrdude.conf")]
    raise UserError("avrdude is not installed; install it, for example with `sudo apt-get install avrdude`.")


def _avrdude_progress(port: str, report: Progress) -> Callable[[str], None]:
    """Turns avrdude's rows of # into fractions; PlatformIO passes them on. avrdude itself never notices a lost port."""
    has_path = os.path.exists(port)  # a port of Windows has none

    def look(text: str) -> None:
        if has_path and not os.path.exists(port):
            raise UserError(f"{port} went away while it was being flashed; connect the board and flash it again.")
        for verb, stage in (("Writing", "writing"), ("Reading", "verifying")):
            rows = re.findall(rf"{verb} \| (#*)", text)
            if rows:
                report(stage, min(1.0, len(rows[-1]) / 50))

    return look
