"""`greywhale export` writes what other programs read, and says what it cannot."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from greywhale.base.errors import UserError
from greywhale.cli.export import command
from greywhale.files import fis
from greywhale.files.log import read_log
from greywhale.files.paper_tables import paper_table
from greywhale.fuzzy.export_fis import fis_text
from greywhale.fuzzy.export_header import make_header
from greywhale.fuzzy.settings import load_joints
from greywhale.fuzzy.table_law import from_fis
from tests.cli.example_log import write_log
from tools.support.fis_files import table


def run_json(*arguments: str) -> str:
    result = CliRunner().invoke(command, [*arguments, "--json"], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.stdout


def run(*arguments: str) -> dict[str, list[str]]:
    answer: dict[str, list[str]] = json.loads(run_json(*arguments))
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
        (["--urdf", "default", "--joint", "1"], "--joint goes with a controller"),
        (["--urdf", "default", "--task", "Wave"], "are for logs"),
        (["log.csv", "--to", "npz", "--fps", "30"], "--fps does not go with --to npz"),
    ],
)
def test_what_to_write_must_be_clear(tmp_path: Path, arguments: list[str], complaint: str) -> None:
    out = tmp_path / "none"
    result = CliRunner().invoke(command, [*arguments, "--out", str(out)])
    assert getattr(result.exception, "exit_code", result.exit_code) == 2
    assert complaint in f"{result.output}{result.exception}"
    assert not out.exists()


@pytest.mark.slow
def test_a_fis_becomes_a_header(tmp_path: Path) -> None:
    (tmp_path / "five.fis").write_text(table(5))
    out = tmp_path / "law.h"
    result = CliRunner().invoke(command, ["--header", str(tmp_path / "five.fis"), "--out", str(out)])
    assert result.exit_code == 0, result.output
    assert "463 bytes of tables; within 1.26 LSB of the exact centroid (proven)" in result.output
    assert out.read_text() == make_header(from_fis(fis.parse(table(5)), ""), "five.fis", "law.h").text


def test_a_joint_becomes_a_header_with_its_gains(tmp_path: Path) -> None:
    table_10 = str(paper_table("table_10"))
    out = tmp_path / "law.h"
    (facts,) = json.loads(run_json("--header", table_10, "--joint", "1", "--out", str(out)))["headers"]
    assert facts["largest_lsb"] <= facts["bound_lsb"]
    assert "inline PdI controller()" in out.read_text()


def test_no_header_of_a_law_with_a_hole(tmp_path: Path) -> None:
    (tmp_path / "hole.fis").write_text(table(3).replace("1 3, 2 (1) : 1\n", ""))
    out = tmp_path / "law.h"
    result = CliRunner().invoke(command, ["--header", str(tmp_path / "hole.fis"), "--out", str(out)])
    assert isinstance(result.exception, UserError)
    assert "hole.fis: the rules have a hole: at error = -3 and change = " in result.exception.message
    assert not out.exists()
