"""All pictures of a tuning, in a folder."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from greywhale.pictures.tuning import Response, cost_words, draw_convergence, draw_responses, draw_sets
from greywhale.tune.result import TuningResult


def draw(outcome: TuningResult, folder: Path) -> list[Path]:
    """Write all pictures of a tuning into `folder`; their paths."""
    joints = outcome.model.arm.joints_in_use
    drawn = [draw_sets(folder / "sets.png", outcome.before, outcome.after, joints)]
    for one in outcome.held_out:
        responses = {
            "before tuning": Response(one.time_s, one.angles_before, one.mse_before),
            "after tuning": Response(one.time_s, one.angles_after, one.mse_after),
        }
        if one.floor is not None:
            responses["floor (ideal controller)"] = Response(one.floor.time_s, one.floor.angles, one.floor.mse)
        path = folder / f"responses_{re.sub('[^a-z]+', '_', one.name)}.png"
        drawn.append(draw_responses(path, one.time_s, one.leader, responses, f"Response to {one.name}", joints))
    if outcome.curves and all(curve.cost for curve in outcome.curves):
        curves = [(np.array(one.evaluations), np.array(one.cost)) for one in outcome.curves]
        title = f"Convergence of the tuning: method {outcome.method}, strategy {outcome.strategy}"
        path = folder / "convergence.png"
        drawn.append(draw_convergence(path, curves, title, cost_words(outcome.method), joints))
    return drawn
