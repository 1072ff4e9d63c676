"""The attacks on the line: a share of each kind."""

from __future__ import annotations

import pytest

from tools.attack.parts import link


@pytest.mark.slow
@pytest.mark.parametrize("rate", link.SESSIONS)
def test_sessions_hold(rate: int) -> None:
    faults = max(50, rate // 2)
    (row,) = link.run({"what": "session", "how": rate, "seed": 1, "trials": faults})
    assert faults <= row.trials < faults + 100, "the last turn of each session may have more than it needs"
    assert row.violations == 0
    assert row.counts["applied"] > 10
    assert row.counts["frames hit"] > faults / 2


@pytest.mark.slow
@pytest.mark.parametrize("rate", link.REPLIES)
def test_the_hosts_decoder_holds(rate: int) -> None:
    (row,) = link.run({"what": "replies", "how": rate, "seed": 1, "trials": 5000})
    assert row.violations == 0
    assert row.counts["frames"] > 1000
