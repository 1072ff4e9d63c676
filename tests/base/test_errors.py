"""Sentences for people: numbers within their range, and never longer than a person reads."""

from __future__ import annotations

import pytest

from greywhale.base.errors import BAD_USAGE, LONGEST_SENTENCE, UserError, require_within


def test_numbers_keep_their_range() -> None:
    require_within("seeds", 1, 1, 9)
    require_within("seeds", 9, 1, 9)
    for value, words in ((0, "seeds is 0, but it must be at least 1."), (10, "seeds is 10, but it must be at most 9.")):
        with pytest.raises(UserError) as refused:
            require_within("seeds", value, 1, 9)
        assert (refused.value.message, refused.value.exit_code) == (words, BAD_USAGE)


def test_a_sentence_of_any_length_is_cut() -> None:
    assert len(UserError(f"{'x' * 5000}.").message) <= LONGEST_SENTENCE
