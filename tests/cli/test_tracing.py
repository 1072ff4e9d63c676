"""-v, -vv and --log-file: what a command does, for a person and for a report of a bug; and what Tab offers."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.shell_completion import ShellComplete

from greywhale.cli import entry
from greywhale.cli.tracing import LINE, ROOT
from greywhale.cli.verbs import greywhale
from tests.board.fake_board import FakeBoard

Captured = pytest.CaptureFixture[str]


def test_verbose_tells_the_steps_on_stderr_and_leaves_stdout_alone(capsys: Captured, tmp_path: Path) -> None:
    with FakeBoard() as board:
        arguments = ["params", "backup", str(tmp_path / "b.toml"), "--port", board.port, "--json", "--overwrite"]
        assert entry.run(["-v", *arguments]) == 0
        said = capsys.readouterr()
        assert entry.run(["-vv", *arguments]) == 0
        more = capsys.readouterr()
    assert json.loads(said.out)["file"] == str(tmp_path / "b.toml")
    assert f"greywhale.board.device: {board.port}: mega2560, firmware 0.1.0" in said.err
    assert f"{tmp_path / 'b.toml'}: written" in said.err
    assert "param_get" not in said.err
    assert "param_get, attempt 1 of 5: " in more.err
    assert "param_get answered: " in more.err


@pytest.mark.parametrize("options", [[], ["--log-file", "bug.log"]], ids=["plain", "file"])
def test_a_warning_always_reaches_the_terminal(
    options: list[str], capsys: Captured, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def warn() -> list[object]:
        ROOT.getChild("any").warning("mind this.")
        return []

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("greywhale.cli.ports.find_ports", warn)
    assert entry.run([*options, "ports"]) == 0
    assert capsys.readouterr().err == "greywhale: mind this.\n"


def test_the_log_file_holds_versions_requests_and_where_it_failed(capsys: Captured, tmp_path: Path) -> None:
    log = tmp_path / "bug.log"
    with FakeBoard() as board:
        assert entry.run(["--log-file", str(log), "info", "--port", board.port]) == 0
    assert entry.run(["--log-file", str(log), "evaluate", "none.csv"]) == 1
    assert capsys.readouterr().err == "greywhale: none.csv: cannot be read: no such file or directory.\n"
    lines = log.read_bytes().splitlines()
    assert [line for line in lines if not LINE.match(line) and b"command:" in line] == []
    text = log.read_text(encoding="utf-8")
    for words in (
        f"command: greywhale --log-file {log} info --port ",
        "greywhale 0.1.0, Python ",
        "packages: click ",
        "hello answered: ",
        "exit code 0 after ",
        "failed: none.csv: cannot be read",
        "Traceback",
        "evaluate.py",
        "exit code 1 after ",
    ):
        assert words in text, words
    assert ROOT.handlers == []


@pytest.mark.parametrize(
    ("name", "words"),
    [("none/bug.log", "cannot be written: no such file or directory"), ("log.csv", "this is no log of --log-file")],
)
def test_a_file_that_will_not_do_is_refused(name: str, words: str, capsys: Captured, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("time_s,leader_0\n")
    assert entry.run(["--log-file", str(tmp_path / name), "ports"]) == 2
    assert words in capsys.readouterr().err
    assert (tmp_path / "log.csv").read_text() == "time_s,leader_0\n"


def complete(words: str) -> list[str]:
    """As Bash asks: the words so far, and the number of the one to complete."""
    *before, last = words.split()
    completion = ShellComplete(greywhale, {}, "greywhale", "_GREYWHALE_COMPLETE")
    return [item.value for item in completion.get_completions(before[1:], last) if item.type == "plain"]


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("greywhale com", ["commission", "compare"]),
        ("greywhale params set joint0.k", ["joint0.kp=", "joint0.kd=", "joint0.ki=", "joint0.ku_mv="]),
        ("greywhale params get supply", ["supply_mv"]),
        ("greywhale commission --arm gre", ["grey_box"]),
        ("greywhale upload bef", ["before_tuning"]),
        ("greywhale record --ena", ["--enable"]),
    ],
)
def test_tab_completes(words: str, offered: list[str]) -> None:
    assert complete(words) == offered


def test_a_shell_gets_its_script() -> None:
    command = [sys.executable, "-c", "from greywhale.__main__ import main; main()"]
    done = subprocess.run(command, env=os.environ | {"_GREYWHALE_COMPLETE": "bash_source"}, capture_output=True)
    assert b"_greywhale_completion" in done.stdout
