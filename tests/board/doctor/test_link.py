"""What the traffic of a loaded link says: anything lost or wrong is bad, slowness alone is a note."""

from __future__ import annotations

from dataclasses import replace

import pytest

from greywhale.board.doctor.finding import Verdict
from greywhale.board.doctor.link import Traffic, examine_traffic

CLEAN = Traffic(10_001, 0, 1250, 0, 0.004, 0, 0, 0)


def test_a_clean_link_is_good() -> None:
    found = examine_traffic(CLEAN, 0.3)
    assert found.verdict is Verdict.GOOD
    assert found.says == "10,001 samples and 1,250 answers at 1 Mbaud, none lost, none damaged."


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("lost", "3 samples were lost"),
        ("wrong", "3 answers were wrong"),
        ("frames_bad", "3 frames reached the board damaged"),
        ("rx_overruns", "3 times the board lost bytes"),
    ],
)
def test_each_loss_is_bad_and_counted(name: str, says: str) -> None:
    found = examine_traffic(replace(CLEAN, **{name: 3}), 0.3)
    assert found.verdict is Verdict.BAD
    assert says in found.says


def test_a_slow_answer_alone_is_a_note() -> None:
    found = examine_traffic(replace(CLEAN, slowest_s=0.6), 0.3)
    assert found.verdict is Verdict.NOTE
    assert "an answer took 0.60 s" in found.says
