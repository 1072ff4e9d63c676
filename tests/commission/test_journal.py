"""The journal: what is in it is not done again, and it is never mixed up with another commissioning.

What damages and locks it is refused as in every file of checked lines: tests/base/formats/test_checked_lines.py.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from greywhale.base.errors import BAD_USAGE, UserError
from greywhale.commission.journal import NAME, CommissioningJournal

REQUEST = {"arm": "white_box", "seed": 0}


def begin(folder: Path) -> None:
    """One step of a commissioning."""
    with CommissioningJournal(folder, REQUEST, resume=False) as journal:
        assert journal.get("before") is None
        journal.note("before", {"stopped": ""})


def test_a_commissioning_is_not_overwritten_by_accident(tmp_path: Path) -> None:
    begin(tmp_path)
    with pytest.raises(UserError, match="--resume") as caught:
        begin(tmp_path)
    assert caught.value.exit_code == BAD_USAGE
    with CommissioningJournal(tmp_path, REQUEST, resume=True) as journal:
        assert journal.get("before") == {"stopped": ""}


def test_one_that_did_nothing_is_begun_anew(tmp_path: Path) -> None:
    with CommissioningJournal(tmp_path, REQUEST | {"seed": 3}, resume=False):
        pass
    begin(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == [NAME]


def test_nothing_is_made_where_there_is_nothing_to_go_on_with(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no interrupted commissioning"):
        CommissioningJournal(tmp_path / "no", REQUEST, resume=True)
    assert not (tmp_path / "no").exists()


@pytest.mark.parametrize("line", ['{"step": 1, "facts": {}}', '{"facts": {}}', "[]"])
def test_a_line_that_is_no_step_is_refused(tmp_path: Path, line: str) -> None:
    begin(tmp_path)
    with (tmp_path / NAME).open("a") as file:
        file.write(line + "\n")
    with pytest.raises(UserError, match="line 3 is not a line of a commissioning's journal"):
        CommissioningJournal(tmp_path, REQUEST, resume=True)
