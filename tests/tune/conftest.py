"""A tuning that nobody ran, for what is said of one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greywhale.files.trajectory import Trajectory
from greywhale.loop import default_controller
from greywhale.tune.judge.floor import Floor
from greywhale.tune.judge.held_out import HeldOut
from greywhale.tune.judge.margins import Margin
from greywhale.tune.model import load_model
from greywhale.tune.result import Curve, TuningResult
from tests.tune.models import evaluation, log_facts, tuned, write_model


@pytest.fixture
def outcome(tmp_path: Path) -> TuningResult:
    """Two held-out motions, one of which saturates nothing; a model that was not validated."""
    model = load_model(write_model(tmp_path / "model.toml", log=[log_facts()]), force=True, samples=2)
    after = default_controller()
    after[2, 8] += 1
    motion, rows = Trajectory(np.array([0.0, 1.0]), np.zeros((2, 4))), np.zeros((1, 4))
    floors = [
        Floor(np.full(4, mse), np.full(4, bound), rows[:, 0], rows, rows)
        for mse, bound in ((0.002, 0.002), (1e-7, 6e-8))
    ]
    held = [
        HeldOut(name, motion, evaluation(0.01), evaluation(0.002468), floor, rows[:, 0], rows, rows, rows)
        for name, floor in zip(("steps", "reaches"), floors, strict=True)
    ]
    margins = [Margin("at rest", joint, 0, 0.0, 0, 2) for joint in (1, 0, 2, 3)]
    return tuned(
        model,
        default_controller(),
        after,
        curves=(Curve((10,), (0.1,)),) * 4,
        margins_before=tuple(margins),
        margins=tuple(margins),
        held_out=tuple(held),
        notes=("a note",),
    )
