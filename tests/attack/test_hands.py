"""A hand that leans on a joint and lets go: the joint is where the hand holds it, then comes back without a whip."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.files import controller
from greywhale.files.paper_tables import paper_table
from tools.attack import hands
from tools.attack.arm_faults import tuned_travel
from tools.attack.hands import TUNED, ArmAndHand, Hand
from tools.attack.parts.hands import run


@pytest.fixture(autouse=True)
def papers_controllers(monkeypatch: pytest.MonkeyPatch) -> None:
    """The paper's tuned controllers everywhere: the tuner's own take a while to find."""
    table = controller.load(paper_table("table_10")).raw_values()
    raw = {key: int(value) for key, value in table.items()} | tuned_travel()
    monkeypatch.setattr(hands, "raw_set", lambda name: raw)


@pytest.mark.slow
@pytest.mark.parametrize("board", ["mega", "nano"])
def test_a_joint_that_a_hand_lets_go_comes_back_without_a_whip(board: str) -> None:
    """At once it would come back at 3 rad/s."""
    arm = ArmAndHand(board, TUNED, np.zeros(4), 3)
    stood = float(arm.angles[0])
    assert arm.lean(Hand(0, -0.5, 400.0, 2.0), 3.0)
    assert arm.angles[0] - stood == pytest.approx(-0.5, abs=0.02)
    assert arm.let_go(0, 1.0) < 1.5
    arm.wait(2000)
    assert abs(arm.true_error[0]) < 0.05


@pytest.mark.slow
def test_each_hand_is_tried_with_untuned_and_tuned_controllers() -> None:
    rows = run({"board": "nano", "joint": 1, "seed": 1, "begin": 0, "step": 100})
    assert [row.tried for row in rows] == ["nano: shoulder pitch, untuned", "nano: shoulder pitch, tuned"]
    assert rows[1].worst["times untuned"] == pytest.approx(1.0)  # they are the same here
    assert all(row.violations == 0 and not row.counts for row in rows)
