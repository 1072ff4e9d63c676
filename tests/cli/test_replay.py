"""`greywhale replay steps`: the paper's motions by name, within what a board can be led along."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greywhale.board.lead import Plan
from greywhale.cli import entry
from greywhale.cli.replay import FASTEST_LED_SHARE, MOTIONS
from greywhale.protocol.firmware import FASTEST_LED_RAD_S, JOINTS, POINT_S

LIMITS = np.array([[-2.5] * JOINTS, [2.5] * JOINTS])


@pytest.mark.parametrize("name", MOTIONS)
def test_a_named_motion_is_as_fast_as_a_board_can_be_led_and_no_faster(name: str) -> None:
    plan = Plan.of(MOTIONS[name](fastest_rad_s=FASTEST_LED_SHARE * FASTEST_LED_RAD_S), np.zeros(JOINTS), LIMITS)
    fastest = np.abs(np.diff(plan.angles, axis=0)).max() / POINT_S
    assert 0.8 * FASTEST_LED_RAD_S < fastest <= FASTEST_LED_RAD_S
    assert plan.angles.max() == pytest.approx(1.0)


def test_any_other_name_is_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert entry.run(["replay", "step", "--out", str(tmp_path / "log.csv")]) == 1
    assert "step: cannot be read: no such file or directory. Did you mean steps" in capsys.readouterr().err
