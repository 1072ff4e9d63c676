"""Studies on a real Dask scheduler by TLS: the same bits as here, whoever is lost, and nobody else may answer."""

from __future__ import annotations

import os
import signal
import sysconfig
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from dask import config as dask_config

from greywhale.base.errors import UserError
from greywhale.base.study import ClusterWorkers, SerialWorkers, Task, TaskFailed, cluster, run_study
from greywhale.cli import entry
from tests.base.study import jobs
from tests.oracles import dask_cluster
from tests.oracles.dask_cluster import Cluster, certify, cluster_of

COMPARE = ("compare", "--json", "--functions", "sphere,ackley", "--methods", "gwo,de", "--dimensions", "3")


@pytest.fixture(autouse=True)
def patience(monkeypatch: pytest.MonkeyPatch) -> None:
    """A busy machine may take long to answer; only who waits for nobody is impatient."""
    monkeypatch.setattr(cluster, "ANSWER_S", 60.0)


@pytest.fixture(scope="module")
def ours(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, str]]:
    settings = certify(tmp_path_factory.mktemp("tls") / "ours")
    with dask_config.set(settings):
        yield settings


@pytest.fixture(scope="module")
def two(ours: dict[str, str]) -> Iterator[Cluster]:
    with cluster_of(2, ours) as running:
        yield running


def test_a_comparison_is_the_same_byte_for_byte_as_here(two: Cluster, capsys: pytest.CaptureFixture[str]) -> None:
    said = []
    for where in (("--workers", "1"), ("--scheduler", two.address)):
        assert entry.run([*COMPARE, "--budget", "40", "--seeds", "10", *where]) == 0
        said.append(capsys.readouterr().out)
    assert said[0] == said[1]


def test_errors_of_tasks_come_back_with_the_tasks_name(two: Cluster, tmp_path: Path) -> None:
    with pytest.raises(TaskFailed, match=r"task 'bad': KeyError: 'seed 7'\nTraceback"):
        run_study([*jobs.notes(2, tmp_path), Task("bad", jobs.fail, 7)], ClusterWorkers(two.address))
    with pytest.raises(UserError, match=r"seed 1 is refused\.") as refused:
        run_study([Task("other", jobs.refuse, 1)], ClusterWorkers(two.address))
    assert (refused.value.exit_code, refused.value.__notes__) == (2, ["(In task 'other'.)"])


def test_only_holders_of_the_authoritys_certificates_are_answered(
    two: Cluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "ANSWER_S", 1.0)
    with dask_config.set(certify(tmp_path / "others")):
        with pytest.raises(UserError, match=rf"^no Dask scheduler answers at {two.address}; .* of the same authority"):
            run_study(jobs.draws(1), ClusterWorkers(two.address))
    plain = two.address.replace("tls:", "tcp:")
    with pytest.raises(UserError, match=rf"^no Dask scheduler answers at {plain}; start one there, or give"):
        run_study(jobs.draws(1), ClusterWorkers(plain))


def test_certificates_that_are_missing_or_damaged_are_named(ours: dict[str, str], tmp_path: Path) -> None:
    nothing = dict.fromkeys(ours)
    with dask_config.set(nothing), pytest.raises(UserError, match=r"tls:// needs certificates; name ca-file and"):
        ClusterWorkers("tls://10.0.0.5:8786")
    settings, key = certify(tmp_path / "ours"), tmp_path / "ours" / "key.pem"
    key.unlink()
    with dask_config.set(settings), pytest.raises(UserError, match=r"key\.pem\) cannot be used: no such file"):
        ClusterWorkers("tls://10.0.0.5:8786")
    key.write_text("no key")
    with dask_config.set(settings), pytest.raises(UserError, match=r"key\.pem\) cannot be used: they are no PEM"):
        ClusterWorkers("tls://10.0.0.5:8786")


# --- who is lost ----------------------------------------------------------------------------------------------------


def test_a_killed_worker_changes_no_bit(ours: dict[str, str], tmp_path: Path) -> None:
    """The first of two workers that begins the task in the middle is killed with it in its hands."""
    os.mkfifo(tmp_path / "who")
    hanging = Task("draw 5", dask_cluster.hang_first, 5, {"folder": str(tmp_path), "count": 45})
    here = jobs.draws(12)
    there = [hanging if task.seed == 5 else task for task in here]
    killer = threading.Thread(target=lambda: os.kill(int((tmp_path / "who").read_text()), signal.SIGKILL))
    killer.start()
    with cluster_of(2, ours) as running:
        found = run_study(there, ClusterWorkers(running.address))
        killer.join()
        assert sorted(worker.poll() is None for worker in running.workers) == [False, True]
    serial = run_study(here, SerialWorkers())
    assert list(found) == list(serial)
    np.testing.assert_equal(found, serial)
    assert [one["values"].tobytes() for one in found.values()] == [one["values"].tobytes() for one in serial.values()]


def test_ctrl_c_takes_back_what_was_sent_and_keeps_what_is_done(ours: dict[str, str], tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "who")
    notes = jobs.notes(5, tmp_path)
    tasks = [notes[0], Task("long", dask_cluster.hang_first, 3, {"folder": str(tmp_path), "count": 5}), *notes[1:]]

    def interrupt(what: str, share: float) -> None:
        if share > 0:
            (tmp_path / "who").read_text()  # the only worker has the long task, and the others wait
            raise KeyboardInterrupt

    with cluster_of(1, ours) as running:
        with pytest.raises(KeyboardInterrupt) as interrupted:
            run_study(tasks, ClusterWorkers(running.address), tmp_path / "r", interrupt)
        assert interrupted.value.__notes__ == [
            f"1 of 6 tasks are done and kept in {tmp_path / 'r'}; with it the same study goes on."
        ]
        assert running.workers[0].poll() is None, "the worker is not ours to end"
        running.workers[0].kill()
        running.add_workers(1)
        run_study(jobs.draws(3), ClusterWorkers(running.address))
    assert jobs.done(tmp_path) == [0], "nobody did what was taken back"
    assert list(run_study(tasks, SerialWorkers(), tmp_path / "r")) == [task.key for task in tasks]


def test_a_scheduler_that_goes_away_ends_the_study_with_a_sentence(
    ours: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "ANSWER_S", 5.0)  # it is asked for again so long
    os.mkfifo(tmp_path / "who")
    long = Task("long", dask_cluster.hang_first, 3, {"folder": str(tmp_path), "count": 5})
    with cluster_of(1, ours) as running:

        def end(what: str, share: float) -> None:
            if share > 0:
                (tmp_path / "who").read_text()
                running.scheduler.kill()

        with pytest.raises(UserError, match=r"^the scheduler of the workers went away; start it and the study again\."):
            run_study([*jobs.notes(1, tmp_path), long], ClusterWorkers(running.address), tmp_path / "r", end)
    assert list(run_study([*jobs.notes(1, tmp_path), long], SerialWorkers(), tmp_path / "r")) == ["note 0", "long"]
    assert jobs.done(tmp_path) == [0]


def test_a_task_that_ends_its_workers_is_named(ours: dict[str, str], tmp_path: Path) -> None:
    """With a scheduler that gives a task up after its first lost worker."""
    with cluster_of(1, ours, DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES="0") as running:
        with pytest.raises(UserError, match="^one worker after the other ended with the task in its hands;") as lost:
            run_study([Task("deadly", dask_cluster.die, 0)], ClusterWorkers(running.address))
    assert lost.value.__notes__ == ["(In task 'deadly'.)"]


# --- workers who would give other bits, or none ---------------------------------------------------------------------


def test_unlike_workers_refuse_and_none_is_told(
    ours: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for package in Path(sysconfig.get_path("purelib")).iterdir():
        if "greywhale" not in package.name:
            (tmp_path / package.name).symlink_to(package)
    with cluster_of(0, ours) as running:
        workers = ClusterWorkers(running.address)
        for python, environment, sentence in (
            (
                ("-S",),
                {"PYTHONPATH": str(tmp_path)},
                r"a worker cannot import .*: No module named 'greywhale'; install",
            ),
            ((), {"OPENBLAS_CORETYPE": "Nehalem"}, r"a worker's processor or C library rounds otherwise than this"),
        ):
            running.add_workers(1, *python, **environment)
            with pytest.raises(UserError, match=f"^{sentence}"):
                run_study(jobs.draws(1), workers)
            running.workers.pop().kill()
        monkeypatch.setattr(cluster, "WORKER_S", 0.1)
        with pytest.raises(
            UserError, match=rf"^the Dask scheduler at {running.address} has no worker; start some: dask"
        ):
            run_study(jobs.draws(1), workers)
