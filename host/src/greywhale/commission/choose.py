"""The end of a commissioning: each joint's best, tried together on the arm; where that is worse, joints step back."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from greywhale.commission.rig import Rig
from greywhale.commission.search import JointSearch
from greywhale.commission.trials import Controllers, Trial, Trials
from greywhale.loop.controllers import controllers_of

MOST_CONFIRMATIONS = 4


def confirm(trials: Trials, searches: Sequence[JointSearch], arm: Callable[[], Rig]) -> Trial:
    """The best set that passed as a whole. A combination that was not measured is played before it counts."""
    places = [0] * len(searches)
    for _ in range(MOST_CONFIRMATIONS):
        rows = _combined(trials, searches, places)
        known = next((one for one in trials.done if np.array_equal(one.rows, rows)), None)
        trial = known or trials.play(None if trials.known() else arm(), rows)
        if trial.passed:
            break
        for verdict in trial.verdicts:
            if verdict.faults:
                places[verdict.joint] += 1
    return trials.passing()[0]


def _combined(trials: Trials, searches: Sequence[JointSearch], places: Sequence[int]) -> Controllers:
    """For each joint its best, or as many places further down as it failed; after the last, the one from before."""
    rows = controllers_of(trials.table).copy()
    for search, place in zip(searches, places, strict=True):
        ranked = search.ranked()
        if place < len(ranked):
            rows[search.joint] = ranked[place].row
    return rows
