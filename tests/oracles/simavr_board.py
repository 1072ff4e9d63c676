"""A simulated board whose instructions are decoded and executed by simavr 1.6: the board's own models, another CPU.

Debian's libsimavr-dev is linked with the sources of sim/board, whose cpu.cpp gives way to simavr/cpu.cpp.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import subprocess
import tempfile
from collections.abc import Iterable
from pathlib import Path

from tools import ROOT
from tools.setup import stamps

HERE = Path(__file__).parent / "simavr"
BOARD = ROOT / "sim" / "board"
REPLACED = {"binding.cpp", "cpu.cpp"}
COMPILE = ["g++", "-std=c++17", "-O1", "-shared", "-fPIC", "-Wall", "-Wextra", "-Werror", f"-I{BOARD}"]
SIMAVR = Path("/usr/include/simavr")
KEPT = ROOT / "build" / "oracles"
ROOM = 1 << 16  # for bytes that were sent


def build() -> ctypes.CDLL:
    """Load the board with simavr's CPU, as it was made of these files and commands; else make it first."""
    sources = [*(one for one in sorted(BOARD.glob("*.cpp")) if one.name not in REPLACED), *sorted(HERE.glob("*.cpp"))]
    command = [*COMPILE, "-isystem", str(SIMAVR), *map(str, sources), "-lsimavr"]
    theirs = hashlib.sha256(b"".join(path.read_bytes() for path in sorted(SIMAVR.rglob("*.h")))).hexdigest()
    compiler = subprocess.run([COMPILE[0], "--version"], capture_output=True, text=True, check=True).stdout
    made_of = stamps.digest(stamps.files_below("sim", "tests/oracles/simavr"), *command, theirs, compiler)
    library = KEPT / f"simavr_board-{made_of[:16]}.so"
    if not library.exists():
        KEPT.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=KEPT) as folder:  # another worker may do the same now
            done = subprocess.run([*command, "-o", f"{folder}/new.so"], capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stderr
            os.replace(f"{folder}/new.so", library)
        for old in set(KEPT.glob("simavr_board-*.so")) - {library}:
            old.unlink(missing_ok=True)
    calls = ctypes.CDLL(str(library))
    calls.simavr_new.restype = ctypes.c_void_p
    for name in ("cycle", "trace_hash"):
        getattr(calls, f"simavr_{name}").restype = ctypes.c_uint64
    for name in ("pc", "family", "uart_receive"):
        getattr(calls, f"simavr_{name}").restype = ctypes.c_uint32
    return calls


class SimavrBoard:
    """The part of greywhale._native.Board that the comparisons use."""

    def __init__(self, calls: ctypes.CDLL, chip: str) -> None:
        self._calls = calls
        self._self = ctypes.c_void_p(calls.simavr_new(chip.encode()))
        self._flash_bytes = {"atmega2560": 0x40000, "atmega328p": 0x8000}[chip]

    def __del__(self) -> None:
        self._calls.simavr_delete(self._self)

    @property
    def family(self) -> int:
        return int(self._calls.simavr_family(self._self))

    def write_program(self, pieces: Iterable[tuple[int, bytes]], name: str, bootloader: bool = False) -> None:
        assert not bootloader, name
        for address, data in pieces:
            self._calls.simavr_write(self._self, address, data, len(data))

    def flash(self) -> bytes:
        seen = ctypes.create_string_buffer(self._flash_bytes)
        self._calls.simavr_flash(self._self, seen)
        return seen.raw

    def power_on(self, seed: int) -> None:
        self._calls.simavr_power_on(self._self, ctypes.c_uint64(seed))

    def poke(self, address: int, data: bytes) -> None:
        self._calls.simavr_poke(self._self, address, data, len(data))

    def peek(self, address: int, count: int) -> bytes:
        seen = ctypes.create_string_buffer(count)
        self._calls.simavr_peek(self._self, address, seen, count)
        return seen.raw

    def run_until(self, cycle: int) -> int:
        return int(self._calls.simavr_run_until(self._self, ctypes.c_uint64(cycle)))

    @property
    def cycle(self) -> int:
        return int(self._calls.simavr_cycle(self._self))

    @property
    def pc(self) -> int:
        return int(self._calls.simavr_pc(self._self))

    @pc.setter
    def pc(self, address: int) -> None:
        self._calls.simavr_set_pc(self._self, address)

    @property
    def trace_hash(self) -> int:
        return int(self._calls.simavr_trace_hash(self._self))

    def uart_receive(self) -> bytes:
        sent = ctypes.create_string_buffer(ROOM)
        count = self._calls.simavr_uart_receive(self._self, sent, ROOM)
        assert count <= ROOM
        return sent.raw[:count]
