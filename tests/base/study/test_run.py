"""A study gives the same on every executor and goes on from what is done. Ctrl-C and its processes: tests/optimise."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.base.study import LocalWorkers, SerialWorkers, Task, TaskFailed, run_study
from tests.base.study import jobs

SOME = jobs.draws(6)


@pytest.fixture(scope="module")
def serial() -> dict[str, Any]:
    return run_study(SOME, SerialWorkers())


def same(one: dict[str, Any], other: dict[str, Any]) -> bool:
    """Bit for bit, in the same order."""
    np.testing.assert_equal(one, other)
    bits = [
        [np.array(run["odd"]).tobytes() + run["values"].tobytes() for run in study.values()] for study in (one, other)
    ]
    return list(one) == list(other) and bits[0] == bits[1]


def test_results_come_back_bit_for_bit(serial: dict[str, Any]) -> None:
    assert list(serial) == [task.key for task in SOME]
    for task in SOME:
        direct = jobs.draw(seed=task.seed, **task.arguments)
        direct["odd"] = list(direct["odd"])
        np.testing.assert_equal(serial[task.key], direct)
        assert serial[task.key]["values"].tobytes() == direct["values"].tobytes()


def test_threads_change_nothing(serial: dict[str, Any]) -> None:
    with ThreadPoolExecutor(3) as threads:
        assert same(run_study(SOME, threads), serial)
        assert threads.submit(int).result() == 0, "an executor that was given is still open"


@pytest.mark.slow
def test_processes_change_nothing(serial: dict[str, Any]) -> None:
    assert same(run_study(SOME, LocalWorkers(2)), serial)


def test_a_finished_study_is_not_done_again(tmp_path: Path) -> None:
    tasks = jobs.notes(4, tmp_path)
    shares: list[float] = []
    first = run_study(tasks, SerialWorkers(), tmp_path / "r", lambda what, share: shares.append(share))
    assert shares == [0.0, 0.25, 0.5, 0.75, 1.0]
    content = (tmp_path / "r").read_bytes()
    told: list[tuple[str, float]] = []
    again = run_study(tasks, SerialWorkers(), tmp_path / "r", lambda *one: told.append(one), what="noting")
    assert again == first == {f"note {seed}": seed * seed for seed in range(4)}
    assert told == [("noting", 1.0)]
    assert jobs.done(tmp_path) == [0, 1, 2, 3]
    assert (tmp_path / "r").read_bytes() == content


@pytest.mark.slow
def test_a_lost_worker_ends_the_study_which_goes_on_from_what_is_done(tmp_path: Path) -> None:
    notes = jobs.notes(3, tmp_path)
    deadly = [*notes, Task("last", jobs.die_first, 0, {"folder": str(tmp_path)})]
    with pytest.raises(UserError, match=r"a worker ended .* its task is among 'last'\. Start .* again") as lost:
        run_study(deadly, LocalWorkers(1), tmp_path / "r")
    assert lost.value.__notes__ == [
        f"3 of 4 tasks are done and kept in {tmp_path / 'r'}; with it the same study goes on."
    ]
    assert run_study(deadly, LocalWorkers(1), tmp_path / "r") == {"note 0": 0, "note 1": 1, "note 2": 4, "last": 0}
    assert jobs.done(tmp_path) == [0, 1, 2]


# --- errors of a task -----------------------------------------------------------------------------------------------


@pytest.fixture(params=["serial", pytest.param("processes", marks=pytest.mark.slow)])
def workers(request: pytest.FixtureRequest) -> SerialWorkers | LocalWorkers:
    return SerialWorkers() if request.param == "serial" else LocalWorkers(1)


def test_an_error_of_a_task_is_told_with_the_workers_traceback(
    workers: SerialWorkers | LocalWorkers, tmp_path: Path
) -> None:
    with pytest.raises(TaskFailed, match=r"task 'bad': KeyError: 'seed 7'\nTraceback[^$]*in fail\n") as failed:
        run_study(
            [*jobs.notes(2, tmp_path), Task("bad", jobs.fail, 7), Task("never", jobs.note, 9)], workers, tmp_path / "r"
        )
    assert failed.value.__notes__ == [
        f"2 of 4 tasks are done and kept in {tmp_path / 'r'}; with it the same study goes on."
    ]
    assert jobs.done(tmp_path) == [0, 1]


def test_a_user_error_of_a_task_stays_one(workers: SerialWorkers | LocalWorkers) -> None:
    with pytest.raises(UserError, match=r"^seed 1 is refused\.") as refused:
        run_study([Task("other", jobs.refuse, 1)], workers)
    assert (refused.value.message, refused.value.exit_code) == ("seed 1 is refused.", 2)
    assert refused.value.__notes__ == ["(In task 'other'.)"]


def test_a_task_that_leaves_the_interpreter_fails(workers: SerialWorkers | LocalWorkers) -> None:
    with pytest.raises(TaskFailed, match="task 'gone': SystemExit: 3"):
        run_study([Task("gone", jobs.leave, 0)], workers)


def test_a_result_that_is_not_plain_fails() -> None:
    with pytest.raises(TaskFailed, match="task 'odd': TypeError: a object is not plain"):
        run_study([Task("odd", jobs.strange, 0)], SerialWorkers())


def test_two_tasks_with_one_key_are_refused() -> None:
    with pytest.raises(ValueError, match="2 tasks have the key 'draw 1'"):
        run_study([*SOME, SOME[1]], SerialWorkers())
