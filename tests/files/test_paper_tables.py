"""The paper's controllers are found and whole, by their files and by their names."""

import os
from pathlib import Path

import pytest

from greywhale.files import controller
from greywhale.files.paper_tables import controller_names, paper_table
from greywhale.files.parameter_file import load_table


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
