"""Short commissionings on a simulated rig, that begin with a model of the default arm."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.base.study.side_job import side_jobs
from greywhale.commission import CommissioningRequest, foresee, learn, run
from greywhale.commission.search import CheckOnModel
from greywhale.files.trajectory import Trajectory
from greywhale.loop import multi_steps
from greywhale.protocol.table import CONTROLLER_COLUMNS
from greywhale.tune import TuningResult
from greywhale.tune.model import Model
from tests.tune.models import tuned, write_model
from tools.support.simulated_rig import SimulatedRig

KP, KD, KI = (CONTROLLER_COLUMNS.index(name) for name in ("kp", "kd", "ki"))


def options_in(folder: Path) -> Callable[..., CommissioningRequest]:
    """Makes the options of a short commissioning in a folder; it begins with a model of the default arm."""
    model = write_model(folder / "model.toml")

    def make(**changes: Any) -> CommissioningRequest:
        given: dict[str, Any] = {
            "port": "port",
            "out": folder / "out",
            "model": model,
            "rounds": 1,
            "trials": 4,
            "budget": 12,
        }
        return CommissioningRequest(**given | changes)

    return make


def in_no_time(rig: SimulatedRig, patch: pytest.MonkeyPatch) -> None:
    """No board; controllers are found at once, twice as stiff, and too stiff for joint 2; few steps are foreseen; what
    failed on the arm comes back half as stiff.
    """

    def tune(model: Model, *, start: np.ndarray, **options: object) -> TuningResult:
        rows = start.copy()
        rows[:, [KP, KI]] *= 2
        rows[:, KD] = np.rint(1.4 * rows[:, KD])
        rows[2, KP] *= 10
        return tuned(model, start, rows)

    def search(check: CheckOnModel, begin: np.ndarray, vary: np.ndarray, *options: object) -> np.ndarray:
        rows = begin.copy()
        rows[vary, KP] //= 1 if vary.all() else 2
        return rows

    patch.setattr(run, "connected", rig.connected)
    patch.setattr(run, "side_jobs", partial(side_jobs, here=True))  # another process knows of no patch
    patch.setattr(learn, "tune", tune)
    patch.setattr(CheckOnModel, "search", search)
    steps = multi_steps()
    few = Trajectory(steps.time_s[steps.time_s < 4.0], steps.angles[steps.time_s < 4.0])
    patch.setattr(foresee, "multi_steps", lambda: few)
