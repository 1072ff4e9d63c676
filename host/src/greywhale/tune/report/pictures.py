"""All pictures of a tuning, in a folder."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from greywhale.pictures.page import save_into, style
from greywhale.pictures.tuning import Response, cost_words, plot_convergence, plot_responses, plot_sets
from greywhale.tune.result import TuningResult


def draw(outcome: TuningResult, folder: Path) -> list[Path]:
    """Write all pictures of a tuning into `folder`; their paths."""
    joints = outcome.model.arm.joints_in_use
    with style():
        drawn = [save_into(plot_sets(outcome.before, outcome.after, joints), folder, "sets.png")]
        for one in outcome.held_out:
            responses = {
                "before tuning": Response(one.time_s, one.angles_before, one.mse_before),
                "after tuning": Response(one.time_s, one.angles_after, one.mse_after),
            }
            if one.floor is not None:
                responses["floor (ideal controller)"] = Response(one.floor.time_s, one.floor.angles, one.floor.mse)
            figure = plot_responses(one.time_s, one.leader, responses, f"Response to {one.name}", joints)
            drawn.append(save_into(figure, folder, f"responses_{re.sub('[^a-z]+', '_', one.name)}.png"))
        if outcome.curves and all(curve.cost for curve in outcome.curves):
            curves = [(np.array(one.evaluations), np.array(one.cost)) for one in outcome.curves]
            title = f"Convergence of the tuning: method {outcome.method}, strategy {outcome.strategy}"
            figure = plot_convergence(curves, title, cost_words(outcome.method), joints)
            drawn.append(save_into(figure, folder, "convergence.png"))
    return drawn
