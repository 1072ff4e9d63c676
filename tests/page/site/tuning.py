"""A small tuning by greywhale tune's own search, on the motions as a page has them, for the page's search to repeat."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greywhale.base.types import Controllers, Floats
from greywhale.files.trajectory import Trajectory
from greywhale.loop import experiment
from greywhale.protocol.table import CONTROLLER_COLUMNS
from greywhale.tune import default
from greywhale.tune.limits import WITHOUT_FLOORS
from greywhale.tune.model import load_model
from greywhale.tune.request import TuningRequest
from greywhale.tune.search.journal import TuningJournal
from tools.site.tuner_data import SEED, page_slices

PACK, BUDGET = 4, 40  # every stage has more than its first pack where it can


def straight(motion: Trajectory, wait_s: float, resample: bool = False) -> Floats:
    return page_slices(motion, wait_s)


def tuning() -> dict[str, Any]:
    """What was found on the way, and which joints of three controllers fall short of the standard."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(experiment, "leader_slices", straight)
        patch.setattr(default, "PACK", PACK)
        model = load_model("default", force=True)
        method = default.DefaultMethod(
            TuningRequest(
                model=model,
                strategy="both",
                method="default",
                budget=BUDGET,
                seed=SEED,
                threads=1,
                before=model.controllers,
                bounds={},
                report=lambda *_, **__: None,
                judging=WITHOUT_FLOORS,
            )
        )
        with TuningJournal(None, {}) as journal:
            method.search(journal)
        judged = np.stack([model.controllers, method.found.best, restless(model.controllers)])
        short = method.standard.falls_short(
            method.judging_margins.unrest(judged, exact=True), (judged == model.controllers).all(axis=2)
        )
    return {
        "pack": PACK,
        "budget": BUDGET,
        "before": model.controllers.tolist(),
        "best": method.found.best.tolist(),
        "curve": method.found.curve,
        "judged": judged.tolist(),
        "short": [np.flatnonzero(row).tolist() for row in short],
    }


def restless(controllers: Controllers) -> Controllers:
    """The same with a Kd that magnifies noise on two joints."""
    changed = controllers.copy()
    changed[:2, CONTROLLER_COLUMNS.index("kd")] *= 12
    return changed
