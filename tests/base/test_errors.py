"""Sentences for people: numbers within their range, and never longer than a person reads."""

from __future__ import annotations

import pytest

from greywhale.base.errors import BAD_USAGE, LONGEST_SENTENCE, UserError, require_within
from tests.support.sentences import is_sentence, names


def test_numbers_keep_their_range() -> None:
    require_within("seeds", 1, 1, 9)
    require_within("seeds", 9, 1, 9)
    for value, words in ((0, "seeds is 0, but it must be at least 1."), (10, "seeds is 10, but it must be at most 9.")):
        with pytest.raises(UserError) as refused:
            require_within("seeds", value, 1, 9)
        assert (refused.value.message, refused.value.exit_code) == (words, BAD_USAGE)


def test_a_sentence_of_any_length_is_cut() -> None:
    assert len(UserError(f"{'x' * 5000}.").message) <= LONGEST_SENTENCE


@pytest.mark.parametrize(
    ("message", "whole"),
    [
        ("f.toml: radius is 3; give at most 2.", True),
        ("No such command 'recrod'. Did you mean record?", True),
        ("f.toml: radius is 3", False),
        ("f.toml: radius is None.", False),
        (": radius is 3.", False),
        ("radius is {value}.", False),
        ("two\nlines.", False),
    ],
)
def test_what_counts_as_a_whole_sentence(message: str, whole: bool) -> None:
    """Of every error that any test causes, tests/conftest.py demands this."""
    assert is_sentence(message) is whole


def test_a_sentence_names_things_in_their_order_and_no_part_of_a_number() -> None:
    sentence = "f.toml: wheel.radius is 3.5, but it must be at most 2."
    assert names(sentence, "f.toml: wheel.radius 3.5 2")
    assert not names(sentence, "2 wheel.radius")
    assert not names(sentence, "wheel.radius 3")
    assert not names(sentence, "wheel.radius 5")
