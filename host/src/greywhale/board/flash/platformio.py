"""Builds the firmware from its source tree with PlatformIO, where the last build is not of these sources."""

from __future__ import annotations

import importlib.util
import os
import runpy
import shutil
import sys
from pathlib import Path

from greywhale.base.errors import BadUsage, UserError
from greywhale.base.types import Progress
from greywhale.board.flash.images import Image, read_image
from greywhale.board.flash.runner import Tool, run_tool
from greywhale.board.flash.targets import FlashBoard

CHECKOUT = Path(__file__).resolve().parents[5] / "firmware"


def find_sources(named: str | Path | None) -> Path | None:
    """The firmware's source tree: the one named, else that of the checkout this package runs from, if it does."""
    if named is None:
        return CHECKOUT if (CHECKOUT / "platformio.ini").is_file() else None
    if not (Path(named) / "platformio.ini").is_file():
        raise BadUsage(
            f"{named} holds no platformio.ini; name the firmware folder of a checkout with --firmware, "
            "or a file with --hex."
        )
    return Path(named)


def build(firmware: Path, board: FlashBoard, report: Progress) -> Path:
    """Build for the board; the HEX file."""
    environment = platformio_environment(firmware)
    # In the firmware's folder: PlatformIO also obeys a platformio.ini of the folder that it runs in.
    command = [*_platformio(), "run", "--project-dir", str(firmware.resolve()), "--environment", board.environment]
    tool = Tool("PlatformIO's build", command, environment, firmware, limit_s=600.0)
    run_tool(tool, lambda: report("building", 0.0))
    return _build_folder(firmware, environment) / board.environment / "firmware.hex"


def last_build(firmware: Path, board: FlashBoard) -> Path | None:
    """The HEX file that was built last for the board; None where there is none."""
    built = _build_folder(firmware, platformio_environment(firmware)) / board.environment / "firmware.hex"
    return built if built.is_file() else None


def current_build(firmware: Path, board: FlashBoard) -> Image | None:
    """The image that was built last for the board, if its record names these very sources; None where it does not.

    Whoever gives PlatformIO settings may want another build of the same sources.
    """
    built = last_build(firmware, board)
    if built is None or any(name.startswith("PLATFORMIO_") for name in os.environ):
        return None
    try:
        image = read_image(built)
    except BadUsage:  # a build that was interrupted
        return None
    return image if image.record is not None and image.record.sources == _source_digest(firmware) else None


def _source_digest(firmware: Path) -> str:
    """The digest that a build of this source tree would put into its image."""
    return str(runpy.run_path(str(firmware / "source_digest.py"))["source_digest"](firmware))


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


def _platformio() -> list[str]:
    """PlatformIO as a package of this Python, else as a program of the system."""
    if importlib.util.find_spec("platformio") is not None:
        return [sys.executable, "-m", "platformio"]
    found = shutil.which("platformio")
    if found is None:
        raise UserError(
            "PlatformIO, which builds the firmware from its source, is not installed; "
            "run `pip install 'greywhale[build]'`, or name a file with --hex."
        )
    return [found]


def _build_folder(firmware: Path, environment: dict[str, str]) -> Path:
    """The folder in which PlatformIO builds, which its environment variables may move."""
    if "PLATFORMIO_BUILD_DIR" in environment:
        return Path(environment["PLATFORMIO_BUILD_DIR"])
    return Path(environment.get("PLATFORMIO_WORKSPACE_DIR", firmware / ".pio")) / "build"
