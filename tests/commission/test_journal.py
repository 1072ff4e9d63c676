"""The journal: what is in it is not done again, and it is never mixed up with another commissioning."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from greywhale.base.errors import BAD_USAGE, UserError
from greywhale.commission.journal import NAME, CommissioningJournal, open_journal

REQUEST = {"arm": "white_box", "ranges": {"0": [-0.5, 0.5]}, "seed": 0}


def test_steps_are_there_after_a_break(tmp_path: Path) -> None:
    book = CommissioningJournal(tmp_path / "new", REQUEST, resume=False)
    assert book.get("before") is None
    book.note("before", {"stopped": ""})
    again = CommissioningJournal(tmp_path / "new", REQUEST, resume=True)
    assert again.get("before") == {"stopped": ""}
    assert again.path("before.csv") == tmp_path / "new" / "before.csv"


def test_a_commissioning_is_not_overwritten_by_accident(tmp_path: Path) -> None:
    CommissioningJournal(tmp_path, REQUEST, resume=False).note("before", {})
    with pytest.raises(UserError, match="--resume") as caught:
        CommissioningJournal(tmp_path, REQUEST, resume=False)
    assert caught.value.exit_code == BAD_USAGE
    assert CommissioningJournal(tmp_path, REQUEST, resume=True).get("before") == {}


def test_one_that_did_nothing_is_begun_anew(tmp_path: Path) -> None:
    CommissioningJournal(tmp_path, {**REQUEST, "seed": 3}, resume=False)
    CommissioningJournal(tmp_path, REQUEST, resume=False).note("before", {})
    assert json.loads((tmp_path / NAME).read_text())["request"] == REQUEST


@pytest.mark.parametrize("resume", [False, True])
def test_two_commissionings_cannot_be_in_one_folder_at_once(tmp_path: Path, resume: bool) -> None:
    folder = tmp_path / "out"
    with open_journal(folder, REQUEST, resume=False) as book:
        book.note("before", {})
        with (
            pytest.raises(UserError, match="another greywhale is commissioning"),
            open_journal(folder, REQUEST, resume),
        ):
            pass
        assert CommissioningJournal(folder, REQUEST, resume=True).get("before") == {}
    with open_journal(folder, REQUEST, resume=True) as book:
        assert book.get("before") == {}
    assert [path.name for path in folder.iterdir()] == [NAME], "no lock is left behind"


def test_nothing_is_made_where_there_is_nothing_to_go_on_with(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no interrupted"), open_journal(tmp_path / "no", REQUEST, resume=True):
        pass
    assert not (tmp_path / "no").exists()


def test_other_options_are_refused_with_their_name(tmp_path: Path) -> None:
    CommissioningJournal(tmp_path, REQUEST, resume=False).note("before", {})
    with pytest.raises(UserError, match="begun with seed = 0, not 1"):
        CommissioningJournal(tmp_path, {**REQUEST, "seed": 1}, resume=True)


def test_nothing_to_go_on_with_is_said(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no interrupted commissioning"):
        CommissioningJournal(tmp_path, REQUEST, resume=True)


@pytest.mark.parametrize(
    "text", ["", "[]", "{", '{"greywhale_commission": 2}', "[" * 100_000, "\x00", '{"greywhale_commission": NaN}']
)
def test_a_file_that_is_no_journal_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / NAME).write_text(text)
    with pytest.raises(UserError, match="no journal of a commissioning"):
        CommissioningJournal(tmp_path, REQUEST, resume=True)


@pytest.mark.parametrize(
    ("old", "new"), [('"stopped": ""', '"stopped": "x"'), ('"seed": 0', '"seed": 1'), ("0.5", "0.4")]
)
def test_a_changed_journal_is_refused(tmp_path: Path, old: str, new: str) -> None:
    CommissioningJournal(tmp_path, REQUEST, resume=False).note("before", {"stopped": ""})
    text = (tmp_path / NAME).read_text()
    assert old in text
    (tmp_path / NAME).write_text(text.replace(old, new))
    with pytest.raises(UserError, match="the journal is damaged; begin anew"):
        CommissioningJournal(tmp_path, REQUEST, resume=True)


def test_a_journal_of_another_version_is_named_as_that(tmp_path: Path) -> None:
    (tmp_path / NAME).write_text('{"greywhale_commission": 1, "request": {}, "steps": {}}')
    with pytest.raises(UserError, match="it is of another version"):
        CommissioningJournal(tmp_path, REQUEST, resume=True)
