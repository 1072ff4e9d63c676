"""A tuning that was cut off goes on to the same bytes; a journal of another tuning is refused in a sentence."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from greywhale.base.errors import UserError
from greywhale.simulate import default_controller
from greywhale.tune.search.journal import TuningJournal

ROWS = np.repeat(default_controller()[None], 2, axis=0)
COSTS = np.array([[0.1, 1 / 3, 1e9, 2.0], [5e-324, 0.2, 0.3, 1e300]])
REQUEST: dict[str, Any] = {"seed": 1, "bounds": {}, "pair": (1, 2)}


def written(path: Path, batches: int = 3, request: dict[str, Any] | None = None) -> bytes:
    with TuningJournal(path, request or REQUEST) as book:
        for number in range(batches):
            book.tell(f"stage {number}", ROWS + number, COSTS * (number + 1))
    return path.read_bytes()


def test_costs_come_back_bit_for_bit(tmp_path: Path) -> None:
    path = tmp_path / "j"
    whole = written(path)
    with TuningJournal(path, REQUEST, resume=True) as book:
        for number in range(3):
            assert book.replaying
            costs = book.costs(f"stage {number}", ROWS + number)
            assert costs is not None
            np.testing.assert_array_equal(costs, COSTS * (number + 1))
        assert not book.replaying
        assert book.costs("stage 3", ROWS + 3) is None
    assert path.read_bytes() == whole


def test_a_torn_last_line_is_forgotten_wherever_it_was_torn(tmp_path: Path) -> None:
    path = tmp_path / "j"
    whole = written(path)
    ends = [index + 1 for index, byte in enumerate(whole) if byte == ord("\n")]
    for length in range(0, len(whole) + 1, 7):
        path.write_bytes(whole[:length])
        known = max(0, sum(end <= length for end in ends) - 1)
        with TuningJournal(path, REQUEST, resume=True) as book:
            for number in range(3):
                costs = book.costs(f"stage {number}", ROWS + number)
                assert (costs is not None) == (number < known)
                if costs is None:
                    book.tell(f"stage {number}", ROWS + number, COSTS * (number + 1))
        assert path.read_bytes() == whole


def test_every_line_is_in_the_file_when_it_was_told(tmp_path: Path) -> None:
    path = tmp_path / "j"
    with TuningJournal(path, REQUEST) as book:
        for number in range(3):
            book.tell("stage", ROWS, COSTS)
            assert path.read_bytes().count(b"\n") == number + 2


def test_without_resume_a_journal_begins_anew(tmp_path: Path) -> None:
    path = tmp_path / "j"
    written(path)
    with TuningJournal(path, REQUEST):
        pass
    assert path.read_bytes().count(b"\n") == 1


def test_resuming_what_is_not_there_begins_anew(tmp_path: Path) -> None:
    with TuningJournal(tmp_path / "j", REQUEST, resume=True) as book:
        assert not book.replaying
        book.tell("stage 0", ROWS, COSTS)
    assert (tmp_path / "j").read_bytes() == written(tmp_path / "k", 1)


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        ({"seed": 2}, "its seed is 1, now it is 2; give the same again, or start anew without --resume"),
        ({"bounds": {"Ku": [3, 5]}}, r'its bounds is {}, now it is {"Ku": \[3, 5\]}'),
        ({"new": 5}, "its new is null, now it is 5"),
        ({"pair": list(range(100))}, r"now it is \[0, 1, 2, .*\.\.\.;"),
    ],
)
def test_another_request_is_refused_with_what_differs(tmp_path: Path, changed: dict[str, Any], sentence: str) -> None:
    path = tmp_path / "j"
    whole = written(path)
    with pytest.raises(UserError, match=sentence):
        TuningJournal(path, REQUEST | changed, resume=True)
    assert path.read_bytes() == whole


def test_other_candidates_than_the_journals_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "j"
    written(path)
    with TuningJournal(path, REQUEST, resume=True) as book:
        book.costs("stage 0", ROWS)
        with pytest.raises(UserError, match=r"batch 2 of the journal is of other candidates \(stage 1\)"):
            book.costs("stage 1", ROWS)


@pytest.mark.parametrize(
    ("spoil", "sentence"),
    [
        (lambda lines: [b"hello", *lines[1:]], "line 1 is not a line of a tuning's journal"),
        (lambda lines: [lines[0], b"\xff\xfe", *lines[2:]], "line 2 is not a line"),
        (lambda lines: [lines[0], lines[1].replace(b"0.1", b'"x"'), *lines[2:]], "line 2 is not a line"),
        (lambda lines: [lines[0], lines[1].replace(b"[", b"[[0.5],", 1), *lines[2:]], "line 2 is not a line"),
        (lambda lines: [lines[0], lines[1].replace(b"0.1", b"NaN"), *lines[2:]], "line 2 is not a line"),
        (lambda lines: [lines[0], lines[1].replace(b"0.1", b"1e999"), *lines[2:]], "line 2 is not a line"),
        (lambda lines: [lines[0], b"[" * 100_000, *lines[2:]], "line 2 is not a line"),
        (
            lambda lines: [lines[0], lines[1].replace(b"0.1", b"0.2"), *lines[2:]],
            "line 2 is damaged; remove it and all",
        ),
        (lambda lines: [lines[0].replace(b'"seed":1', b'"seed":2'), *lines[1:]], "line 1 is damaged; start anew"),
        (lambda lines: [lines[0], *lines[2:]], "line 2 is damaged"),
        (lambda lines: [*lines[:2], lines[1], *lines[2:]], "line 3 is damaged"),
        (lambda lines: [lines[0].replace(b":3,", b":1,", 1), *lines[1:]], "of another version of greywhale"),
    ],
)
def test_what_is_no_journal_is_refused(tmp_path: Path, spoil: Any, sentence: str) -> None:
    path = tmp_path / "j"
    path.write_bytes(b"\n".join(spoil(written(path).split(b"\n"))))
    with pytest.raises(UserError, match=sentence):
        TuningJournal(path, REQUEST, resume=True)


@given(st.data())
@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_no_changed_byte_gives_another_cost(tmp_path: Path, data: st.DataObject) -> None:
    """It is told in a sentence, or torn off with the last line."""
    path = tmp_path / "j"
    whole = written(path)
    place = data.draw(st.integers(0, len(whole) - 1))
    spoilt = bytearray(whole)
    spoilt[place] = data.draw(st.integers(0, 255).filter(lambda byte: byte != whole[place]))
    path.write_bytes(spoilt)
    try:
        book = TuningJournal(path, REQUEST, resume=True)
    except UserError:
        return
    with book:
        for number in range(2):  # the last line may be torn off
            costs = book.costs(f"stage {number}", ROWS + number)
            np.testing.assert_array_equal(costs, COSTS * (number + 1))
        assert not book.replaying


def test_places_that_cannot_hold_a_journal_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="cannot be used as a journal: is a directory"):
        TuningJournal(tmp_path, REQUEST)
    with pytest.raises(UserError, match="cannot be used as a journal: no such file"):
        TuningJournal(tmp_path / "no" / "folder", REQUEST)


def test_a_full_disk_is_said_with_the_remedy() -> None:
    with pytest.raises(UserError, match="/dev/full: cannot be written: no space left on device; make room and go on"):
        TuningJournal(Path("/dev/full"), REQUEST)


def test_lines_are_json(tmp_path: Path) -> None:
    heading, *batches = (json.loads(line) for line in written(tmp_path / "j").splitlines())
    assert heading["request"]["seed"] == 1
    assert [batch["stage"] for batch in batches] == ["stage 0", "stage 1", "stage 2"]
