"""The whole story at once, and what it says to bad input."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.errors import UserError
from greywhale.cli.story import BenchProcess, DemoOptions, DemoResult, practice, run, story
from greywhale.cli.story.recorder import record_motion
from greywhale.commission import CommissioningRequest, journal
from greywhale.commission.limits import CommissioningLimits, MotionLimits, SearchLimits
from greywhale.files.leader import save_leader
from greywhale.files.log import Log
from greywhale.files.model import arm_toml
from greywhale.files.trajectory import Trajectory
from greywhale_sim.words import lock_step
from tests.support.arms import make_arm, with_joints
from tests.support.demo import in_this_process
from tests.support.tuning import few_orders, few_plants, judge_nothing, shorten
from tools import ROOT


@pytest.mark.slow
def test_the_demo_tells_its_story_and_proves_its_controllers_on_the_arm(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of an arm with one joint, with a short check; the last recording is with what commissioning left on the board."""
    in_this_process(monkeypatch)
    shorten(monkeypatch)
    judge_nothing(monkeypatch)
    few_plants(monkeypatch)
    few_orders(monkeypatch)
    monkeypatch.setattr(practice, "GOOD_BUDGET", 30)
    monkeypatch.setattr(story, "PROVING_TRIALS", 1)
    short = MotionLimits(
        reaches_s=2.0, hold_s=0.5, slow_s=1.0, pause_s=0.3, move_shares=(0.5,), rest_s=0.5,
        small_rad=(0.1, 0.0), still_shares=(0.6, 0.0), still_s=0.3,
    )  # fmt: skip
    judging = CommissioningLimits(motion=short, search=SearchLimits(packs=((0.1, 12),), retry_error=1e9))
    monkeypatch.setattr("greywhale.commission.CommissioningRequest", partial(CommissioningRequest, judging=judging))
    told: list[str] = []
    out = tmp_path / "demo"
    (out / "commission").mkdir(parents=True)
    (out / "commission" / journal.NAME).write_text("A commissioning by an earlier demo,\nwith a step.\n")
    options = DemoOptions(
        out, arm=arm_with_joints(1, tmp_path), duration_s=4.0, practice_s=10.0, budget=100, prove=True
    )
    result = run(options, lambda what, fraction, note="": told.append(what))
    recordings = ["before", "after", "proven", "practice", "check", "check_changed"]
    leaders = ["leader", "rest_leader", "practice_leader", "check_leader", "check_changed_leader"]
    pictures = ["following.png", "sets.png", "convergence.png"]
    others = {"model.toml", "controller.toml", "summary.json", "commission", *pictures}
    assert {path.name for path in out.iterdir()} == others | {f"{name}.csv" for name in recordings + leaders}
    assert json.loads((out / "summary.json").read_text()) == result.as_dict()
    for picture in result.pictures:
        assert picture.read_bytes().startswith(b"\x89PNG\r\n")
    assert told[0] == "starting the bench"
    assert told[-1] == "drawing"
    assert told.index("practice: recording") < told.index("tuning") < told.index("tuned: recording")

    assert [one.name for one in result.runs] == ["before tuning", "tuned", "proven"]
    assert "predicted" in (out / "commission" / "report.html").read_text(encoding="utf-8").lower()
    before, after, _ = (one.recorded.log() for one in result.runs)
    assert before.origin.board == "mega2560"
    assert before.origin.param_crc != after.origin.param_crc
    assert_same_motion(before, after)
    assert result.learnt is not None
    assert result.learnt.identification.white_box.joints_in_use == (0,)
    second, changed = result.learnt.identification.verdicts[1:]
    assert second.improvement > 0.8
    # How well such a short practice foretells a changed arm is chance; the benchmark of identify says it of many arms.
    assert Path(changed.name).name == "check_changed.csv"
    was, became, proven = (one.measures for one in result.runs)
    # How much a whole search gains is measured by the benchmarks.
    assert proven.total_mse < 1.1 * became.total_mse
    assert became.total_mse < was.total_mse
    assert_shows_joints(result, 1)
    for word in ("before tuning", "tuned", "proven", "Identified", "all joints", str(result.pictures[0])):
        assert word in result.text()


@pytest.mark.slow
def test_the_demo_shows_a_controller_that_it_is_given_on_the_joints_that_there_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    in_this_process(monkeypatch)
    out, table = tmp_path / "new" / "demo", ROOT / "shared" / "fuzzy_tables" / "table_8.toml"
    result = run(DemoOptions(out, arm=arm_with_joints(3, tmp_path), duration_s=4.0, controller=table))
    assert result.learnt is None
    assert [one.name for one in result.runs] == ["before tuning", "table_8"]
    assert not (out / "model.toml").exists()
    assert_shows_joints(result, 3)
    assert_same_motion(*(one.recorded.log() for one in result.runs))
    # The paper's tuned gains are larger: where no gravity acts, they follow much more closely.
    for joint in (0, 2):
        assert result.runs[1].measures.joints[joint].mse < 0.5 * result.runs[0].measures.joints[joint].mse


@pytest.mark.slow
def test_why_the_arms_are_not_at_the_start_of_a_motion_is_told(tmp_path: Path) -> None:
    """A motion beyond the follower's stops, and potentiometers that the board does not know, are no faults."""
    stops = {"stops": {"min": -1.0, "max": 1.0}}
    arm = make_arm(every_joint=stops, follower_pots={"joint": {"centre": 0.3}})
    (tmp_path / "arm.toml").write_text(arm_toml(arm, "Other potentiometers."))
    motions = {
        "far.csv": (1.5, "far.csv: .* joint 2 at 1.50 rad, .* 1.00"),
        "home.csv": (0.0, "stands at 0.00 rad, but the board reads .* does not know"),
    }
    with lock_step("--arm", str(tmp_path / "arm.toml")) as bench:
        for name, (angle, sentence) in motions.items():
            pose = np.array([0.0, 0.0, angle, 0.0])
            save_leader(tmp_path / name, Trajectory(np.array([0.0, 1.0]), np.array([pose, pose])))
            with pytest.raises(UserError, match=sentence):
                record_motion(bench, tmp_path / name, tmp_path / "log.csv")


def arm_with_joints(count: int, folder: Path) -> Path:
    path = folder / "arm.toml"
    path.write_text(arm_toml(with_joints(tuple(range(count))), "Fewer joints."))
    return path


def assert_shows_joints(result: DemoResult, count: int) -> None:
    for one in result.runs:
        assert one.recorded.log().joints_in_use == tuple(range(count))
        assert one.measures.total_mse == pytest.approx(sum(joint.mse for joint in one.measures.joints[:count]))
    tables = result.text().partition("MSE [rad²]")[2]
    for joint, name in enumerate(JOINT_NAMES):
        assert (f"{joint} {name}" in tables) == (joint < count)


def assert_same_motion(before: Log, after: Log) -> None:
    seconds = min(before.time[-1], after.time[-1])
    assert seconds > 3.0
    grid = np.arange(0.0, seconds, 0.01)
    leaders = [np.interp(grid, log.time, log.leader[:, 0]) for log in (before, after)]
    assert np.abs(leaders[0] - leaders[1]).max() < 0.03


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"duration_s": 1.0}, "duration is 1 s"),
        ({"duration_s": float("nan")}, "duration is nan s"),
        ({"practice_s": 9.0}, "practice is 9 s"),
        ({"controller": Path("nowhere.toml")}, "nowhere.toml: cannot be read"),
        ({"leader": Path("nowhere.csv")}, "nowhere.csv: cannot be read"),
        ({"arm": Path("nowhere.toml")}, "nowhere.toml"),
    ],
)
def test_bad_options_end_the_demo_with_a_sentence(tmp_path: Path, options: dict[str, object], sentence: str) -> None:
    with pytest.raises(UserError) as caught:
        run(DemoOptions(tmp_path / "demo", **options))  # type: ignore[arg-type]
    assert sentence in caught.value.message
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_made(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("a file")
    with pytest.raises(UserError, match="taken: cannot be made"):
        run(DemoOptions(tmp_path / "taken"))


@pytest.mark.slow
def test_a_bench_that_dies_is_told_with_its_reason() -> None:
    with pytest.raises(UserError, match="nowhere.csv: cannot be read"):
        BenchProcess("--leader", "nowhere.csv")
