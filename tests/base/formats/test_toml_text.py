"""TOML that is written reads back as what it was."""

from __future__ import annotations

import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from greywhale.base.formats import toml_text

words = st.text(st.characters(codec="utf-8"), max_size=8)
leaf = st.booleans() | st.integers(-(2**63), 2**63 - 1) | st.floats(allow_nan=False) | words
anything = st.recursive(leaf, lambda some: st.lists(some, max_size=3) | st.dictionaries(words, some, max_size=3))


@given(st.dictionaries(words, anything, max_size=4))
def test_a_table_reads_back_as_it_was(content: dict[str, object]) -> None:
    assert tomllib.loads("\n".join(toml_text.table("name", content)))["name"] == content


def test_lists_of_tables_follow_the_plain_values() -> None:
    lines = toml_text.table("a", {"rows": [{"x": 1}, {"x": 2}], "empty": [], "b": 0.1})
    assert lines == ["[a]", "empty = []", "b = 0.1", "", "[[a.rows]]", "x = 1", "", "[[a.rows]]", "x = 2"]


def test_what_toml_does_not_know_is_refused() -> None:
    with pytest.raises(TypeError, match="None has no form in TOML"):
        toml_text.value({"a": [None]})
