"""The native unit tests of the core under the address and undefined-behaviour sanitizers."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

FIRMWARE = Path(__file__).parents[2] / "firmware"
SOURCES = FIRMWARE / "lib/fuzzy_pdi/src"
INCLUDES = [f"-I{SOURCES}", f"-I{FIRMWARE}/lib/codes/src"]
TESTS = FIRMWARE / "test/native"
WARNINGS = ["-Wall", "-Wextra", "-Wconversion", "-Werror"]
SANITIZERS = ["-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all", "-O0", "-g"]


@pytest.mark.slow
def test_no_complaint(tmp_path: Path) -> None:
    program, runner = tmp_path / "tests", tmp_path / "main.o"
    # The runner is most of the text to compile; the sanitizers watch the core and its tests.
    subprocess.run(["g++", "-std=c++14", "-O0", "-c", str(TESTS / "main.cpp"), "-o", str(runner)], check=True)
    sources = [*SOURCES.glob("*.cpp"), *(TESTS / "test_fuzzy_pdi").glob("*.cpp"), runner]
    command = ["g++", "-std=c++14", *WARNINGS, *SANITIZERS, *INCLUDES, *map(str, sources), "-o", str(program)]
    subprocess.run(command, check=True)
    result = subprocess.run([str(program), "--success=false"], capture_output=True, text=True, timeout=250, check=False)
    assert result.returncode == 0, result.stderr[-4000:]
    assert "[doctest]" in result.stdout
