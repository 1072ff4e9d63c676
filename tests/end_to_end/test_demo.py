"""The whole story at once, and what it says to bad input."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from greywhale.demo import BenchProcess, DemoOptions, run
from greywhale.errors import UserError
from greywhale.log import read_log


def test_the_demo_tells_its_story(tmp_path: Path) -> None:
    told: list[str] = []
    out = tmp_path / "new" / "demo"
    result = run(DemoOptions(out, duration_s=8.0), lambda what, fraction: told.append(what))
    assert sorted(path.name for path in out.iterdir()) == sorted(
        ["leader.csv", "before.csv", "after.csv", "following.png", "summary.json"]
    )
    assert json.loads((out / "summary.json").read_text()) == result.as_dict()
    assert result.picture.read_bytes().startswith(b"\x89PNG\r\n")
    assert told[0] == "starting the bench"
    assert told[-1] == "drawing"

    before, after = (read_log(one.log) for one in result.runs)
    assert before.origin.param_crc != after.origin.param_crc
    assert before.origin.board == "mega2560"
    seconds = min(before.time[-1], after.time[-1])
    assert seconds > 8.0
    grid = np.arange(0.0, seconds, 0.01)
    leaders = [np.interp(grid, log.time, log.leader[:, 0]) for log in (before, after)]
    assert np.abs(leaders[0] - leaders[1]).max() < 0.03, "both runs saw the same motion"
    # The paper's tuned sets are steeper around zero error: where no gravity acts, they follow much more closely.
    for joint in (0, 2):
        assert result.runs[1].measures.joints[joint].mse < 0.5 * result.runs[0].measures.joints[joint].mse
    text = result.text()
    for word in ("before tuning", "Table 10", "base yaw", "wrist roll", "all joints", str(result.picture)):
        assert word in text


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"duration_s": 1.0}, "duration is 1 s"),
        ({"duration_s": float("nan")}, "duration is nan s"),
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


def test_a_bench_that_dies_is_told_with_its_reason() -> None:
    with pytest.raises(UserError, match="nowhere.csv: cannot be read"):
        BenchProcess("--leader", "nowhere.csv")
    with BenchProcess("--blank") as bench:
        bench.command("speed 1")
        with pytest.raises(UserError, match="not a bench command"):
            bench.command("explode")
        assert bench.command("status")["powered"]
