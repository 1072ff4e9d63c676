"""Files of checked lines: what was written comes back, what is somebody else's is left alone."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from greywhale.base.errors import UserError
from greywhale.base.formats.checked_lines import CheckedLines, Kind

KIND = Kind(
    mark="a_diary",
    version=2,
    noun="diary",
    subject="voyage",
    anew="begin another one",
    again="on page two",
    is_line=lambda line: "day" in line,
    choices=("ship",),
)
REQUEST: dict[str, Any] = {"crew": 9, "ship": "Whale", "ports": (1, 2)}
DAYS: list[dict[str, Any]] = [{"day": 1, "wind": 0.1 + 0.2}, {"day": 2, "wind": None}, {"day": 3}]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "d"


def written(path: Path, days: list[dict[str, Any]] | None = None, keep: bool = False) -> bytes:
    with CheckedLines(path, KIND, REQUEST, keep) as lines:
        for day in DAYS if days is None else days:
            lines.append(day)
    return path.read_bytes()


def test_lines_come_back_and_more_can_follow(path: Path) -> None:
    whole = written(path)
    assert written(path, DAYS[:1]) != whole, "without keep it begins anew"
    with CheckedLines(path, KIND, REQUEST, keep=True) as lines:
        assert lines.found == DAYS[:1]
        for day in DAYS[1:]:
            lines.append(day)
    assert path.read_bytes() == whole
    assert written(path, [], keep=True) == whole


def test_a_torn_last_line_is_forgotten_wherever_it_was_torn(path: Path) -> None:
    whole = written(path)
    for length in range(len(whole)):
        path.write_bytes(whole[:length])
        with CheckedLines(path, KIND, REQUEST, keep=True) as lines:
            known = max(0, whole[:length].count(b"\n") - 1)
            assert lines.found == DAYS[:known]
            for day in DAYS[known:]:
                lines.append(day)
        assert path.read_bytes() == whole


@pytest.mark.parametrize("content", [b"a list of things to buy", b'{"a_diary":2}', b"{}\n", b"\n", b"\xff\n"])
def test_what_never_was_such_a_file_is_left_alone(path: Path, content: bytes) -> None:
    path.write_bytes(content)
    with pytest.raises(UserError, match="line 1 is not a line of a voyage's diary"):
        CheckedLines(path, KIND, REQUEST, keep=True)
    assert path.read_bytes() == content


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda lines: [b"hello", *lines[1:]], "line 1 is not a line"),
        (lambda lines: [lines[0], b"\xff\xfe", *lines[2:]], "line 2 is not a line"),
        (lambda lines: [lines[0], b"[" * 100_000, *lines[2:]], "line 2 is not a line"),
        (
            lambda lines: [lines[0], lines[1].replace(b"0.3", b"0.4"), *lines[2:]],
            "line 2 is damaged; remove it and all",
        ),
        (lambda lines: [lines[0].replace(b":9", b":8"), *lines[1:]], "line 1 is damaged; begin another one"),
        (lambda lines: [lines[0], *lines[2:]], "line 2 is damaged"),
        (lambda lines: [*lines[:2], lines[1], *lines[2:]], "line 3 is damaged"),
        (lambda lines: [lines[0].replace(b":2,", b":1,", 1), *lines[1:]], "of another version of greywhale"),
    ],
)
def test_a_damaged_line_is_named_with_the_remedy(path: Path, spoil: Any, words: str) -> None:
    path.write_bytes(b"\n".join(spoil(written(path).split(b"\n"))))
    with pytest.raises(UserError, match=words):
        CheckedLines(path, KIND, REQUEST, keep=True)


@given(st.data())
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_no_changed_byte_gives_another_line(path: Path, data: st.DataObject) -> None:
    """It is told in a sentence, or torn off with the last line."""
    whole = written(path)
    place = data.draw(st.integers(0, len(whole) - 1))
    spoilt = bytearray(whole)
    spoilt[place] = data.draw(st.integers(0, 255).filter(lambda byte: byte != whole[place]))
    path.write_bytes(spoilt)
    with contextlib.suppress(UserError), CheckedLines(path, KIND, REQUEST, keep=True) as lines:
        assert lines.found in (DAYS, DAYS[:-1])


def test_places_that_cannot_hold_one_are_refused(tmp_path: Path) -> None:
    for path, words in ((tmp_path, "is a directory"), (tmp_path / "no" / "folder", "no such file")):
        with pytest.raises(UserError, match=f"cannot be used as a diary: {words}"):
            CheckedLines(path, KIND, REQUEST, keep=False)


def test_a_choice_is_named_before_what_follows_from_it(path: Path) -> None:
    written(path)
    with pytest.raises(UserError, match='its ship is "Whale", now it is "Wolf"'):
        CheckedLines(path, KIND, {**REQUEST, "crew": 8, "ship": "Wolf"}, keep=True)


@pytest.mark.parametrize("keep", [True, False])
def test_a_file_that_another_has_is_not_touched(path: Path, keep: bool) -> None:
    with CheckedLines(path, KIND, REQUEST, keep=False) as lines:
        lines.append(DAYS[0])
        before = path.read_bytes()
        with pytest.raises(UserError, match="another greywhale is using this diary now"):
            CheckedLines(path, KIND, REQUEST, keep)
        assert path.read_bytes() == before
        lines.append(DAYS[1])
    with CheckedLines(path, KIND, REQUEST, keep=True) as lines:
        assert lines.found == DAYS[:2]


def test_a_full_disk_is_said_with_the_remedy() -> None:
    with pytest.raises(UserError, match="/dev/full: .*no space left on device; make room and go on on page two"):
        CheckedLines(Path("/dev/full"), KIND, REQUEST, keep=False)
