"""The results file: another study's is refused in a sentence.

What damages and locks it is refused as in every file of checked lines: tests/base/formats/test_checked_lines.py.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from greywhale.base.errors import UserError
from greywhale.base.study import SerialWorkers, Task, run_study
from tests.base.study import jobs

ABOUT = {"budget": 500, "methods": ["de", "pso"]}
TASKS = jobs.draws(2)


def written(path: Path) -> bytes:
    run_study(TASKS, SerialWorkers(), path, about=ABOUT)
    return path.read_bytes()


@pytest.mark.parametrize(
    ("tasks", "about", "sentence"),
    [
        (TASKS, {**ABOUT, "budget": 600}, "its budget is 500, now it is 600; give the same again, or name another"),
        (TASKS, {}, "its budget is 500, now it is not given;"),
        (jobs.draws(3), ABOUT, "its number of tasks is 2, now it is 3;"),
        ([TASKS[0], Task("draw 1", jobs.draw, 1, {"count": 42})], ABOUT, "its list of tasks is"),
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
