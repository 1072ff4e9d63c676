"""The campaign's programs in C++: the firmware's rooms on the fake board, and those who attack them.

A program is built when its sources have changed, in build/campaign/native.
"""

from __future__ import annotations

import fcntl
import hashlib
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tools.campaign.journal import ROOT

SOURCES = ROOT / "firmware/test/campaign"
BUILT = ROOT / "build/campaign/native"
WARNINGS = ("-std=c++14", "-Wall", "-Wextra", "-Wconversion", "-Werror")
FAST = ("g++", "-O2", *WARNINGS)
WATCHED = ("clang++", "-O1", "-g", "-fno-sanitize-recover=all", *WARNINGS)  # and sanitizers
DEPENDS = ("firmware/lib", "firmware/test/campaign")


@dataclass(frozen=True)
class Program:
    """`parts` are files of firmware/test/campaign without .cpp; those of the firmware come with them."""

    name: str
    parts: tuple[str, ...]
    command: tuple[str, ...]  # the compiler and its options
    rooms: str = "*/src/**/*.cpp"  # what is compiled of the firmware
    firmware: Path = ROOT / "firmware/lib"  # another one in tests that break it


def _sources(program: Program) -> list[Path]:
    patterns = program.rooms.split()
    rooms = sorted({file for pattern in patterns for file in program.firmware.glob(pattern)})
    assert rooms, program.rooms
    return [
        *(room for room in rooms if room.parent.name != "avr"),
        *(SOURCES / f"{part}.cpp" for part in program.parts),
    ]


def _digest(program: Program) -> str:
    total = hashlib.sha256(repr(program.command).encode())
    headers = [*sorted(program.firmware.rglob("*.h")), *sorted(SOURCES.glob("*.h"))]
    for file in _sources(program) + headers:
        total.update(file.name.encode() + b"\0" + file.read_bytes() + b"\0")
    return total.hexdigest()[:16]


def build(program: Program) -> Path:
    """The program, made if need be. One process makes it while others wait.

    subprocess.CalledProcessError when it does not compile.
    """
    BUILT.mkdir(parents=True, exist_ok=True)
    path = BUILT / f"{program.name}-{_digest(program)}"
    with (BUILT / f"{program.name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not path.exists():
            rooms = [f"-I{room / 'src'}" for room in sorted(program.firmware.iterdir())]
            sources = map(str, _sources(program))
            half = path.with_suffix(".part")
            subprocess.run([*program.command, *rooms, f"-I{SOURCES}", *sources, "-o", str(half)], check=True)
            half.rename(path)
    return path


def run_counts(program: Program, arguments: Sequence[object]) -> dict[str, int]:
    """Run a program that prints lines of a name and a number."""
    command = [str(build(program)), *map(str, arguments)]
    text = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
    return {name: int(value) for name, _, value in (line.rpartition(" ") for line in text.splitlines())}
