"""The demo's practice: a motion in which the board stopped the arm is left out, and said; the others go on."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.cli.story import practice
from greywhale.cli.story.practice import practise
from greywhale.cli.story.recorder import StoppedError
from greywhale.files.arm import load_arm
from greywhale.files.trajectory import Trajectory
from greywhale.protocol.table import ParameterTable


@pytest.mark.parametrize(
    "stops", [(), ("practice",), ("check", "check_changed"), ("practice", "check", "check_changed")]
)
def test_what_the_board_stopped_is_left_out_and_said(
    stops: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = iter(("practice", "check", "check_changed"))

    def recorded(*anything: Any) -> Any:
        name = next(names)
        if name in stops:
            raise StoppedError("it ran away; check its motor.")
        return SimpleNamespace(log=lambda: name)

    still = SimpleNamespace(motion=Trajectory(np.array([0.0, 1.0]), np.zeros((2, 4))))
    monkeypatch.setattr(practice, "design", lambda *given, **more: still)
    monkeypatch.setattr(practice, "record_with", recorded)
    monkeypatch.setattr(practice, "record_motion", recorded)
    told: list[str] = []

    def begin() -> practice.Practice:
        base = ParameterTable.defaults()
        return practise(None, load_arm("white_box"), base, tmp_path, report=lambda what, done: told.append(what))  # type: ignore[arg-type]

    if len(stops) == 3:
        with pytest.raises(UserError, match="cannot be identified.*it ran away"):
            begin()
        return
    done = begin()
    assert list(map(str, done.logs)) == [name for name in ("practice", "check", "check_changed") if name not in stops]
    assert done.left_out == tuple(f"{name}: it ran away; check its motor." for name in stops)
    assert [what for what in told if "left out" in what] == [f"left out: {reason}" for reason in done.left_out]
