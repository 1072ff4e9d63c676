"""The attacks' programs in C++: the firmware's rooms on the fake board, and those who attack them.

A program is built when its sources have changed, in build/attack/native. What was not used for a week goes.
"""

from __future__ import annotations

import fcntl
import hashlib
import subprocess
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tools import ROOT

SOURCES = ROOT / "firmware/test/attack"
BUILT = ROOT / "build/attack/native"
WEEK_S = 7 * 86_400
WARNINGS = ("-std=c++14", "-Wall", "-Wextra", "-Wconversion", "-Werror")
FAST = ("g++", "-O2", *WARNINGS)
WATCHED = ("clang++", "-O2", "-gline-tables-only", "-fno-sanitize-recover=all", *WARNINGS)  # and sanitizers
# What the parameter sets need of the firmware.
ROOMS_OF_SETS = (
    "params/src/params/*.cpp app/src/parameter_sets.cpp app/src/controllers.cpp fuzzy_pdi/src/*.cpp hal/src/fake/*.cpp"
)


@dataclass(frozen=True)
class Program:
    """`parts` are files of firmware/test/attack without .cpp; those of the firmware come with them."""

    name: str
    parts: tuple[str, ...]
    command: tuple[str, ...]  # the compiler and its options
    rooms: str = "*/src/**/*.cpp"  # what is compiled of the firmware
    firmware: Path = ROOT / "firmware/lib"  # another one in tests that break it


def depends(*programs: Program) -> tuple[str, ...]:
    """The files and folders that the results of these programs depend on, for a part."""
    own = {*SOURCES.glob("*.h"), *(SOURCES / f"{part}.cpp" for program in programs for part in program.parts)}
    return ("firmware/lib", "tools/attack/native.py", *sorted(str(file.relative_to(ROOT)) for file in own))


def _sources(program: Program) -> list[Path]:
    patterns = program.rooms.split()
    rooms = sorted({file for pattern in patterns for file in program.firmware.glob(pattern)})
    assert rooms, program.rooms
    return [
        *(room for room in rooms if room.parent.name != "avr"),
        *(SOURCES / f"{part}.cpp" for part in program.parts),
    ]


def _digest(*contents: object) -> str:
    total = hashlib.sha256()
    for content in contents:
        total.update(content.read_bytes() if isinstance(content, Path) else repr(content).encode())
    return total.hexdigest()[:16]


def _compile(source: Path, contents: str, command: Sequence[str]) -> Path:
    """The object file of a source, made if need be. `contents` stands for all else that it depends on."""
    path = BUILT / "objects" / f"{source.stem}-{_digest(source, contents)}.o"
    if not path.exists():
        half = path.with_suffix(".part")
        subprocess.run([*command, "-c", str(source), "-o", str(half)], check=True)
        half.rename(path)
    path.touch()
    return path


def _forget_old() -> None:
    for file in BUILT.rglob("*"):
        if file.is_file() and time.time() - file.stat().st_mtime > WEEK_S:
            file.unlink()


def build(program: Program) -> Path:
    """The program, made if need be. One process makes programs while others wait.

    subprocess.CalledProcessError when it does not compile.
    """
    (BUILT / "objects").mkdir(parents=True, exist_ok=True)
    rooms = [f"-I{room / 'src'}" for room in sorted(program.firmware.iterdir())]
    headers = _digest(*sorted(program.firmware.rglob("*.h")), *sorted(SOURCES.glob("*.h")))
    path = BUILT / f"{program.name}-{_digest(*_sources(program), headers, program.command)}"
    with (BUILT / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not path.exists():
            _forget_old()
            objects = [
                str(_compile(source, _digest(headers, program.command), [*program.command, *rooms, f"-I{SOURCES}"]))
                for source in _sources(program)
            ]
            half = path.with_suffix(".part")
            subprocess.run([*program.command, *objects, "-o", str(half)], check=True)
            half.rename(path)
        path.touch()
    return path


def run_counts(program: Program, arguments: Sequence[object]) -> dict[str, int]:
    """Run a program that prints lines of a name and a number."""
    command = [str(build(program)), *map(str, arguments)]
    text = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
    return {name: int(value) for name, _, value in (line.rpartition(" ") for line in text.splitlines())}
