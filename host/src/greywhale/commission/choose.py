"""The end of a commissioning: each joint's best, tried together on the arm; where that is worse, joints step back.

First those that fail, after softer ones where they are restless; where they have nothing else left, those beside them,
which shake them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from greywhale.commission.arm_on_port import ArmOnPort
from greywhale.commission.search import JointSearch, Row
from greywhale.commission.trials import Trial, Trials
from greywhale.simulate.controllers import controllers_of

MOST_CONFIRMATIONS = 12
SOFTENED = 2  # so often a joint that is restless beside the others gets a softer controller


def confirm(trials: Trials, searches: Sequence[JointSearch], arm: Callable[[], ArmOnPort]) -> Trial:
    """The best set that was measured as a whole. A combination that was not measured is played before it counts."""
    rows = np.array([_next(search, [], trials) for search in searches])
    failed: list[list[bytes]] = [[] for _ in searches]
    for _ in range(MOST_CONFIRMATIONS):
        known = next((one for one in trials.done if np.array_equal(one.rows, rows)), None)
        trial = known or trials.play(None if trials.known() else arm(), rows)
        if trial.bearable:
            break
        failing = np.array([verdict.known and not verdict.bearable for verdict in trial.verdicts])
        kept = (rows == controllers_of(trials.table)).all(axis=1)
        for back in (failing, ~failing & ~kept):
            stepped = rows.copy()
            for joint in np.flatnonzero(back).tolist():
                failed[joint].append(rows[joint].tobytes())
                search, verdict, softer = searches[joint], trial.verdicts[joint], None
                if verdict.restless and len(failed[joint]) <= SOFTENED:
                    softer = search.soften(rows[joint], verdict, trial.name)
                stepped[joint] = _next(search, failed[joint], trials) if softer is None else softer
            if not np.array_equal(stepped, rows):
                rows = stepped
                break
        else:
            break
    return trials.ranked()[0]


def _next(search: JointSearch, failed: Sequence[bytes], trials: Trials) -> Row:
    """A joint's best that has not failed in company; else something new; else the controller from before."""
    for one in search.ranked():
        if one.row.tobytes() not in failed:
            return one.row
    new = search.propose() if failed else None
    return controllers_of(trials.table)[search.joint] if new is None else new
