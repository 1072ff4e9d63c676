"""`greywhale compare` as people and scripts meet it."""

from __future__ import annotations

import contextlib
import json
import os
import select
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from greywhale.cli import entry
from greywhale_paper.cli import compare as verb
from tests.support.interrupts import ctrl_c_at
from tests.support.sentences import names

Captured = pytest.CaptureFixture[str]
QUICK = ("compare", "--functions", "sphere,ackley", "--methods", "gwo, de", "--dimensions", "3", "--seeds", "3")
BUDGET = ("--budget", "40")


def test_text_tables_and_files(capsys: Captured, tmp_path: Path) -> None:
    table, picture = tmp_path / "r.csv", tmp_path / "r.png"
    assert entry.run([*QUICK, *BUDGET, "--out", str(table), "--out", str(picture), "--seed", "5"]) == 0
    out = capsys.readouterr().out
    assert "shifted: median of the lowest costs of 3 runs, 3 dimensions, 40 evaluations" in out
    assert "On shifted functions, by mean rank:" in out
    assert f"Written: {table}" in out
    assert table.read_text(encoding="utf-8").count("\n") == 1 + 2 * 2 * 2 * 3
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "things"),
    [
        (("--budget", "many"), "--budget many integer"),
        (("--functions", ","), "no function sphere"),
        (("--results", "r.csv", "--out", "r.csv"), "r.csv results file elsewhere"),
        (("--scheduler", "tcp://10.0.0.5:8786"), "tcp://10.0.0.5:8786 machine"),
        (("--out", "r.txt"), "r.txt .csv .png .svg .pdf"),
    ],
)
def test_bad_usage_is_one_sentence_and_code_2(
    capsys: Captured, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], things: str
) -> None:
    monkeypatch.chdir(tmp_path)
    assert entry.run(["compare", *arguments]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert names(captured.err, things)
    assert captured.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


# `greywhale`, which says of each process of its own that it has begun.
TELLING = """
import os, runpy
from multiprocessing import util
begin = util.spawnv_passfds
def tell(*command):
    number = begin(*command)
    os.write(1, b"begun\\n")
    return number
util.spawnv_passfds = tell
runpy.run_module("greywhale", run_name="__main__", alter_sys=True)
"""


# Interrupted while only the first process of the three has started, and with all of them there.
@pytest.mark.slow
@pytest.mark.parametrize("started", [1, 3])
def test_interrupt_ends_all_processes_and_writes_nothing(tmp_path: Path, started: int) -> None:
    command = [sys.executable, "-c", TELLING, "-q", "compare", "--budget", "2000", "--seeds", "500", "--jobs", "2"]
    running = subprocess.Popen(
        [*command, "--methods", "pso", "--out", "r.csv"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )
    try:
        assert running.stdout is not None
        for _ in range(started):  # of multiprocessing's resource tracker and two workers
            assert running.stdout.readline() == b"begun\n"
        children = Path(f"/proc/{running.pid}/task/{running.pid}/children").read_text().split()
        assert len(children) >= started
        ends = [os.pidfd_open(int(child)) for child in children]
        os.killpg(running.pid, signal.SIGINT)
        out, err = running.communicate(timeout=120)
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(running.pid, signal.SIGKILL)
    assert running.returncode == 130
    assert out == b"begun\n" * (len(out) // 6)
    assert err.strip() == b"greywhale: interrupted."
    for end in ends:
        assert select.select([end], [], [], 60)[0], "a process of the comparison is still there"
        os.close(end)
    assert list(tmp_path.iterdir()) == []


def test_an_interrupted_comparison_goes_on_from_its_results_file(
    tmp_path: Path, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    """To the same answer as without a break; with other options the file is refused."""
    results = tmp_path / "gwo.study"
    kept = (*QUICK, *BUDGET, "--workers", "1", "--json", "--results", str(results))
    with monkeypatch.context() as patch:
        patch.setattr(verb, "progress", lambda: contextlib.nullcontext(ctrl_c_at("", beyond=0.49)))
        assert entry.run([*kept]) == 130
    said = capsys.readouterr()
    told = json.loads(said.out)["error"]
    assert said.err.strip() == f"greywhale: {told}"
    assert told == f"interrupted. 4 of 8 tasks are done and kept in {results}; with it the same study goes on."
    assert results.read_bytes().count(b"\n") == 1 + 4
    assert entry.run([*kept]) == 0
    resumed = capsys.readouterr().out
    assert results.read_bytes().count(b"\n") == 1 + 8
    assert entry.run([*kept, "--seed", "1"]) == 1
    assert f"{results}: the results file is of another study: its seed is 0, now it is 1; " in capsys.readouterr().err
    assert entry.run([*QUICK, *BUDGET, "--json"]) == 0
    assert capsys.readouterr().out == resumed
