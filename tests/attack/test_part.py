"""The frame of the attacks: a part is a study whose pieces add up, and the page shows all of it."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from greywhale.base.study import TaskFailed
from greywhale.protocol.schema import Fault
from tools.attack import parts
from tools.attack.arm_faults import faults
from tools.attack.page import INJECTED_AS, write_page
from tools.attack.part import Part, Piece, Row, split
from tools.attack.run import Result, attack


def double(piece: Piece) -> list[Row]:
    return [Row("doubled", piece["trials"], 0, {"sum": 2 * piece["trials"]}, {"most": float(piece["trials"])})]


def make_part() -> Part:
    return Part("eeprom", "Nothing at all", "Nothing.", ("Makefile",), lambda share: split(10, share, 4), double)


def test_the_page_shows_every_violation() -> None:
    rows = [Row("a", 1000, 2, {"fault": 3}, {"ms": 1.5})]
    page = write_page([Result(make_part(), rows, seconds=130.0)])
    assert "| [Nothing at all](#nothing-at-all) | 1,000 | 2 | 2 |" in page
    assert "**2** | 1.5 ms | fault 3 |" in page


def test_the_page_lists_the_faults_with_their_times_on_both_boards() -> None:
    part = Part("faults", "Faults", "", ("Makefile",), lambda share: [], lambda piece: [])
    names = {injected: name for name, injected in INJECTED_AS.items()}
    rows = [
        Row(f"{board}: {injected}", 5, 0, {names.get(injected, "none"): 5}, {"ms": 3.25})
        for board in ("mega", "nano")
        for injected in faults()
    ]
    page = write_page([Result(part, rows, 60.0)])
    for name in INJECTED_AS:
        assert re.search(rf"\| `{name}` \| .+ \| .+ \| 3.25 \| 3.25 \|", page), name
    assert set(INJECTED_AS.values()) <= set(faults())
    mixed = Row("mega: motor reversed", 5, 0, {"runaway": 3, "speed": 2}, {"ms": 1.5})
    assert re.search(r"\| motor reversed \|  \|  \|", write_page([Result(part, [mixed], 60.0)])), "whose time is it?"
    assert set(INJECTED_AS) | {"none", "late_tick", "params", "tracking", "stalled", "unrest"} == {
        fault.key for fault in Fault
    }


def test_a_share_is_done_once_and_kept_until_the_code_changes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    part = make_part()
    monkeypatch.setattr(parts, "PARTS", (part,))
    result = attack(part, 1.0, 1, tmp_path)  # in pieces of 4, 4 and 2 trials
    assert result.rows == [Row("doubled", 10, 0, {"sum": 20}, {"most": 4.0})]
    monkeypatch.setattr(parts, "PARTS", ())
    assert attack(part, 1.0, 1, tmp_path) == result, "nothing is left to do"
    with pytest.raises(TaskFailed):
        attack(part, 0.5, 1, tmp_path)
    with pytest.raises(TaskFailed):
        attack(replace(part, depends=("README.md",)), 1.0, 1, tmp_path)
