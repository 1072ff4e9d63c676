"""The results file: another study's is refused in a sentence, and so is a damaged one."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from greywhale.base.errors import UserError
from greywhale.base.study import SerialWorkers, Task, run_study
from greywhale.base.study.results import Results
from tests.base.study import jobs

ABOUT = {"budget": 500, "methods": ["de", "pso"]}
TASKS = jobs.draws(2)


def written(path: Path) -> bytes:
    run_study(TASKS, SerialWorkers(), path, about=ABOUT)
    return path.read_bytes()


@pytest.mark.parametrize(
    ("tasks", "about", "sentence"),
    [
        (
            TASKS,
            {**ABOUT, "budget": 600},
            "its budget is 500, now it is 600; give the same again, or name another file.",
        ),
        (TASKS, {}, "its budget is 500, now it is null;"),
        (jobs.draws(3), ABOUT, "its number of tasks is 2, now it is 3;"),
        (
            [TASKS[0], Task("draw 1", jobs.draw, 1, {"count": 42})],
            ABOUT,
            r"its list of tasks is \"\w+\", now it is \"\w+\";",
        ),
        ([TASKS[0], Task("draw 1", jobs.draw, 2, {"count": 41})], ABOUT, "its list of tasks is"),
        ([TASKS[0], Task("draw 1", jobs.note, 1, {"count": 41})], ABOUT, "its list of tasks is"),
        (TASKS[::-1], ABOUT, "its list of tasks is"),
    ],
)
def test_the_file_of_another_study_is_refused(
    tmp_path: Path, tasks: list[Task], about: dict[str, Any], sentence: str
) -> None:
    path = tmp_path / "r"
    whole = written(path)
    with pytest.raises(UserError, match=f"{path}: the results file is of another study: {sentence}"):
        run_study(tasks, SerialWorkers(), path, about=about)
    assert path.read_bytes() == whole


def test_the_file_of_another_version_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "r"
    written(path)
    other = {"greywhale": "9.9.9", "numpy": "1", "scipy": "1"}
    monkeypatch.setattr("greywhale.base.study.results.versions", lambda: other)
    with pytest.raises(UserError, match=r"its versions is .*, now it is {\"greywhale\": \"9\.9\.9\""):
        run_study(TASKS, SerialWorkers(), path, about=ABOUT)


@pytest.mark.parametrize(
    ("spoil", "sentence"),
    [
        (
            lambda lines: [b"time_s,leader_0", *lines[1:]],
            "line 1 is not a line of a study's results file; name another",
        ),
        (lambda lines: [b"a log without an end"], "line 1 is not a line of a study's results file; name another"),
        (lambda lines: [lines[0], lines[1].replace(b"seed 0", b"seed 1"), *lines[2:]], "line 2 is damaged; remove it"),
        (lambda lines: [lines[0], *lines[2:]], "line 2 is damaged; remove it and all lines after it, or name another"),
        (lambda lines: [*lines[:2], lines[1], *lines[2:]], "line 3 is damaged"),
        (lambda lines: [lines[0], b'{"task":3,"result":1}', *lines[1:]], "line 2 is not a line of a study's"),
    ],
)
def test_what_is_no_results_file_is_refused_and_left_alone(tmp_path: Path, spoil: Any, sentence: str) -> None:
    path = tmp_path / "r"
    path.write_bytes(b"\n".join(spoil(written(path).split(b"\n"))))
    before = path.read_bytes()
    with pytest.raises(UserError, match=f"{path}: {sentence}"):
        run_study(TASKS, SerialWorkers(), path, about=ABOUT)
    assert path.read_bytes() == before


def test_two_studies_cannot_have_one_file(tmp_path: Path) -> None:
    with Results(tmp_path / "r", TASKS, ABOUT):
        with pytest.raises(UserError, match="another greywhale is using this results file now"):
            run_study(TASKS, SerialWorkers(), tmp_path / "r", about=ABOUT)
    written(tmp_path / "r")


def test_a_full_disk_is_said_with_the_remedy(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="/dev/full: cannot be used as a results file: not an ordinary file"):
        run_study(TASKS, SerialWorkers(), Path("/dev/full"))
    with pytest.raises(UserError, match="cannot be used as a results file: no such file"):
        run_study(TASKS, SerialWorkers(), tmp_path / "none" / "r")


def test_lines_are_json(tmp_path: Path) -> None:
    heading, *results = (json.loads(line) for line in written(tmp_path / "r").splitlines())
    assert heading["request"]["budget"] == 500
    assert heading["request"]["number of tasks"] == 2
    assert [line["task"] for line in results] == ["draw 0", "draw 1"]
    assert results[1]["result"]["of"] == "seed 1"
