"""Makes PlatformIO's board descriptions from the Arduino core's boards.txt."""

from __future__ import annotations

from pathlib import Path

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
