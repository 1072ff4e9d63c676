"""Builds the firmware of both boards; for checks with the system's own avr-gcc as well."""

from __future__ import annotations

from pathlib import Path

from tools import BUILT_BY_SYSTEM, BUILT_FIRMWARE, ROOT
from tools.setup import platformio, stamps, venv
from tools.setup.console import run, say

BOARDS = ("megaatmega2560", "nanoatmega328")
SCRIPTS = ("firmware/image_record.py", "firmware/source_digest.py", "firmware/strict_warnings.py")
SOURCES = ("firmware/src", "firmware/lib", "firmware/platformio.ini", *SCRIPTS)


def build(name: str, core: Path, folder: Path, checks: bool, compiler: str) -> None:
    """Build both boards' images below a folder, if their sources have changed. For checks a warning is an error."""
    wanted = stamps.digest(stamps.files_below(*SOURCES, "tools/setup", "requirements.txt"), compiler)
    if stamps.is_current(name, wanted, checks) and all((folder / board / "firmware.hex").exists() for board in BOARDS):
        return
    say(f"building the firmware for {' and '.join(BOARDS)} with {compiler} (10 s)")
    command: list[str | Path] = [venv.PYTHON, "-m", "platformio", "run", "--project-dir", ROOT / "firmware"]
    for board in BOARDS:
        command += ["--environment", board]
    strict = {"GREYWHALE_WERROR": "1"} if checks else {}
    # Where it is the usual folder nothing may name it: PlatformIO empties a folder that was built with other settings.
    place = {} if folder == BUILT_FIRMWARE else {"PLATFORMIO_BUILD_DIR": str(folder)}
    run(command, what="Building the firmware", env={**platformio.environment(core), **place, **strict})
    stamps.set_current(name, wanted, checks)


def step(source: str, checks: bool) -> None:
    names = {"registry": "PlatformIO's avr-gcc", "pypi": "avr-gcc 7.3.0", "system": "the system's avr-gcc"}
    build("firmware", platformio.CORE, BUILT_FIRMWARE, checks, names[source])
    platformio.link_tools()
    if checks and source != "system":
        wanted = stamps.digest(stamps.files_below("tools/setup", "requirements.txt"))
        if not stamps.is_current("platformio-second", wanted):
            platformio.assemble(platformio.SYSTEM_CORE, "system")
            stamps.set_current("platformio-second", wanted)
        build("firmware-second", platformio.SYSTEM_CORE, BUILT_BY_SYSTEM, checks, names["system"])
