"""Programs that greywhale starts, and those that they start in turn, import nothing from the current folder."""

from __future__ import annotations

import multiprocessing
import os
import sys
from pathlib import Path

import pytest

from greywhale.base.processes import safe_path, start
from tests.support.strangers import plant, ran

# Imports a module of Python's, and has another Python do so.
TWICE = "import csv, subprocess, sys; subprocess.run([sys.executable, '-c', 'import csv'], check=True)"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    plant(tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("PYTHONSAFEPATH", raising=False)
    return tmp_path


@pytest.mark.parametrize("environment", [None, dict(os.environ)])
def test_a_program_and_its_programs_import_nothing_from_here(folder: Path, environment: dict[str, str] | None) -> None:
    with start([sys.executable, "-c", TWICE], environment) as process:
        assert process.wait() == 0
    assert ran(folder) == set()


def test_pythonpath_is_the_users_own_choice(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mine = folder / "mine"
    mine.mkdir()
    (mine / "only_mine.py").touch()
    monkeypatch.setenv("PYTHONPATH", str(mine))
    with start([sys.executable, "-c", "import only_mine"]) as process:
        assert process.wait() == 0


def test_processes_of_multiprocessing_import_nothing_from_here(folder: Path) -> None:
    """Neither its resource tracker: each of both is a Python of its own."""
    context = multiprocessing.get_context("spawn")
    with safe_path():
        process = context.Process(target=abs, args=(1,))
        process.start()
    process.join()
    assert process.exitcode == 0
    assert ran(folder) == set()


@pytest.mark.parametrize("before", [None, "", "x"])
def test_the_environment_is_afterwards_as_it_was(before: str | None, monkeypatch: pytest.MonkeyPatch) -> None:
    if before is None:
        monkeypatch.delenv("PYTHONSAFEPATH", raising=False)
    else:
        monkeypatch.setenv("PYTHONSAFEPATH", before)
    with pytest.raises(KeyError), safe_path():
        assert os.environ["PYTHONSAFEPATH"] == "1"
        raise KeyError
    assert os.environ.get("PYTHONSAFEPATH") == before
