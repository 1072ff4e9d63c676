"""`greywhale fis` tells what a file holds, and takes back what `export --fis` wrote, bit for bit."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from greywhale.base.errors import UserError
from greywhale.cli import export
from greywhale.cli.fis import command
from greywhale.files.controller import load
from greywhale.files.paper_tables import paper_table
from greywhale.fuzzy.settings import load_joints
from tools.support.fis_files import table


def run(*arguments: object) -> Result:
    return CliRunner().invoke(command, list(map(str, arguments)))


@pytest.mark.parametrize("joint", range(4))
def test_the_sets_come_back_bit_for_bit(tmp_path: Path, joint: int) -> None:
    source, fis, out = paper_table("table_9"), tmp_path / "a.fis", tmp_path / "b.toml"
    base = tmp_path / "base.toml"
    base.write_text(
        paper_table("before_tuning").read_text().replace("\n\n[[joint", "\nstall_volts = 3.0\n\n[[joint", 1)
    )
    CliRunner().invoke(export.command, ["--fis", str(source), "--joint", str(joint), "--out", str(fis)])
    result = run(fis, "--controller", base, "--joint", joint, "--out", out)
    assert result.exit_code == 0, result.output
    mine, its, before = load_joints(out), load_joints(source), load_joints(base)
    assert mine[joint].set_values() == its[joint].set_values()
    assert mine[joint].as_tuple()[8:] == before[joint].as_tuple()[8:]
    others = [number for number in range(4) if number != joint]
    assert [mine[number] for number in others] == [before[number] for number in others]
    assert load(out).stall_volts == load(base).stall_volts == 3.0


def test_it_tells_what_runs_another_table_and_what_does_not(tmp_path: Path) -> None:
    path = tmp_path / "five.fis"
    path.write_text(table(5).replace("NumRules=25", "NumRules=24"))
    text = run(path).output
    assert text.startswith("table5: mamdani, 25 rules\ninput error, -3 to 3\n  S0: trimf [-4.5 -3 -1.5]\n")
    assert "odd: line 7: it says 24, and there are 25 rules\n" in text
    assert "On an arm (--controller): no.\n  line 10: impmethod is 'min', not 'prod'\n" in text
    assert text.endswith("As a header (greywhale export --header): yes.\n")
    answer = json.loads(run(path, "--json").output)
    assert answer["not_in_a_header"] == []
    assert "line 14: 'error' has 5 sets, not 3" in answer["not_on_an_arm"]


def test_what_an_arm_cannot_run_changes_no_controller(tmp_path: Path) -> None:
    path, out = tmp_path / "three.fis", tmp_path / "out.toml"
    path.write_text(table(3))
    result = run(path, "--controller", "table_9", "--joint", 0, "--out", out)
    assert isinstance(result.exception, UserError)
    assert "line 10: impmethod is 'min', not 'prod'; the firmware cannot run this." in result.exception.message
    assert not out.exists()


def test_options_go_together(tmp_path: Path) -> None:
    (tmp_path / "a.fis").write_text(table(3))
    result = run(tmp_path / "a.fis", "--controller", "table_9")
    assert (result.exit_code, "go together" in result.output) == (2, True)
