"""Studies on a real Dask scheduler with two workers, one of which is killed; and who may answer there."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import sysconfig
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from dask import config as dask_config

from greywhale.base.errors import UserError
from greywhale.base.study import (
    DaskWorkers,
    LocalWorkers,
    LostTasks,
    SerialWorkers,
    Task,
    TaskFailed,
    choose_workers,
    run_study,
)
from tests.base.study import jobs
from tests.base.study.cluster import begin_worker, cluster_of, end, wait_for
from tools import ROOT


@pytest.mark.slow
def test_a_killed_dask_worker_changes_no_bit(tmp_path: Path) -> None:
    """The first of two workers that begins the task in the middle is killed with it in its hands."""
    tasks = jobs.draws(12)
    serial = run_study(tasks, SerialWorkers())
    killer = jobs.kill_who_hangs(tmp_path)
    hanging = Task("draw 5", jobs.hang_first, 5, {"folder": str(tmp_path), "count": 45})
    with cluster_of(2) as cluster:
        there = [hanging if task.seed == 5 else task for task in tasks]
        dask = run_study(there, DaskWorkers(cluster.address), tmp_path / "r")
        killer.join()
        ended = [worker.wait(timeout=60) for worker in cluster.workers if worker.pid == jobs.killed(tmp_path)]
        assert ended == [-9]
    assert list(dask) == list(serial)
    np.testing.assert_equal(dask, serial)
    for key, found in dask.items():
        assert found["values"].tobytes() == serial[key]["values"].tobytes()
        assert np.array(found["odd"]).tobytes() == np.array(serial[key]["odd"]).tobytes()
    assert run_study(there, SerialWorkers(), tmp_path / "r").keys() == serial.keys(), "another executor goes on with it"


@pytest.mark.slow
def test_results_that_are_lost_with_their_worker_before_they_are_fetched_are_worked_out_again() -> None:
    tasks = jobs.draws(60)
    with cluster_of(2) as cluster:

        def kill_one(what: str, share: float) -> None:
            if share > 0.1:
                cluster.workers[0].kill()

        found = run_study(tasks, DaskWorkers(cluster.address), progress=kill_one)
    np.testing.assert_equal(found, run_study(tasks, SerialWorkers()))


@pytest.fixture(scope="module")
def dask() -> Iterator[DaskWorkers]:
    with cluster_of(1) as cluster:
        yield DaskWorkers(cluster.address)


@pytest.mark.slow
def test_errors_of_tasks_come_back_from_dask(dask: DaskWorkers, tmp_path: Path) -> None:
    with pytest.raises(TaskFailed, match=r"task 'bad': KeyError: 'seed 7'\nTraceback"):
        run_study([Task("bad", jobs.fail, 7)], dask)
    with pytest.raises(UserError, match="seed 1 is refused.") as refused:
        run_study([*jobs.notes(2, tmp_path), Task("other", jobs.refuse, 1)], dask, tmp_path / "r")
    assert refused.value.exit_code == 2


@pytest.mark.slow
def test_dask_gives_up_a_task_that_kills_its_workers_and_the_study_names_it(tmp_path: Path) -> None:
    """With a scheduler that gives a task up after its first lost worker: the study gives it a second chance, alone."""
    tasks = [*jobs.notes(3, tmp_path), Task("deadly", jobs.die, 0)]
    with cluster_of(3, DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES="0") as cluster:
        with pytest.raises(LostTasks, match="^task 'deadly' was given up") as lost:
            run_study(tasks, DaskWorkers(cluster.address))
        assert sum(worker.poll() is None for worker in cluster.workers) == 1
    assert lost.value.results == {f"note {seed}": seed * seed for seed in range(3)}


@pytest.mark.slow
def test_a_scheduler_that_goes_away_ends_the_study_with_a_sentence(tmp_path: Path) -> None:
    """What was done is kept, and another executor goes on with it."""
    os.mkfifo(tmp_path / "who")
    tasks = [*jobs.notes(2, tmp_path), Task("long", jobs.hang_first, 3, {"folder": str(tmp_path), "count": 5})]
    with cluster_of(1) as cluster:

        def go(what: str, share: float) -> None:
            if share == 2 / 3:
                (tmp_path / "who").read_text()  # the worker has the last task
                cluster.scheduler.kill()

        with pytest.raises(UserError, match=f"{cluster.address}: no Dask scheduler answers there") as error:
            run_study(tasks, DaskWorkers(cluster.address, wait_s=1.0), tmp_path / "r", go)
    assert error.value.__notes__ == [
        f"2 of 3 tasks are done and kept in {tmp_path / 'r'}; with it the same study goes on."
    ]
    assert list(run_study(tasks, SerialWorkers(), tmp_path / "r")) == ["note 0", "note 1", "long"]
    assert jobs.done(tmp_path) == [0, 1]


SCRIPT = """
import sys, threading
from distributed import Future
from pathlib import Path
from greywhale.base.study import DaskWorkers, Task, run_study
from tests.base.study import jobs
answer = Future.result
def never_answer_while_closing(task, timeout=None):
    return threading.Event().wait() if task.status == "cancelled" else answer(task, timeout)
Future.result = never_answer_while_closing
folder = Path(sys.argv[1])
tasks = [*jobs.notes(2, folder), Task("long", jobs.hang_first, 3, {"folder": str(folder), "count": 5})]
run_study(tasks, DaskWorkers(sys.argv[2]), folder / "r", lambda *one: print(*one, flush=True))
"""


@pytest.mark.slow
def test_ctrl_c_leaves_a_dask_cluster_at_once_and_keeps_what_is_done(tmp_path: Path) -> None:
    """Dask's client may never answer a question that meets its end: here it never does."""
    os.mkfifo(tmp_path / "who")
    with cluster_of(1) as cluster:
        command = [sys.executable, "-c", SCRIPT, str(tmp_path), cluster.address]
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        running = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment)
        try:
            (tmp_path / "who").read_text()  # the worker has the task that never ends
            assert running.stdout is not None
            while f"working {2 / 3}\n".encode() != running.stdout.readline():
                assert running.poll() is None
            running.send_signal(signal.SIGINT)
            _, errors = running.communicate(timeout=60)
        finally:
            running.kill()
        assert running.returncode == -signal.SIGINT
        assert errors.count(b"Traceback") == 1, errors
        assert f"2 of 3 tasks are done and kept in {tmp_path / 'r'};".encode() in errors
        assert cluster.workers[0].poll() is None, "the worker is not ours to end"


def test_a_scheduler_that_is_not_there() -> None:
    with pytest.raises(UserError, match="^tcp://127.0.0.1:1: no Dask scheduler answers there; start one with"):
        run_study(jobs.draws(1), DaskWorkers("127.0.0.1:1", wait_s=1.0))


@pytest.mark.slow
def test_a_worker_without_greywhale_is_named_before_it_gets_a_task(tmp_path: Path) -> None:
    """It would end without a word when it gets one. Here it sees all packages of this environment but that one."""
    for entry in Path(sysconfig.get_path("purelib")).iterdir():
        if "greywhale" not in entry.name:
            (tmp_path / entry.name).symlink_to(entry)
    with cluster_of(0) as cluster:
        worker = begin_worker(cluster.address, python=["-S"], PYTHONPATH=str(tmp_path))
        try:
            wait_for(worker, "Registered to:")
            sentence = r"the worker tcp://\S+ has no greywhale; install greywhale \S+ there\."
            with pytest.raises(UserError, match=sentence):
                run_study(jobs.draws(1), DaskWorkers(cluster.address))
        finally:
            end(worker)


@pytest.mark.slow
def test_a_worker_that_cannot_import_a_task_says_so(dask: DaskWorkers, monkeypatch: pytest.MonkeyPatch) -> None:
    only_here = ModuleType("only_here")
    monkeypatch.setitem(sys.modules, "only_here", only_here)
    exec("def job(seed): return seed", vars(only_here))
    with pytest.raises(UserError, match="a worker cannot import what the study does: No module named 'only_here'"):
        run_study([Task("x", only_here.job, 0)], dask)


# --- who may answer -------------------------------------------------------------------------------------------------


def certify(folder: Path) -> dict[str, str]:
    """A certificate that has signed itself, as the authority too, and its key: Dask's settings for all three roles."""
    folder.mkdir()
    cert, key = str(folder / "cert.pem"), str(folder / "key.pem")
    kind = ["-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2", "-subj", "/CN=studies"]
    subprocess.run(["openssl", "req", "-x509", *kind, "-keyout", key, "-out", cert], check=True, capture_output=True)
    roles = {f"{role}.{what}": path for role in ROLES for what, path in (("cert", cert), ("key", key))}
    return {f"distributed.comm.tls.{name}": path for name, path in {"ca-file": cert, **roles}.items()}


ROLES = ("client", "scheduler", "worker")


def as_environment(settings: dict[str, str]) -> dict[str, str]:
    return {f"DASK_{name.replace('.', '__').replace('-', '_').upper()}": value for name, value in settings.items()}


@pytest.mark.slow
def test_a_scheduler_with_tls_answers_those_of_its_authority_alone(tmp_path: Path) -> None:
    ours, others = certify(tmp_path / "ours"), certify(tmp_path / "others")
    tasks = jobs.draws(3)
    with cluster_of(1, scheme="tls", **as_environment(ours)) as cluster:
        with dask_config.set(ours):
            found = run_study(tasks, choose_workers(f"tls://{cluster.address}"))
        np.testing.assert_equal(found, run_study(tasks, SerialWorkers()))
        with dask_config.set(others), pytest.raises(UserError, match="no Dask scheduler answers there"):
            run_study(tasks, DaskWorkers(cluster.address, wait_s=1.0, tls=True))
        with pytest.raises(UserError, match="no Dask scheduler answers there; .* With TLS both sides need"):
            run_study(tasks, DaskWorkers(cluster.address, wait_s=1.0))


@pytest.mark.parametrize("address", ["10.0.0.5:8786", "cluster.example:8786", "[fe80::1]:8786", "0.0.0.0:8786"])
def test_a_scheduler_elsewhere_is_refused_without_tls(address: str) -> None:
    with pytest.raises(UserError, match=rf"is not on this machine, .* take tls://{re.escape(address)} with") as refused:
        choose_workers(f"dask://{address}")
    assert refused.value.exit_code == 2


def test_tls_needs_certificates_that_can_be_read(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"tls:// needs certificates; name ca-file and client: cert in ~/\.config/dask"):
        choose_workers("tls://10.0.0.5:8786")
    settings = certify(tmp_path / "ours")
    (tmp_path / "ours" / "key.pem").unlink()
    with dask_config.set(settings), pytest.raises(UserError, match=r"key\.pem\) cannot be used: no such file"):
        choose_workers("tls://10.0.0.5:8786")
    (tmp_path / "ours" / "key.pem").write_text("no key")
    with dask_config.set(settings), pytest.raises(UserError, match=r"key\.pem\) cannot be used: they are no PEM"):
        choose_workers("tls://10.0.0.5:8786")


@pytest.mark.parametrize(
    ("executor", "count", "kind"),
    [
        ("local", 1, SerialWorkers),
        ("local", 2, LocalWorkers),
        ("local", None, LocalWorkers),
        ("dask://127.0.0.1:8786", None, DaskWorkers),
        ("dask://localhost:8786/", None, DaskWorkers),
        ("dask://[::1]:8786", None, DaskWorkers),
    ],
)
def test_the_options_of_a_verb_choose_the_workers(executor: str, count: int | None, kind: type) -> None:
    assert isinstance(choose_workers(executor, count), kind)


@pytest.mark.parametrize(
    ("executor", "count", "sentence"),
    [
        ("local", 0, "workers is 0, but it must be at least 1."),
        ("dask://host", None, "there is no executor 'dask://host'; it is local, dask://HOST:PORT (of this "),
        ("mpi", None, "there is no executor 'mpi'"),
        ("slurm://", None, "there is no executor 'slurm://'"),
        ("dask://localhost:1", 3, "--workers is for local; a Dask scheduler has its own."),
    ],
)
def test_other_options_are_refused(executor: str, count: int | None, sentence: str) -> None:
    with pytest.raises(UserError) as refused:
        choose_workers(executor, count)
    assert refused.value.message.startswith(sentence)
    assert refused.value.exit_code == 2


def test_a_missing_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(UserError, match=r"^distributed is not installed; pip install 'greywhale\[dask\]'\.$"):
        choose_workers("dask://localhost:1")
