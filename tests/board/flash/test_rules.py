"""Host and page flash by the same rules, and take an answer only where it is the one to their question."""

from __future__ import annotations

import pytest

from greywhale.board.flash.question import keep
from greywhale.board.flash.rules import Stk500V1, Stk500V2
from tools.generate import flash


def test_both_have_the_rules_of_shared_flash_toml() -> None:
    """If not: `python -m tools.generate`."""
    assert flash.main(["--check"]) == 0


@pytest.mark.parametrize("heard", [b"", b"\x14", b"\x14abc", b"\x14abcd", b"\x15abc\x10", b"\x14abc\x10\x10"])
def test_another_answer_than_that_to_the_question_is_none(heard: bytes) -> None:
    assert keep(heard, Stk500V1.signature().answer) is None


def test_what_was_asked_for_is_kept() -> None:
    assert keep(b"\x14abc\x10", Stk500V1.signature().answer) == b"abc"
    assert keep(b"\x1d\x00xyzSw", Stk500V2.signature(0).answer) == b"S"
    assert keep(b"\x14\x10", Stk500V1.leave().answer) == b""
