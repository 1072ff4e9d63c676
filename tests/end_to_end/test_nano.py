"""A Nano from the first recording to the tuned controllers: it is identified, excited and tuned as what it is.

Its last two motors have 255 PWM steps where a Mega has 400; the log's header says which board it was.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.cli.entry import run
from greywhale.files.arm import load_arm
from greywhale.files.log import read_log
from greywhale.files.model import arm_toml
from greywhale.identify import controllers
from greywhale.identify.closed_loop import Loop
from greywhale.identify.data import prepare
from greywhale.protocol.schema import Board
from greywhale.protocol.table import ParameterTable
from greywhale.simulate import plant_row
from greywhale.simulate.closed_loop import ClosedLoop, Result
from greywhale.tune.model import load_model
from greywhale_sim.assemble import BenchOptions, build_bench
from greywhale_sim.lockstep import LockStepBench, tell_joints
from greywhale_sim.words import lock_step
from tests.support.tuning import judge_nothing, shorten

JOINT, FULL = 2, 255


def told(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> dict[str, Any]:
    assert run([*map(str, arguments), "--json"]) == 0
    answer: dict[str, Any] = json.loads(capsys.readouterr().out)
    return answer


@pytest.mark.slow
def test_a_nano_is_excited_identified_and_tuned_as_a_nano(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    fit, second, model, controller, after = (
        tmp_path / name for name in ("fit.csv", "second.csv", "model.toml", "controller.toml", "after.csv")
    )
    shorten(monkeypatch)
    judge_nothing(monkeypatch)
    largest = full_duties_of_every_loop(monkeypatch)
    white_box = ("--arm", with_one_joint("white_box", tmp_path))
    with bench_with_one_joint(tmp_path) as bench:
        port = ("-p", bench.port)
        told(capsys, "record", "--excite", *white_box, *port, "-o", fit, "--seconds", "5", "--budget", "2")
        told(capsys, "record", "--enable", *port, "-o", second, "--seconds", "5")
        assert read_log(fit).origin.board == read_log(second).origin.board == "nano328"
        found = told(capsys, "identify", fit, "-v", second, *white_box, "-o", model)
        assert found["board"] == "nano328"
        assert found["log"][1]["improvement"] > 0.9
        assert load_model(model, force=True).table.board is Board.NANO328
        told(capsys, "tune", model, "-o", controller, "--budget", "30", "--samples", "1", "--force")
        assert 'board = "nano328"' in controller.read_text()
        doubts = told(capsys, "upload", controller, *port)["warnings"]
        # So short a search may leave a margin open; nothing else may be wrong, such as the board or its period.
        assert [one for one in doubts if not one.startswith("a joint may swing")] == []
        told(capsys, "record", "--enable", *port, "-o", after, "--seconds", "5")
    before, now = (log["total_mse_rad2"] for log in told(capsys, "evaluate", second, after)["logs"])
    assert now < 0.7 * before
    assert largest[JOINT] == FULL, "excitation, identification and tuning simulated other timers than the board's"


def with_one_joint(name: str, folder: Path) -> Path:
    """The file of an arm of which one joint is in use, with a motor whose PWM is coarser than a Mega's."""
    arm, path = load_arm(name), folder / f"{name}.toml"
    joints = tuple(one.model_copy(update={"fixed": joint != JOINT}) for joint, one in enumerate(arm.joint))
    path.write_text(arm_toml(arm.model_copy(update={"joint": joints}), "One joint."), encoding="utf-8")
    return path


def bench_with_one_joint(folder: Path) -> LockStepBench:
    """A Nano that knows that its arm has this joint only."""
    options = BenchOptions(board="nano", arm=with_one_joint("default", folder))
    bench = build_bench(options)
    tell_joints(bench, options)
    return LockStepBench(options, bench)


def full_duties_of_every_loop(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The largest duty of every joint in all closed loops to come, in PWM steps; they keep no traces otherwise."""
    largest = [0, 0, 0, 0]
    simulate = ClosedLoop.run

    def watched(self: ClosedLoop, controllers: Any, plants: Any, **options: Any) -> Result:
        result = simulate(self, controllers, plants, **options | {"every": options.get("every") or 50})
        if result.duties.size:
            seen = np.abs(result.duties.astype(int)).max(axis=(0, 1))
            largest[:] = [max(one, int(other)) for one, other in zip(largest, seen, strict=True)]
        return result

    monkeypatch.setattr(ClosedLoop, "run", watched)
    return largest


@pytest.mark.slow
def test_the_very_voltages_of_a_nanos_log_come_in_its_steps(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Told by the log alone: 15 V in 255 steps on the last two joints, in 400 on the first two."""
    path = tmp_path / "log.csv"
    with lock_step("--board", "nano") as bench:
        told(capsys, "record", "--enable", "-p", bench.port, "-o", path, "--seconds", "4")
    log = read_log(path)
    table = controllers.table_of(log, [])
    assert table == ParameterTable.defaults(Board.NANO328)
    loop = Loop(prepare(log, table["filter_shift"]), table, load_arm("default"))
    assert loop.error(plant_row(load_arm("default"))[None]).sum() < 1e-4, "the true arm in its own loop repeats the log"
