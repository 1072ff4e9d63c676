"""The campaign's frame: rows add up, pieces cover the trials, and a journal goes on where it stopped."""

from __future__ import annotations

import re
from pathlib import Path

from greywhale.protocol.schema import Fault
from tools.campaign.journal import Journal, identity
from tools.campaign.page import STAGED_AS, write_page
from tools.campaign.part import Part, Row, add_up, split
from tools.campaign.staging import faults


def make_part(name: str = "none") -> Part:
    return Part(name, "Nothing at all", "Nothing.", ("Makefile",), lambda share: split(10, share, 4), lambda piece: [])


def test_rows_of_one_name_add_up() -> None:
    first = Row("a", 2, 1, {"x": 1}, {"ms": 3.0})
    second = Row("a", 3, 0, {"x": 2, "y": 5}, {"ms": 2.0, "rad": 0.1})
    other = Row("b", 1, 0)
    assert add_up([first, other, second]) == [Row("a", 5, 1, {"x": 3, "y": 5}, {"ms": 3.0, "rad": 0.1}), other]


def test_pieces_cover_the_share_and_differ_in_their_seeds() -> None:
    assert [piece["trials"] for piece in split(10, 1.0, 4)] == [4, 4, 2]
    assert len({piece["seed"] for piece in split(10, 1.0, 4)}) == 3
    assert split(10, 0.001, 4, board="mega") == [{"board": "mega", "seed": 0, "trials": 1}]


def test_a_journal_goes_on_after_a_kill_in_the_middle_of_a_line(tmp_path: Path) -> None:
    part, pieces = make_part(), split(10, 1.0, 4)
    journal = Journal(tmp_path, part)
    journal.add(pieces[0], [Row("a", 4, 0)])
    journal.add(pieces[1], [Row("a", 4, 1)])
    text = journal.path.read_text()
    journal.path.write_text(text[:-5])
    again = Journal(tmp_path, part)
    assert again.missing(pieces) == pieces[1:]
    again.add(pieces[2], [Row("a", 2, 0)])
    assert add_up(Journal(tmp_path, part).rows(pieces)) == [Row("a", 6, 0)]


def test_the_identity_follows_what_a_part_depends_on() -> None:
    here = make_part()
    there = Part("none", here.title, here.holds, ("README.md",), here.pieces, here.run)
    assert identity(here) == identity(make_part()) != identity(there)


def test_the_page_shows_every_violation() -> None:
    page = write_page([(make_part(), [Row("a | b", 1000, 2, {"fault": 3}, {"ms": 1.5})])])
    assert "| [Nothing at all](#nothing-at-all) | 1,000 | 2 |" in page
    assert "**2** | 1.5 ms | fault 3 |" in page


def test_the_page_lists_the_faults_with_their_times_on_both_boards() -> None:
    part = Part("faults", "Faults", "", ("Makefile",), lambda share: [], lambda piece: [])
    rows = [Row(f"{board}: {staged}", 5, 0, {}, {"ms": 3.25}) for board in ("mega", "nano") for staged in faults()]
    page = write_page([(part, rows)])
    for name in STAGED_AS:
        assert re.search(rf"\| `{name}` \| .+ \| .+ \| 3.25 \| 3.25 \|", page), name
    assert set(STAGED_AS.values()) <= set(faults())
    assert set(STAGED_AS) | {"none", "params", "tracking", "unrest"} == {fault.key for fault in Fault}
