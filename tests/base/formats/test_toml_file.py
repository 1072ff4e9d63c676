"""Every wrong TOML file is one sentence with file, key, value and range; what is written reads back as it was."""

from __future__ import annotations

import gc
import tomllib
import weakref
from pathlib import Path
from typing import ClassVar

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, Field, field_validator

from greywhale.base.errors import UserError
from greywhale.base.formats import toml_file, toml_text
from greywhale.base.formats.kinds import Kind
from tests.support.sentences import names


class Wheel(toml_file.Table):
    radius: float = Field(gt=0.0, le=2.0)
    spokes: int = 32


class Cart(toml_file.Table):
    name: str = ""
    wheel: tuple[Wheel, ...] = Field(min_length=1, max_length=2)


class Mast(toml_file.Table):
    kinds: ClassVar = (Kind.ARM, Kind.MODEL)

    height: float


class Even(toml_file.Table):
    spokes: int

    @field_validator("spokes")
    @classmethod
    def _even(cls, spokes: int) -> int:
        raise ValueError("an even number")


class Loose(BaseModel):
    """A model that itself would let anything in."""

    value: float = 0.0


GOOD = "[[wheel]]\nradius = 0.5\n"


@pytest.mark.parametrize(
    ("text", "things"),
    [
        ("[[wheel]]\nradius = 3\n", "wheel[0].radius 3 0 2"),
        ('[[wheel]]\nradius = "1"\n', 'wheel[0].radius "1" number'),
        ("[[wheel]]\nradius = true\n", "wheel[0].radius true number"),
        ("[[wheel]]\nradius = nan\n", "wheel[0].radius nan finite"),
        ("[[wheel]]\nspokes = 3\n", "wheel[0].radius missing"),
        (GOOD + "spokes = 1979-05-27\n", "wheel[0].spokes date"),
        (GOOD + "spokes = 1.5\n", "wheel[0].spokes 1.5 integer"),
        (GOOD + "colour = 1\n", "unknown wheel[0].colour spelling"),
        (GOOD * 3, "wheel 2"),
        ("wheel = []", "wheel 1"),
        ("radius = 3\n", "unknown radius spelling 1 more"),
        ("[[wheel]]\nraduis = 1\n", "unknown wheel[0].raduis radius 1 more"),
        ("# a log\n\ntime_s,leader_0\n0.0,1.0\n", "log CSV TOML"),
        ("radius = \n", "TOML line 1 column 10"),
    ],
)
def test_a_bad_file_is_refused_by_its_key_value_and_range(text: str, things: str) -> None:
    with pytest.raises(UserError) as caught:
        toml_file.loads(text, Cart, "f.toml")
    assert names(caught.value.message, f"f.toml: {things}")
    assert caught.value.exit_code == 1


def test_a_whole_sentence_of_a_value_out_of_range() -> None:
    with pytest.raises(UserError) as caught:
        toml_file.loads("[[wheel]]\nradius = 3\n", Cart, "f.toml")
    assert caught.value.message == "f.toml: wheel[0].radius is 3, but it must be greater than 0 and at most 2."


@pytest.mark.parametrize(
    ("text", "model", "words"),
    [
        ("[[joint]]\nkp = 1.0\n", Mast, r"a controller file, but an arm file or a model .*\(greywhale upload takes"),
        ("[[link]]\ncentre = 1.0\n", Mast, "unknown key link; remove it"),
        ("other = 1", Loose, "unknown key other"),
        ("value = inf", Loose, "value is inf"),
    ],
)
def test_another_kind_is_told_by_its_name_and_no_model_is_less_strict(
    text: str, model: type[Mast | Loose], words: str
) -> None:
    with pytest.raises(UserError, match=rf"f\.toml: .*{words}"):
        toml_file.loads(text, model, "f.toml")


def test_a_refused_file_keeps_nothing_alive() -> None:
    def refuse() -> weakref.ref[Cart]:
        held = Cart(wheel=(Wheel(radius=1.0),))
        with pytest.raises(UserError) as refused:
            toml_file.check({"spokes": 3}, Even, "a.toml")
        assert "an even number" in refused.value.message
        return weakref.ref(held)

    kept = refuse()
    gc.collect()
    assert kept() is None


def test_a_mark_that_an_editor_puts_before_the_text_is_none_of_it(tmp_path: Path) -> None:
    path = tmp_path / "marked.toml"
    path.write_bytes(b"\xef\xbb\xbf" + GOOD.encode())
    assert toml_file.load(path, Cart).wheel[0].radius == 0.5
    path.write_bytes(GOOD.replace("\n", "\r").encode())
    with pytest.raises(UserError, match="not valid TOML"):
        toml_file.load(path, Cart)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"none\.toml: .*no such file"):
        toml_file.load(tmp_path / "none.toml", Cart)
    with pytest.raises(UserError, match="cannot be read: is a directory"):
        toml_file.load(tmp_path, Cart)
    latin = tmp_path / "latin.toml"
    latin.write_bytes(b'name = "\xe4"\n')
    with pytest.raises(UserError, match="byte 8 is not UTF-8"):
        toml_file.load(latin, Cart)


@pytest.mark.parametrize(("text", "words"), [("", "it is empty;"), ("# nothing\n", "it is empty, but for comments;")])
def test_an_empty_file_is_called_empty(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "empty.toml"
    path.write_text(text)
    with pytest.raises(UserError, match=f"empty.toml: {words} choose another file"):
        toml_file.read(path)


words = st.text(st.characters(codec="utf-8"), max_size=8)
leaf = st.booleans() | st.integers(-(2**63), 2**63 - 1) | st.floats(allow_nan=False) | words
anything = st.recursive(leaf, lambda some: st.lists(some, max_size=3) | st.dictionaries(words, some, max_size=3))


@pytest.mark.slow
@given(st.dictionaries(words, anything, max_size=4))
def test_a_table_reads_back_as_it_was(content: dict[str, object]) -> None:
    assert tomllib.loads("\n".join(toml_text.table("name", content)))["name"] == content


def test_lists_of_tables_follow_the_plain_values() -> None:
    lines = toml_text.table("a", {"rows": [{"x": 1}, {"x": 2}], "empty": [], "b": 0.1})
    assert lines == ["[a]", "empty = []", "b = 0.1", "", "[[a.rows]]", "x = 1", "", "[[a.rows]]", "x = 2"]


def test_what_toml_does_not_know_is_refused() -> None:
    with pytest.raises(TypeError, match="None has no form in TOML"):
        toml_text.value({"a": [None]})
