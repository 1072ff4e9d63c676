"""Compiles the small AVR programs of these tests and puts them on boards."""

from __future__ import annotations

import hashlib
import subprocess
from pathlib import Path

import pytest

from tests.simulated_board.avr import PRELUDE, Compile, MakeProgram, Program
from tools import avr_tool


@pytest.fixture(scope="session")
def compile_avr(tmp_path_factory: pytest.TempPathFactory) -> Compile:
    folder = tmp_path_factory.mktemp("avr")

    def compile_source(source: str, chip: str) -> Path:
        key = hashlib.sha256(f"{chip}\n{source}".encode()).hexdigest()[:16]
        program = folder / f"{key}.elf"
        if not program.exists():
            code = folder / f"{key}.c"
            code.write_text(PRELUDE + source)
            command = [
                avr_tool("avr-gcc"),
                f"-mmcu={chip}",
                "-Os",
                "-std=gnu11",
                "-Wall",
                "-o",
                str(program),
                str(code),
            ]
            result = subprocess.run(command, capture_output=True, text=True, check=False)
            assert result.returncode == 0, result.stderr
        return program

    return compile_source


@pytest.fixture
def program(compile_avr: Compile) -> MakeProgram:
    def make(source: str, chip: str = "atmega2560") -> Program:
        return Program(compile_avr(source, chip), chip)

    return make
