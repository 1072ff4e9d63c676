"""The frame of the attacks: rows add up, pieces cover the trials, and a journal goes on where it stopped."""

from __future__ import annotations

import re
from pathlib import Path

from greywhale.protocol.schema import Fault
from tools.attack.journal import Done, Journal, identity
from tools.attack.page import STAGED_AS, write_page
from tools.attack.part import Part, Piece, Row, add_up, split
from tools.attack.runner import Result, Work, do_all, in_turn
from tools.attack.staging import faults


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
    journal.add(Done(pieces[0], [Row("a", 4, 0)], 1.5))
    journal.add(Done(pieces[1], [Row("a", 4, 1)], 2.0))
    text = journal.path.read_text()
    journal.path.write_text(text[:-5])
    again = Journal(tmp_path, part)
    assert again.missing(pieces) == pieces[1:]
    again.add(Done(pieces[2], [Row("a", 2, 0)], 0.5))
    assert add_up(Journal(tmp_path, part).rows(pieces)) == [Row("a", 6, 0)]
    assert Journal(tmp_path, part).seconds(pieces) == 2.0


def test_the_identity_follows_what_a_part_depends_on() -> None:
    here = make_part()
    there = Part("none", here.title, here.holds, ("README.md",), here.pieces, here.run)
    assert identity(here) == identity(make_part()) != identity(there)


def test_the_page_shows_every_violation() -> None:
    rows = [Row("a", 1000, 2, {"fault": 3}, {"ms": 1.5})]
    page = write_page([Result(make_part(), rows, 3, 3, seconds=130.0)])
    assert "| [Nothing at all](#nothing-at-all) | 1,000 | 2 | all | 2 |" in page
    assert "| 1,000 | 2 | 2 of 3 pieces |  |" in write_page([Result(make_part(), rows, 2, 3, seconds=130.0)])
    assert "**2** | 1.5 ms | fault 3 |" in page


def test_the_page_lists_the_faults_with_their_times_on_both_boards() -> None:
    part = Part("faults", "Faults", "", ("Makefile",), lambda share: [], lambda piece: [])
    names = {staged: name for name, staged in STAGED_AS.items()}
    rows = [
        Row(f"{board}: {staged}", 5, 0, {names.get(staged, "none"): 5}, {"ms": 3.25})
        for board in ("mega", "nano")
        for staged in faults()
    ]
    page = write_page([Result(part, rows, 1, 1)])
    for name in STAGED_AS:
        assert re.search(rf"\| `{name}` \| .+ \| .+ \| 3.25 \| 3.25 \|", page), name
    assert set(STAGED_AS.values()) <= set(faults())
    mixed = Row("mega: joint blocked", 5, 0, {"stalled": 3, "speed": 2}, {"ms": 1.5})
    assert re.search(r"\| joint blocked \|  \|  \|", write_page([Result(part, [mixed], 1, 1)])), "whose time is it?"
    assert set(STAGED_AS) | {"none", "late_tick", "params", "tracking", "unrest"} == {fault.key for fault in Fault}


def double(piece: Piece) -> list[Row]:
    return [Row("doubled", piece["trials"], 0, {"sum": 2 * piece["trials"]})]


def make_work(folder: Path, name: str, total: int) -> Work:
    part = Part(name, name, "", ("Makefile",), lambda share: split(total, share, 2), double)
    return Work(part, part.pieces(1.0), Journal(folder, part))


def test_parts_advance_together(tmp_path: Path) -> None:
    works = [make_work(tmp_path, "short", 4), make_work(tmp_path, "long", 8)]
    assert [work.part.name for work, _ in in_turn(works)] == ["long", "short", "long", "long", "short", "long"]


def test_what_is_missing_is_done_once_and_kept(tmp_path: Path) -> None:
    told: list[tuple[int, int]] = []
    works = [make_work(tmp_path, "short", 4), make_work(tmp_path, "long", 8)]
    do_all(works[:1], 1, 1e9, lambda done, pieces, seconds: told.append((done, pieces)))
    do_all(works, 2, 1e9, lambda done, pieces, seconds: told.append((done, pieces)))
    assert told == [(1, 2), (2, 2), (1, 4), (2, 4), (3, 4), (4, 4)]
    again = make_work(tmp_path, "long", 8).result()
    assert (again.rows, again.whole) == ([Row("doubled", 8, 0, {"sum": 16})], True)


def make_long_work(folder: Path, share: float) -> Work:
    part = Part("long", "Long", "", ("Makefile",), lambda share: split(4, share, 2), double, longest=3.0)
    return Work(part, part.pieces(share), Journal(folder, part))


def test_a_long_run_is_done_in_pieces_here_and_elsewhere_and_adds_up(tmp_path: Path) -> None:
    here, there = tmp_path / "here", tmp_path / "there"
    do_all([make_long_work(here, 1.0)], 1, 1e9, lambda *told: None)
    result = make_long_work(here, 1.0).result()
    assert (result.whole, result.longer, result.most_longer) == (True, 0, 4)
    asked = make_long_work(here, 3.0)
    asked.journal.add(Done(asked.pieces[3], double(asked.pieces[3])))  # a piece of the long run, then the time was over
    elsewhere = make_long_work(there, 3.0)
    for piece in elsewhere.pieces[2:5]:
        elsewhere.journal.add(Done(piece, double(piece)))
    full = make_long_work(here, 1.0)
    assert full.journal.take_over(there) == 2, "the third of them is known"
    assert full.journal.take_over(there) == full.journal.take_over(tmp_path) == 0
    result = make_long_work(here, 1.0).result()
    assert (result.whole, result.longer, result.rows[0].trials) == (True, 3, 10)
    assert "| [Long](#long) | 10 | 0 | all, and 3 of 4 beyond | " in write_page([result])
    assert make_long_work(here, 3.0).result().done == 5
    assert make_long_work(here, 0.5).result().rows[0].trials == 2, "a smaller share is only itself"


def test_no_piece_is_begun_after_the_time(tmp_path: Path) -> None:
    work = make_work(tmp_path, "short", 4)
    do_all([work], 1, -1.0, lambda done, pieces, seconds: None)
    assert (work.result().done, work.result().whole) == (0, False)
