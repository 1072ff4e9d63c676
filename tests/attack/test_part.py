"""The page of the attacks lists every fault that the board can report."""

from __future__ import annotations

import re

from greywhale.protocol.schema import Fault
from tools.attack.arm_faults import faults
from tools.attack.page import INJECTED_AS, write_page, write_table
from tools.attack.part import STAYED_ON, Part, Row
from tools.attack.run import Result


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
        assert re.search(rf"\| `{name}` \| .+ \| 3.25 \|", page), name
    assert set(INJECTED_AS.values()) <= set(faults())
    assert "In each row: 0 violations, 3.25 ms worst." in page
    assert "| leader open 2 of 3, 1 of 2, 2 of 4, 2 of 10 ms | 20 | none 20 |" in page
    apart = [Row(f"{board}: motor reversed", 5, n, {"runaway": 4 + n}, {}) for n, board in enumerate(("mega", "nano"))]
    assert "| motor reversed | 5 | 0/**1** |  | runaway 4/5 |" in write_page([Result(part, apart, 60.0)])
    kept = [Row("nano: motor reversed", 5, 1, {"runaway": 4, STAYED_ON: 1}, {})]
    assert "| nano: motor reversed | 5 | **1** |  | runaway 4 |" in write_page([Result(part, kept, 60.0)])
    mixed = Row("mega: motor reversed", 5, 0, {"runaway": 3, "speed": 2}, {"ms": 1.5})
    assert re.search(r"\| motor reversed \|  \|", write_page([Result(part, [mixed], 60.0)])), "whose time is it?"
    assert set(INJECTED_AS) | {"none", "late_tick", "params", "tracking", "stalled", "unrest"} == {
        fault.key for fault in Fault
    }


def test_two_cases_of_everything_stand_side_by_side() -> None:
    rows = [Row(f"{what}, {case}", 5, 0, {}, {"ms": ms}) for what, ms in (("a", 1), ("b", 2)) for case in ("on", "off")]
    assert "| tried | worst, on | worst, off |" in write_table(rows)
    assert "| b | 2 ms | 2 ms |" in write_table(rows)
    assert "| b, off | 2 ms |" in write_table([*rows, Row("c", 5, 0, {}, {"ms": 3})])
