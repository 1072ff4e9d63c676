"""`greywhale export` writes what other programs read, and says what it cannot."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from greywhale.cli.export import command
from greywhale.files.log import read_log
from greywhale.files.paper_tables import paper_table
from greywhale.fuzzy.export_fis import fis_text
from greywhale.fuzzy.settings import load_joints
from tests.cli.example_log import write_log


def run(*arguments: str) -> dict[str, list[str]]:
    result = CliRunner().invoke(command, [*arguments, "--json"], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    answer: dict[str, list[str]] = json.loads(result.stdout)
    return answer


def test_four_joints_become_four_fis_files(tmp_path: Path) -> None:
    table = paper_table("table_10")
    written = run("--fis", str(table), "--out", str(tmp_path / "tuned.fis"))["written"]
    assert [Path(path).name for path in written] == [f"tuned_joint{number}.fis" for number in range(4)]
    for number, (path, joint) in enumerate(zip(written, load_joints(table), strict=True)):
        sets = {key: float(value) for key, value in joint.set_values().items()}
        assert Path(path).read_text() == fis_text(f"table_10, joint {number}", sets)


def test_one_joint_goes_into_the_named_file(tmp_path: Path) -> None:
    out = tmp_path / "one.fis"
    assert run("--fis", str(paper_table("before_tuning")), "--joint", "2", "-o", str(out))["written"] == [str(out)]
    assert out.read_text().startswith("[System]\nName='before_tuning, joint 2'")


def test_a_log_becomes_the_named_file(tmp_path: Path) -> None:
    log, out = tmp_path / "log.csv", tmp_path / "log.npz"
    write_log(log)
    assert run(str(log), "--to", "npz", "--out", str(out))["written"] == [str(out)]
    np.testing.assert_array_equal(np.load(out)["voltage"], read_log(log).voltage)


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ([], "exactly one of"),
        (["--to", "npz"], "Give logs and --to"),
        (["log.csv"], "Give logs and --to"),
        (["log.csv", "--to", "npz", "--urdf", "default"], "exactly one of"),
        (["log.csv", "--to", "npz", "--joint", "1"], "--joint does not go with --to npz"),
        (["--urdf", "default", "--mjcf", "default"], "exactly one of"),
        (["--urdf", "default", "--gears"], "--gears goes with --mjcf"),
        (["--urdf", "default", "--joint", "1"], "--joint goes with --fis"),
    ],
)
def test_what_to_write_must_be_clear(tmp_path: Path, arguments: list[str], complaint: str) -> None:
    out = tmp_path / "none"
    result = CliRunner().invoke(command, [*arguments, "--out", str(out)])
    assert getattr(result.exception, "exit_code", result.exit_code) == 2
    assert complaint in f"{result.output}{result.exception}"
    assert not out.exists()
