"""Host and page flash by the same rules, and take an answer only where it is the one to their question."""

from __future__ import annotations

import pytest

from greywhale.board.flash.question import keep
from greywhale.board.flash.rules import Stk500V1, Stk500V2
from tools.generate import flash


def test_both_have_the_rules_of_shared_flash_toml() -> None:
    """If not: `python -m tools.generate`."""
    assert flash.main(["--check"]) == 0


def test_a_pattern_is_written_in_both_languages() -> None:
    pattern = "'d' #page>2 .. at<3 page* kept*count 0e"
    assert flash.spell(pattern, flash.PYTHON) == (
        "[0x64, *high_first(len(page), 2), ANY, *low_first(at, 3), *page, *[KEPT] * count, 0x0e]"
    )
    assert flash.spell(pattern, flash.TYPESCRIPT) == (
        "[0x64, ...highFirst(page.length, 2), ANY, ...lowFirst(at, 3), ...page, ...kept(count), 0x0e]"
    )
    assert flash.values(flash.PYTHON, pattern) == "page: Sequence[int], at: int, count: int"


@pytest.mark.parametrize("pattern", ["0e 1", "1g", "'a", "Page*", "at>"])
def test_what_is_no_pattern_is_named(pattern: str) -> None:
    with pytest.raises(ValueError, match="is no pattern"):
        flash.spell(pattern, flash.PYTHON)


@pytest.mark.parametrize("heard", [b"", b"\x14", b"\x14abc", b"\x14abcd", b"\x15abc\x10", b"\x14abc\x10\x10"])
def test_another_answer_than_that_to_the_question_is_none(heard: bytes) -> None:
    assert keep(heard, Stk500V1.signature().answer) is None


def test_what_was_asked_for_is_kept() -> None:
    assert keep(b"\x14abc\x10", Stk500V1.signature().answer) == b"abc"
    assert keep(b"\x1d\x00xyzSw", Stk500V2.signature(0).answer) == b"S"
    assert keep(b"\x14\x10", Stk500V1.leave().answer) == b""
