"""The test suite itself: it does the same however it is started, and two of its workers do not meet."""

from __future__ import annotations

import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from greywhale.runtime import runtime_directory
from tests.conftest import LONGEST

ROOT = Path(__file__).parents[2]
HEARD = (signal.SIGINT, signal.SIGHUP)

CHILD = """
import signal
print(*(int(signal.getsignal(number) == signal.SIG_IGN) for number in (signal.SIGINT, signal.SIGHUP)))
"""


def test_a_child_hears_signals() -> None:
    done = subprocess.run([sys.executable, "-c", CHILD], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["0", "0"]


def ignore_signals() -> None:
    for number in HEARD:
        signal.signal(number, signal.SIG_IGN)


@pytest.mark.slow
@pytest.mark.parametrize("options", [(), ("-n", "1")], ids=["alone", "worker"])
def test_a_suite_that_ignores_signals_has_children_that_hear_them(options: tuple[str, ...]) -> None:
    """As `nohup make test` and a script's background job start it."""
    test = f"{Path(__file__).relative_to(ROOT)}::{test_a_child_hears_signals.__name__}"
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *options, test]
    done = subprocess.run(
        command, cwd=ROOT, preexec_fn=ignore_signals, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    assert done.returncode == 0, done.stdout
    assert "1 passed" in done.stdout


def test_benches_of_this_session_are_out_of_sight_of_others(tmp_path_factory: pytest.TempPathFactory) -> None:
    ours = tmp_path_factory.getbasetemp()
    assert runtime_directory().is_relative_to(ours)
    ask = [sys.executable, "-c", "import tempfile; print(tempfile.gettempdir())"]
    assert subprocess.run(ask, capture_output=True, text=True, check=True).stdout.strip() == tempfile.gettempdir()


def test_the_rooms_that_workers_begin_with_are_there() -> None:
    assert all((ROOT / "tests" / room).is_dir() for room in LONGEST)
