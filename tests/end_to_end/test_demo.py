"""The whole story at once, and what it says to bad input."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from greywhale.demo import BenchProcess, DemoOptions, run
from greywhale.errors import UserError
from greywhale.files.log import Log
from greywhale.protocol import schema
from tests.strangers import plant, ran

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.slow
@pytest.mark.timeout(900)  # a whole commissioning: two minutes on a quiet machine
def test_the_demo_tells_its_story_and_proves_its_controllers_on_the_arm(tmp_path: Path) -> None:
    """The third recording is with what commissioning left on the board: nowhere worse than the tuned controllers."""
    told: list[str] = []
    out = tmp_path / "new" / "demo"
    # With 300 candidates a joint's share of its error before differs by a factor of four from run to run.
    options = DemoOptions(out, duration_s=8.0, budget=800, prove=True)
    result = run(options, lambda what, fraction, note="": told.append(what))
    recordings = ["before", "after", "proven", "practice", "check", "check_changed"]
    leaders = ["leader", "rest_leader", "practice_leader", "check_leader", "check_changed_leader"]
    pictures = ["following.png", "sets.png", "convergence.png"]
    assert sorted(path.name for path in out.iterdir()) == sorted(
        [
            "model.toml",
            "controller.toml",
            "summary.json",
            "commission",
            *pictures,
            *(f"{name}.csv" for name in recordings + leaders),
        ]
    )
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
    assert schema.param_crc(schema.DEFAULTS) == before.origin.param_crc != after.origin.param_crc
    assert_same_motion(before, after)
    assert result.learnt is not None
    second, changed = result.learnt.identification.verdicts[1:]
    assert second.improvement > 0.9
    assert changed.improvement > 0.3
    was, became, proven = (one.measures for one in result.runs)
    assert proven.total_mse < 1.1 * became.total_mse
    assert became.total_mse < 0.7 * was.total_mse
    for joint in range(4):
        assert became.joints[joint].mse < 1.1 * was.joints[joint].mse
    text = result.text()
    for word in (
        "before tuning",
        "tuned",
        "proven",
        "Identified",
        "base yaw",
        "wrist roll",
        "all joints",
        str(result.pictures[0]),
    ):
        assert word in text


@pytest.mark.slow
def test_the_demo_shows_a_controller_that_it_is_given(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a stranger's folder, of which neither the bench nor the flashing imports anything."""
    plant(tmp_path)
    monkeypatch.chdir(tmp_path)
    table = ROOT / "shared" / "fuzzy_tables" / "table_8.toml"
    result = run(DemoOptions(tmp_path, duration_s=5.0, controller=table))
    assert result.learnt is None
    assert [one.name for one in result.runs] == ["before tuning", "table_8"]
    assert not (tmp_path / "model.toml").exists()
    assert ran(tmp_path) == set()
    assert_same_motion(*(one.recorded.log() for one in result.runs))
    # The paper's tuned gains are larger: where no gravity acts, they follow much more closely.
    for joint in (0, 2):
        assert result.runs[1].measures.joints[joint].mse < 0.5 * result.runs[0].measures.joints[joint].mse


def assert_same_motion(before: Log, after: Log) -> None:
    seconds = min(before.time[-1], after.time[-1])
    assert seconds > 4.0
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
    with BenchProcess("--blank") as bench:
        bench.command("speed 1")
        with pytest.raises(UserError, match="not a bench command"):
            bench.command("explode")
        assert bench.command("status")["powered"]
