"""The firmware's rooms keep to themselves: who may include whom, where registers are, which file knows the board."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

FIRMWARE = Path(__file__).resolve().parents[2] / "firmware"
LIB = FIRMWARE / "lib"
ALLOWED = {
    "codes": set[str](),
    "signal_chain": set[str](),
    "fuzzy_pdi": {"codes"},
    "hal": {"codes"},
    "link": {"codes"},
    "params": {"link"},
    "supervisor": {"codes", "signal_chain"},
    "app": {"fuzzy_pdi", "hal", "link", "params", "signal_chain", "supervisor"},
}
INCLUDE = re.compile(r'^\s*#include [<"]([^>"]+)[>"]', re.MULTILINE)


def sources(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.suffix in {".h", ".cpp", ".S", ".inc"})


def included(path: Path) -> list[str]:
    return INCLUDE.findall(path.read_text(encoding="utf-8"))


def rooms_of(path: Path) -> set[str]:
    """The rooms whose headers a file includes, but for files beside it."""
    away = [name for name in included(path) if not (path.parent / name).exists()]
    return {room for name in away for room in ALLOWED if (LIB / room / "src" / name).exists()}


def test_every_room_is_listed() -> None:
    assert {path.name for path in LIB.iterdir()} == set(ALLOWED)


@pytest.mark.parametrize("room", ALLOWED)
def test_a_room_includes_only_the_rooms_below_it(room: str) -> None:
    files = sources(LIB / room)
    assert files
    used = set[str]().union(*(rooms_of(path) for path in files)) - {room}
    assert used == ALLOWED[room]


def test_registers_are_reached_from_one_folder_only() -> None:
    registers = {"avr/io.h", "avr/interrupt.h", "avr/sleep.h", "avr/wdt.h"}
    outside = [path for path in sources(LIB) + sources(FIRMWARE / "src") if LIB / "hal/src/avr" not in path.parents]
    assert [path.name for path in outside if registers & set(included(path))] == []
    assert [path.name for path in sources(FIRMWARE / "src") if "asm" in path.read_text(encoding="utf-8")] == []


def test_one_file_knows_which_board_it_is_built_for() -> None:
    chip = re.compile(r"__AVR_ATmega\w+|\bUSART0?_\w+|ARDUINO_AVR_\w+")
    knowing = [path.name for path in sources(LIB) + sources(FIRMWARE / "src") if chip.search(path.read_text("utf-8"))]
    assert knowing == ["pins.h"]
