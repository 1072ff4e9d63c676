"""Torques from outside for a page, of a board on the bench whose follower somebody pushes."""

from __future__ import annotations

import pytest

from greywhale.base.errors import BadUsage
from greywhale.dashboard.torque import PagesTorque, filter_shift_in
from greywhale.files.arm import load_arm
from greywhale.observe import LIVE_EVERY_TICKS
from greywhale.protocol.schema import EnableRequest
from greywhale_sim.lockstep import LockStepBench
from tests.dashboard.shared import Shared
from tools import ROOT

MODEL = load_arm(str(ROOT / "tests/observe/default_model.toml"))
PUSH_NM = 0.7  # that the motor holds against
FRAMES_AT_ONCE = 7


@pytest.mark.slow
def test_a_contact_is_told_while_it_lasts_and_afterwards(bench: LockStepBench, shared: Shared) -> None:
    bench.command("hold 20")
    page = shared.page(LIVE_EVERY_TICKS)
    shared.relay.drive(page.client)
    off = page.raw()
    shared.live(0.2, page)
    off += page.raw()
    page.ask(EnableRequest(250))
    shared.live(1.5, page)
    bench.command(f"push 0 {PUSH_NM}")
    shared.live(0.4, page)
    pushed = page.raw()
    bench.command("push 0 0")
    shared.live(0.4, page)
    released = page.raw()

    torque = PagesTorque(MODEL, 1)
    told = torque.take(off)
    assert told is not None
    assert [(one["why"], one["contact"]) for one in told["joints"]] == [("motors off", False)] * 4
    frames = [frame + b"\0" for frame in pushed.split(b"\0")[:-1]]
    pieces = [b"".join(frames[at : at + FRAMES_AT_ONCE]) for at in range(0, len(frames), FRAMES_AT_ONCE)]
    *_, told = [torque.take(piece) for piece in pieces]
    assert told is not None
    assert told["contact"] is not None
    assert told["contact"]["lasts"]
    assert told["contact"]["lasted_s"] == pytest.approx(0.4, abs=0.1), "each piece goes on where the last one ended"
    assert told["joints"][0]["torque_nm"] == pytest.approx(PUSH_NM, rel=0.3)
    assert 2 * PUSH_NM > told["contact"]["torque_nm"] >= told["joints"][0]["torque_nm"], "the largest so far"
    assert [one["contact"] for one in told["joints"]] == [True, False, False, False]
    assert told["joints"][0]["share"] == pytest.approx(PUSH_NM / 2.6, rel=0.3)
    begun = told["contact"]["tick"]
    told = torque.take(released)
    assert told is not None
    assert told["contact"] is not None
    assert (told["contact"]["tick"], told["contact"]["lasts"]) == (begun, False)
    assert torque.take(b"") is None


def test_a_filter_that_no_board_has_is_refused() -> None:
    assert filter_shift_in({"filter_shift": "1"}) == 1
    for wrong in ({}, {"filter_shift": "-1"}, {"filter_shift": "9"}, {"filter_shift": "x" * 100}):
        with pytest.raises(BadUsage, match=r"it must be one of 0, 1, 2, 3, 4\.$"):
            filter_shift_in(wrong)
