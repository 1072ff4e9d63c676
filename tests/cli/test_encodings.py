"""Output of a verb arrives in any encoding that a terminal may have; a mark stands for what the encoding lacks."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.example_log import write_log

pytestmark = pytest.mark.slow
ENCODINGS = ["iso8859-2", "cp1250", "cp1251", "cp932", "gbk", "euc_jp"]


def run(*arguments: str, **environment: str) -> subprocess.CompletedProcess[bytes]:
    command = [sys.executable, "-m", "greywhale", *arguments]
    return subprocess.run(command, env={**os.environ, **environment}, capture_output=True, check=False)


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A log, and what evaluate prints of it, with square signs, where the encoding has everything."""
    log = tmp_path_factory.mktemp("log") / "log.csv"
    write_log(log)
    text = run("evaluate", str(log), PYTHONIOENCODING="utf-8").stdout.decode()
    assert "²" in text
    return log, text


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_a_report_is_whole_but_for_marks(report: tuple[Path, str], encoding: str) -> None:
    log, text = report
    done = run("evaluate", str(log), PYTHONIOENCODING=encoding)
    assert (done.returncode, done.stderr) == (0, b"")
    assert done.stdout == text.encode(encoding, "replace")


@pytest.mark.parametrize("encoding", ["ascii", *ENCODINGS])
def test_a_failure_that_names_a_file_is_a_sentence(tmp_path: Path, encoding: str) -> None:
    done = run("evaluate", str(tmp_path / "Größe² \u4e2d.csv"), PYTHONIOENCODING=encoding)
    assert done.returncode == 1
    assert done.stderr.startswith(b"greywhale: ")
    assert b"Traceback" not in done.stderr
