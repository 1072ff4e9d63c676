"""The library as others build it: its examples by arduino-builder for three boards, and all of it by `pio ci`."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from tools.library import NAME, write
from tools.setup import platformio, venv

ARDUINO = Path("/usr/share/arduino/hardware")
BUILDER = Path("/usr/share/arduino-builder")
# Debian's avr-libc lacks a name that the core wants.
CORE_FLAGS = "-prefs=compiler.cpp.extra_flags=-DDECIMAL_DIG=__DECIMAL_DIG__"
BOARDS = {"mega": "arduino:avr:mega:cpu=atmega2560", "nano": "arduino:avr:nano:cpu=atmega328", "uno": "arduino:avr:uno"}


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("libraries") / NAME
    write(folder, "https://example.org/greywhale-fuzzy.git")
    return folder


def build(library: Path, example: str, board: str, folder: Path) -> Path:
    """The linked program of an example; nothing of the library may warn."""
    command = ["arduino-builder", "-compile", "-warnings", "all", "-fqbn", BOARDS[board], CORE_FLAGS]
    command += ["-hardware", str(ARDUINO), "-hardware", str(BUILDER), "-tools", str(BUILDER)]
    command += ["-libraries", str(library.parent), "-build-path", str(folder)]
    sketch = library / "examples" / example / f"{example}.ino"
    done = subprocess.run([*command, str(sketch)], capture_output=True, text=True, check=True)
    assert not re.search(rf"({NAME}|{example})\S*:\d+:\d+: warning", done.stderr), done.stderr
    return folder / f"{example}.ino.elf"


@pytest.mark.parametrize("board", ["mega", "nano"])
def test_one_motor_has_no_heap_and_no_float(library: Path, tmp_path: Path, board: str) -> None:
    elf = build(library, "OneMotor", board, tmp_path)
    symbols = subprocess.run(["avr-nm", str(elf)], capture_output=True, text=True, check=True).stdout
    assert "fuzzy_pdi_step_error" in symbols
    assert re.findall(r" (malloc|free|_Znwj|__\w+sf\w*)$", symbols, re.MULTILINE) == []


def test_own_table_passes_its_self_test_on_a_board(library: Path, tmp_path: Path) -> None:
    elf = build(library, "OwnTable", "uno", tmp_path)
    command = [sys.executable, "-m", "greywhale_sim.run_elf", "--mcu", "atmega328p", "--limit-s", "0.1", str(elf)]
    told = subprocess.run(command, capture_output=True, text=True, check=False).stdout.splitlines()
    assert told[0] == "The self-test passed."
    rows = [int(line) for line in told[1:18]]
    assert len(rows) == 17
    assert rows == sorted(rows)
    assert [-row for row in reversed(rows)] == rows


def test_pio_ci(library: Path, tmp_path: Path) -> None:
    (tmp_path / "main.cpp").write_text(
        "#include <GreywhaleFuzzy.h>\nint main() { return greywhale::duty(1, 2) - 127; }\n"
    )
    (tmp_path / "platformio.ini").write_text("[env:native]\nplatform = native\nbuild_flags = -std=gnu++11 -Werror\n")
    command = [str(venv.PYTHON), "-m", "platformio", "ci", "main.cpp", "--lib", str(library)]
    command += ["--project-conf", "platformio.ini"]
    done = subprocess.run(
        command, cwd=tmp_path, env=platformio.full_environment(), capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "fuzzy_pdi/compile.o" in done.stdout
