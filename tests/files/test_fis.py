"""A .fis is read as it is: what greywhale wrote, what others write, and what is broken."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from greywhale.base.errors import UserError
from greywhale.files import fis
from greywhale.fuzzy.header_proof import require_no_hole
from greywhale.fuzzy.import_fis import firmware_obstacles
from greywhale.fuzzy.table_law import from_fis
from tools.support.fis_files import WILD, table, uneven

GOOD = table(3)


@pytest.mark.parametrize("name", WILD)
def test_the_wild_is_read_and_the_line_is_named_that_no_header_takes(name: str) -> None:
    change, words = WILD[name]
    found = fis.parse(change(GOOD))
    assert firmware_obstacles(found)
    with pytest.raises(UserError) as caught:
        require_no_hole(from_fis(found, "wild.fis"))
    assert words in caught.value.message


def test_numbers_names_and_lines() -> None:
    found = fis.parse(table(5))
    assert [len(one.sets) for one in (*found.inputs, *found.outputs)] == [5, 5, 5]
    first = found.inputs[0].sets[0]
    assert (first.name, first.kind, first.numbers) == ("S0", "trimf", (-4.5, -3.0, -1.5))
    assert table(5).split("\n")[first.line - 1].startswith("MF1='S0'")
    assert len(found.rules) == 25
    assert found.remarks == ()


def test_what_is_odd_is_told_and_read_all_the_same() -> None:
    text = GOOD.replace("MF1='S0':'trimf',[-6", "MF1='S0:'trimf',[-6").replace("NumRules=9", "NumRules=8")
    found = fis.parse("% a comment\n" + text.replace("\n", "\r\n"))
    assert found.inputs == fis.parse("\n" + GOOD).inputs
    assert [remark.partition(":")[0] for remark in found.remarks] == ["line 19", "line 8"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[System]", "[Input1]", "Input1] is there twice"),
        ("[-6 -3 0]", "[-6 x 0]", "line 18: 'x' is not a number"),
        ("[-6 -3 0]", "[-6 nan 0]", "line 18: 'nan' is not a number"),
        ("[-6 -3 0]", "[-6 1e999 0]", "line 18: '1e999' is not a number"),
        ("Range=[-3 3]", "Range=[3 -3]", "line 16: [Input1] needs Range=[low high]"),
        ("MF2='S1'", "MF4='S1'", "the sets of [Input1] must be MF1"),
        ("1 1, 1 (1) : 1", "1 1 1 (1) : 1", "line 39: '1 1 1 (1) : 1' is no rule"),
        ("1 1, 1 (1) : 1", "1 9, 1 (1) : 1", "line 39: set 9 of 'change', which has 3"),
        ("1 1, 1 (1) : 1", "1, 1 (1) : 1", "line 39: the rule '1, 1 (1) : 1' names 1 input where the file has 2"),
        ("[Output1]", "[Output2]", "its outputs must be [Output1]"),
        ("[System]", "time_s,joint0", "line 1: 'time_s,joint0' stands before [System]"),
    ],
)
def test_what_cannot_be_read_names_its_line(old: str, new: str, words: str) -> None:
    with pytest.raises(UserError) as caught:
        fis.parse(GOOD.replace(old, new, 1))
    assert words in caught.value.message


@given(
    at=st.integers(0, len(GOOD)),
    length=st.integers(0, 40),
    put=st.one_of(st.text(max_size=12), st.sampled_from(["[", "]", "'", "=", "MF9=", "-1e308 ", "0 ", "\n[Rules]\n"])),
)
@example(at=0, length=len(GOOD), put="")
def test_no_broken_file_is_more_than_one_sentence(at: int, length: int, put: str) -> None:
    text = GOOD[:at] + put + GOOD[at + length :]
    with suppress(UserError):
        found = fis.parse(text)
        firmware_obstacles(found)
        from_fis(found, "broken.fis")


def test_any_bytes(tmp_path: Path) -> None:
    path = tmp_path / "old.fis"
    path.write_bytes(uneven().replace("table3", "Regler für Öl").encode("latin-1"))
    assert fis.load(path).name == "Regler für Öl"
    path.write_bytes(b"\xef\xbb\xbf" + GOOD.encode())
    assert fis.load(path).name == "table3"
    path.write_bytes(b"[System]\n" + b"%" * fis.LONGEST_TEXT)
    with pytest.raises(UserError, match="longer than"):
        fis.load(path)
