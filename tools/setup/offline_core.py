"""Assembles a PlatformIO core folder from Debian's packages, for where PlatformIO's own registry cannot be reached.

`python -m tools.setup.offline_core FOLDER`, with the Python that has PlatformIO. An ordinary platformio.ini then
builds and tests with PLATFORMIO_CORE_DIR=FOLDER, and uploads where an avrdude is on the PATH. The folder is made anew
each time.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

from platformio.dependencies import get_core_dependencies
from platformio.package.version import get_original_version

SCRIPTS = Path(__file__).parent / "platform"
ARDUINO = Path("/usr/share/arduino/hardware/arduino/avr")
PLATFORM_VERSION = "5.1.0"
FINISHED = "assembled"  # this file says that the folder is whole
# PlatformIO's board id -> (boards.txt's board, the entry of its cpu menu)
BOARDS = {
    "megaatmega2560": ("mega", "atmega2560"),
    "nanoatmega328": ("nano", "atmega328old"),
    "nanoatmega328new": ("nano", "atmega328"),
    "uno": ("uno", ""),
}


def read_properties(path: Path) -> dict[str, str]:
    """The `key=value` lines of boards.txt."""
    lines = (line.strip() for line in path.read_text(encoding="utf-8").splitlines())
    pairs = (line.partition("=") for line in lines if "=" in line and not line.startswith("#"))
    return {key.strip(): value.strip() for key, _, value in pairs}


def describe(board_id: str, properties: dict[str, str]) -> dict[str, object]:
    """One board in PlatformIO's form; a menu's entry wins over the board's own."""
    name, menu = BOARDS[board_id]

    def get(key: str) -> str:
        return properties.get(f"{name}.menu.cpu.{menu}.{key}") or properties[f"{name}.{key}"]

    return {
        "name": " ".join(filter(None, (properties[f"{name}.name"], menu))),
        "vendor": "Arduino",
        "url": "https://www.arduino.cc",
        "frameworks": ["arduino"],
        "build": {
            "core": get("build.core"),
            "variant": get("build.variant"),
            "mcu": get("build.mcu"),
            "f_cpu": get("build.f_cpu"),
            "extra_flags": f"-DARDUINO_{get('build.board')}",
        },
        "upload": {
            "protocol": get("upload.protocol"),
            "speed": int(get("upload.speed")),
            "maximum_size": int(get("upload.maximum_size")),
            "maximum_ram_size": int(get("upload.maximum_data_size")),
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
    write_json(folder / "package.json", {"name": name, "version": version, "description": f"{name} from Debian"})
    register(folder, "tool", name, version)
    return folder


def link(target: Path, place: Path) -> None:
    if not target.exists():
        raise SystemExit(f"{target} is missing: install its Debian package, `make setup` knows which.")
    place.parent.mkdir(parents=True, exist_ok=True)
    place.symlink_to(target)


def wanted_version(tool: str) -> str:
    """The lowest version of a tool that this PlatformIO accepts."""
    return str(get_core_dependencies()[tool]).lstrip("~^=")


def add_scons(core: Path) -> None:
    version = wanted_version("tool-scons")
    folder = new_tool(core, "tool-scons", version)
    package = f"scons=={get_original_version(version)}"
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", str(folder), package]
    subprocess.run(pip, check=True)
    shutil.copy(SCRIPTS / "scons.py", folder / "scons.py")


def add_tools(core: Path) -> None:
    toolchain = new_tool(core, "toolchain-atmelavr", "1.50400.0")
    link(Path("/usr/lib/avr"), toolchain / "avr")
    link(Path("/usr/lib/gcc/avr"), toolchain / "lib/gcc/avr")
    framework = new_tool(core, "framework-arduino-avr", "5.1.0")
    for part in ("cores", "variants", "libraries"):
        link(ARDUINO / part, framework / part)


def new_platform(core: Path, name: str, main_script: str, **fields: object) -> Path:
    folder = core / "platforms" / name
    (folder / "builder").mkdir(parents=True)
    shutil.copy(SCRIPTS / main_script, folder / "builder/main.py")
    manifest = {"name": name, "title": name, "description": f"{name} with Debian's compilers"}
    version = f"{PLATFORM_VERSION}+debian"
    engines = {"platformio": "^6"}
    write_json(folder / "platform.json", {**manifest, "version": version, "engines": engines, **fields})
    register(folder, "platform", name, version)
    return folder


def add_platforms(core: Path) -> None:
    new_platform(core, "native", "native_main.py", packages={})
    packages = {
        "toolchain-atmelavr": {"type": "toolchain", "owner": "platformio", "version": "*"},
        "framework-arduino-avr": {
            "type": "framework",
            "owner": "platformio",
            "version": "*",
            "optional": True,
        },
    }
    frameworks = {"arduino": {"package": "framework-arduino-avr", "script": "builder/arduino.py"}}
    folder = new_platform(core, "atmelavr", "avr_main.py", packages=packages, frameworks=frameworks)
    shutil.copy(SCRIPTS / "avr_arduino.py", folder / "builder/arduino.py")
    properties = read_properties(ARDUINO / "boards.txt")
    (folder / "boards").mkdir()
    for board_id in BOARDS:
        write_json(folder / f"boards/{board_id}.json", describe(board_id, properties))


def assemble(core: Path) -> None:
    """Build the folder aside and move it into place whole."""
    fresh = core.with_name(core.name + ".new")
    shutil.rmtree(fresh, ignore_errors=True)
    fresh.mkdir(parents=True)
    add_scons(fresh)
    add_tools(fresh)
    add_platforms(fresh)
    (fresh / FINISHED).touch()
    shutil.rmtree(core, ignore_errors=True)
    fresh.rename(core)


if __name__ == "__main__":
    assemble(Path(sys.argv[1]).resolve())
