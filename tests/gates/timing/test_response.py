"""The tick with the interrupts that may come, from bounds that are easy to add by hand."""

from __future__ import annotations

from tools.gates.timing.image import Times

KINDS = {"tick's interrupt": 10, "start of the chain": 10, "conversion done": 20, "byte received": 50, "byte sent": 30}


def test_interrupts_add_to_the_tick_as_often_as_they_may_come() -> None:
    bounds = Times(tick=1000, interrupts=KINDS, waking=0)
    assert bounds.response(receiving=False) == 1020 + 2 * 30
    assert bounds.response(receiving=True) == 1080 + (11 + 2) * 50
    longer = Times(tick=3000, interrupts=KINDS, waking=0)
    assert longer.response(receiving=False) == 3080 + 2 * 20
    full = Times(tick=1000, interrupts=KINDS | {"byte received": 161}, waking=0)
    assert full.response(receiving=True) is None
