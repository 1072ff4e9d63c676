"""A study gives the same on every executor and after every kill; in whatever order its tasks end: test_any_order."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import select
import signal
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.base.study import LocalWorkers, LostTasks, SerialWorkers, Task, TaskFailed, run_study
from tests.base.study import jobs
from tools import ROOT

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
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        assert same(run_study(SOME, pool), serial)


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


def test_no_tasks_give_no_results(tmp_path: Path) -> None:
    assert run_study([], SerialWorkers(), tmp_path / "r") == {}


# --- lost workers ---------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_what_a_killed_process_had_is_done_again(tmp_path: Path, serial: dict[str, Any]) -> None:
    killer = jobs.kill_who_hangs(tmp_path)
    hanging = Task("draw 2", jobs.hang_first, 2, {"folder": str(tmp_path), "count": 42})
    found = run_study([hanging if task.seed == 2 else task for task in SOME], LocalWorkers(2))
    killer.join()
    assert same(found, serial)


@pytest.mark.slow
def test_a_task_that_kills_three_workers_is_given_up_and_no_other(tmp_path: Path) -> None:
    others = jobs.notes(5, tmp_path)
    tasks = [*others[:2], Task("deadly", jobs.die, 0), *others[2:]]
    told = r"task 'deadly' was given up, because every worker that did it ended"
    with pytest.raises(LostTasks, match=told) as lost:
        run_study(tasks, LocalWorkers(2), tmp_path / "r")
    assert lost.value.results == {f"note {seed}": seed * seed for seed in range(5)}
    assert list(lost.value.results) == [task.key for task in others]
    assert lost.value.__notes__ == [
        f"5 of 6 tasks are done and kept in {tmp_path / 'r'}; with it the same study goes on."
    ]
    assert set(jobs.done(tmp_path)) == set(range(5))


@pytest.mark.slow
def test_workers_that_all_end_at_once_are_not_made_for_ever() -> None:
    with pytest.raises(UserError, match=r"3 times all workers ended before any task was done\."):
        run_study([Task(f"deadly {n}", jobs.die, n) for n in range(50)], LocalWorkers(2))


@pytest.mark.slow
def test_a_given_executor_that_breaks_ends_the_study_with_a_sentence() -> None:
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        with pytest.raises(UserError, match="the workers were lost, and this study cannot make new ones"):
            run_study([Task("deadly", jobs.die, 0)], pool)


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


# --- interrupted ----------------------------------------------------------------------------------------------------

SCRIPT = """
import sys
from pathlib import Path
from greywhale.base.study import choose_workers, run_study
from tests.base.study import jobs
if __name__ == "__main__":
    folder, count = Path(sys.argv[1]), int(sys.argv[2])
    tasks = [*jobs.notes(3, folder), jobs.Task("long", jobs.hang_first, 3, {"folder": str(folder), "count": 5})]
    tasks += [jobs.Task(f"draw {seed}", jobs.draw, seed, {"count": 5}) for seed in range(3)]
    found = run_study(tasks, choose_workers(count), folder / "r", lambda *one: print(*one, flush=True))
    print(*found)
"""


def begin(folder: Path, count: int) -> subprocess.Popen[bytes]:
    (folder / "study.py").write_text(SCRIPT)
    return subprocess.Popen(
        [sys.executable, str(folder / "study.py"), str(folder), str(count)],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )


@pytest.mark.slow
@pytest.mark.parametrize(("number", "count"), [(signal.SIGINT, 1), (signal.SIGINT, 2), (signal.SIGKILL, 2)])
def test_an_interrupted_study_keeps_what_is_done_and_goes_on(
    tmp_path: Path, number: signal.Signals, count: int
) -> None:
    """SIGINT as from a terminal, to all processes of the study; SIGKILL to the first one alone."""
    os.mkfifo(tmp_path / "who")
    running = begin(tmp_path, count)
    ends = []
    try:
        (tmp_path / "who").read_text()  # now a task hangs
        assert running.stdout is not None
        kept = 3 if count == 1 else 6
        while f"working {kept / 7}\n".encode() not in running.stdout.readline():
            assert running.poll() is None
        children = Path(f"/proc/{running.pid}/task/{running.pid}/children").read_text().split()
        ends = [os.pidfd_open(int(child)) for child in children]
        if number == signal.SIGINT:
            os.killpg(running.pid, number)
        else:
            running.send_signal(number)
        _, errors = running.communicate(timeout=120)
    finally:
        with contextlib.suppress(ProcessLookupError):
            running.kill()
    for end in ends:
        assert select.select([end], [], [], 60)[0], "a process of the study is still there"
        os.close(end)
    assert running.returncode == -number
    if number == signal.SIGINT:
        assert errors.count(b"Traceback") == 1, "only the first process answers"
        assert f"{kept} of 7 tasks are done and kept in {tmp_path / 'r'}; with it".encode() in errors
    (tmp_path / "who").unlink()
    again = begin(tmp_path, count)
    out, errors = again.communicate(timeout=120)
    assert again.returncode == 0, errors
    assert out.splitlines()[0] == f"working {kept / 7}".encode()
    assert out.splitlines()[-1] == b"note 0 note 1 note 2 long draw 0 draw 1 draw 2"
    assert jobs.done(tmp_path) == [0, 1, 2]
