"""A bench, the files that pages call yours, and long computations that are done once."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import greywhale.cli.story
import greywhale.commission
from greywhale.arm.export import urdf
from greywhale.base import bench_process
from greywhale.board.device import Device
from greywhale.cli import flash as flash_verb
from greywhale.cli import identify as identify_verb
from greywhale.cli import tune as tune_verb
from greywhale.cli.story import DemoOptions
from greywhale.commission import CommissioningRequest
from greywhale.dashboard import server as dashboard_server
from greywhale.files import parameter_file
from greywhale.files.arm import content_of, default_arm, load_arm
from greywhale.files.exchange.npz import write as export_npz
from greywhale.files.exchange.recording import ExportOptions, Recording
from greywhale.files.leader import save_leader
from greywhale.files.log import LogWriter, read_log
from greywhale.files.log.layout import Origin
from greywhale.files.trajectory import Trajectory
from greywhale.fuzzy import load_joints
from greywhale.fuzzy.export_fis import export_fis
from greywhale.identify import identify
from greywhale.loop import human_reaches
from greywhale.loop.leader_motions import poses
from greywhale.protocol.schema import HelloReply
from greywhale.protocol.table import ParameterTable
from greywhale.tune import tune
from greywhale.tune.limits import WITHOUT_FLOORS
from greywhale.tune.model import load_model
from greywhale_paper import run as reproduce_run
from greywhale_paper.pages import report as reproduce_report
from greywhale_paper.pages.document import Document
from greywhale_paper.request import Request
from greywhale_sim import serve as bench_serve
from greywhale_sim.lockstep import LockStepBench
from greywhale_sim.words import lock_step
from tests.commission.simulated import in_no_time
from tests.docs.running import Once, run
from tests.support.demo import in_this_process
from tests.tune.models import write_model
from tools import ROOT
from tools.support.recordings import TABLES, random_arm, record, table_of
from tools.support.simulated_rig import SimulatedRig

IMAGE = ROOT / "firmware" / ".pio" / "build" / "megaatmega2560"
LOGS = ("log1", "log2", "log3", "log", "before", "after")


@pytest.fixture(scope="module")
def bench() -> Iterator[LockStepBench]:
    """One bench for all tests of a file; the environment names its port, so that no command has to."""
    with lock_step() as running:
        yield running


@pytest.fixture(scope="session")
def yours(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with what the pages call yours: arms, logs, a motion, tables, an image."""
    folder = tmp_path_factory.mktemp("yours")
    for seed, name in enumerate(("fit", "second")):
        reaches = human_reaches(seed, 6.0)
        shoulder_alone = replace(reaches, angles=reaches.angles * (np.arange(4) == 1))
        record(random_arm(2), shoulder_alone, folder / f"{name}.csv", table_of("before_tuning"), seed)
    visits = poses(np.full(4, -0.4), np.full(4, 0.4), 2)
    for name, sag in (("plain", 0.0), ("loaded", 0.01)):
        with LogWriter(folder / f"{name}.csv", Origin(param_crc=1, period_ms=1, every_ticks=10)) as log:
            for time_s, angles in zip(times := np.arange(0.0, visits.duration_s, 0.01), visits.at(times), strict=True):
                log.append(float(time_s), angles.tolist(), (angles - sag).tolist(), [0.0] * 4, "following")
    for name in LOGS:
        shutil.copy(folder / "fit.csv", folder / f"{name}.csv")
    export_npz([Recording(read_log(folder / "log.csv"))], folder / "log.npz", ExportOptions())
    rows = "".join(f"{20 * row},{row % 7},{row % 5},{row % 3}\n" for row in range(200))
    (folder / "theirs.csv").write_text(f"t,goal,q1,u\n{rows}", encoding="utf-8")
    (folder / "arm.toml").write_bytes(content_of("default"))
    (folder / "arm.urdf").write_text(urdf(load_arm("default")), encoding="utf-8")
    write_model(folder / "model.toml")
    for name in ("controller.toml", "table.toml"):
        shutil.copy(TABLES / "table_10.toml", folder / name)
    export_fis(
        folder / "sets.fis", "sets", {name: float(v) for name, v in load_joints("table_9")[0].set_values().items()}
    )
    parameter_file.save(folder / "board.toml", ParameterTable.defaults())
    times = np.arange(0.0, 2.0, 0.02)
    save_leader(folder / "motion.csv", Trajectory(times, 0.1 * np.sin(3.0 * times)[:, None] * np.ones(4)))
    page = (ROOT / "docs" / "your-arm.md").read_text(encoding="utf-8")
    (folder / "answers.toml").write_text(page.partition("```toml\n")[2].partition("```")[0], encoding="utf-8")
    for name in ("firmware.hex", "firmware.elf"):
        shutil.copy(IMAGE / name, folder / name)
    return folder


@pytest.fixture
def scratch(yours: Path, bench: LockStepBench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of it to work in."""
    for path in yours.iterdir():
        if path.is_file():
            shutil.copy(path, tmp_path)
    (tmp_path / "shared").symlink_to(ROOT / "shared")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("GREYWHALE_PORT", bench.port)
    return tmp_path


@pytest.fixture
def fresh_board(bench: LockStepBench, yours: Path) -> None:
    """The bench's board with the parameters that it came with."""
    done = run(["params", "restore", str(yours / "board.toml"), "--port", bench.port])
    assert done.code == 0, done.err


@pytest.fixture(scope="session")
def identified(yours: Path) -> Once:
    """A model of six seconds of log in which the shoulder alone moves."""
    fit, second = (read_log(yours / f"{name}.csv") for name in ("fit", "second"))
    return Once(lambda: identify([fit], load_arm("white_box"), validate=[second], tables=[table_of("before_tuning")]))


@pytest.fixture(scope="session")
def tuned(yours: Path) -> Once:
    """Controllers after four tries, without the least possible errors, which take longest."""
    return Once(
        lambda: tune(
            load_model(yours / "model.toml", samples=1), method="random", budget=4, judging=WITHOUT_FLOORS, threads=1
        )
    )


@pytest.fixture(scope="session")
def commissioned(yours: Path, tmp_path_factory: pytest.TempPathFactory) -> Once:
    """One round on an arm that the native loop simulates; the controllers to try are found at once."""
    real = greywhale.commission.commission
    out = tmp_path_factory.mktemp("commission") / "out"

    def compute() -> Any:
        with pytest.MonkeyPatch.context() as patch:
            in_no_time(SimulatedRig(default_arm()), patch)
            return real(
                CommissioningRequest(port="port", out=out, model=yours / "model.toml", rounds=1, trials=1, budget=4),
                None,
            )

    return Once(compute)


@pytest.fixture(scope="session")
def demonstrated(yours: Path, tmp_path_factory: pytest.TempPathFactory) -> Once:
    """Four seconds with controllers that are there."""
    real = greywhale.cli.story.run
    options = DemoOptions(out=tmp_path_factory.mktemp("demo"), duration_s=4.0, controller=yours / "controller.toml")

    def compute() -> Any:
        with pytest.MonkeyPatch.context() as patch:
            in_this_process(patch)
            return real(options)

    return Once(compute)


@pytest.fixture
def once(
    monkeypatch: pytest.MonkeyPatch,
    yours: Path,
    identified: Once,
    tuned: Once,
    commissioned: Once,
    demonstrated: Once,
) -> None:
    """The verbs around what was computed for all of them; `sim` ends when its port is there, `dashboard` when it would
    wait for a browser. `flash` greets the board that has its firmware. A page's own bench is in this process.
    """

    def commission(options: CommissioningRequest, report: Any) -> Any:
        options.out.mkdir(exist_ok=True)
        return commissioned()

    def serve(options: bench_serve.ServeOptions, on_ready: Any, note: Any) -> None:
        with bench_serve.running(options, note=note) as server:
            on_ready(server.port.path)

    def greet(port: str, *options: object) -> HelloReply:
        with Device(port) as device:
            return device.hello

    def reproduce(request: Request, folder: Path, workers: object, report: object) -> dict[str, object]:
        folder.mkdir(exist_ok=True)
        return {}

    monkeypatch.setattr(reproduce_run, "run", reproduce)
    monkeypatch.setattr(reproduce_report, "document", lambda found: Document("The paper", ("Nothing is in it.",), ()))
    monkeypatch.setattr(identify_verb, "identify", lambda *logs, **options: identified())
    monkeypatch.setattr(tune_verb, "tune", lambda model, **options: tuned())
    monkeypatch.setattr(greywhale.commission, "commission", commission)
    monkeypatch.setattr(greywhale.cli.story, "BenchProcess", lock_step)
    monkeypatch.setattr(greywhale.cli.story, "run", lambda options, report: demonstrated())
    monkeypatch.setattr(bench_serve, "serve", serve)
    monkeypatch.setattr(bench_process, "BenchProcess", lock_step)
    monkeypatch.setattr(dashboard_server, "require_page", lambda: yours)
    monkeypatch.setattr(dashboard_server, "make_server", lambda app: SimpleNamespace(run=lambda listeners: None))
    monkeypatch.setattr(flash_verb, "flash", greet)
