"""The paper's controllers by their names; a slip of the finger gets the right name shown, if there is no such file."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.files import controller
from greywhale.files.arm import load_arm
from greywhale.files.names import did_you_mean
from greywhale.files.paper_tables import controller_names, paper_table
from greywhale.files.parameter_file import load_table

NAMES = ("steps", "multi-steps", "joint0.kp", "joint0.kd")


@pytest.mark.parametrize(
    ("name", "question"),
    [
        ("stepss", " Did you mean steps?"),
        ("joint0.kq", " Did you mean joint0.kp or joint0.kd?"),
        ("x.csv", ""),
        ("steps" * 1000, ""),
        ("", ""),
    ],
)
def test_names_that_are_alike(name: str, question: str) -> None:
    assert did_you_mean(name, NAMES) == question


def test_arms_and_controllers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UserError, match=r"gray_box: cannot be read: .*\. Did you mean grey_box or sticky_grey_box\?$"):
        load_arm("gray_box")
    with pytest.raises(UserError, match=r"table_7: cannot be read: .*\. Did you mean table_\d or table_\d+ or"):
        controller.load("table_7")
    Path("gray_box").write_text("wrong")
    with pytest.raises(UserError) as error:
        load_arm("gray_box")
    assert "Did you mean" not in error.value.message


def test_the_names_are_those_of_the_files_of_the_one_source() -> None:
    folder = paper_table("table_8").parent
    assert folder == Path(__file__).parents[2] / "shared" / "fuzzy_tables"
    assert controller_names() == sorted({path.stem for path in folder.glob("*.toml")} - {"rules"})


def test_a_name_is_the_same_as_its_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in controller_names():
        assert controller.load(name) == controller.load(Path(name)) == controller.load(paper_table(name))
        assert load_table(name).raw == load_table(paper_table(name)).raw
        assert load_table(name).name == name
    assert os.listdir(tmp_path) == []
