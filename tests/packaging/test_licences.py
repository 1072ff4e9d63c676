"""Every file has a licence, the GPL stays where libsimavr is linked, and the texts are where people look for them."""

from __future__ import annotations

import subprocess
import sys

import pytest

from tools import ROOT

REUSE = [sys.executable, "-m", "reuse", "--root", str(ROOT)]


def run_reuse(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*REUSE, *arguments], capture_output=True, text=True, check=False)


@pytest.mark.slow
def test_no_file_is_without_a_licence() -> None:
    answer = run_reuse("lint", "--lines")
    assert answer.returncode == 0, answer.stdout + answer.stderr


@pytest.mark.slow
def test_the_gpl_covers_the_simulated_board_and_the_bench_and_nothing_else() -> None:
    files: dict[str, str] = {}
    name = ""
    for line in run_reuse("spdx").stdout.splitlines():
        key, _, value = line.partition(": ")
        if key == "FileName":
            name = value.removeprefix("./")
        elif key == "LicenseInfoInFile":
            files[name] = value
    under_gpl = {name for name, licence in files.items() if licence == "GPL-3.0-or-later"}
    bench = {name for name in files if name.startswith("sim/") and not name.startswith("sim/arm/")}
    assert under_gpl == bench
    assert "sim/board/board.cpp" in bench
    assert {files[name] for name in files.keys() - under_gpl} == {"Apache-2.0"}
    assert len(files) > 500


def test_the_texts_are_the_same_where_pip_and_where_reuse_look() -> None:
    assert (ROOT / "LICENSE").read_bytes() == (ROOT / "LICENSES" / "Apache-2.0.txt").read_bytes()
    assert (ROOT / "sim" / "LICENSE").read_bytes() == (ROOT / "LICENSES" / "GPL-3.0-or-later.txt").read_bytes()
