"""The arm's equations run on vectors of candidates too: lane by lane the same bits as one arm alone."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

HERE = Path(__file__).parent
ARM = HERE.parents[1] / "sim" / "arm"


@pytest.mark.slow
def test_vector_of_arms_equals_single_arms(tmp_path: Path) -> None:
    program = tmp_path / "lanes"
    build = ["g++", "-std=gnu++17", "-O1", "-Wall", "-Wextra", "-Werror", "-Wno-psabi", "-ffp-contract=off", f"-I{ARM}"]
    subprocess.run([*build, str(HERE / "lanes.cpp"), "-o", str(program)], check=True)
    result = subprocess.run([str(program)], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout
