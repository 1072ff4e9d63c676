"""The last combination: a joint that is restless beside the others gets softer, and then what it had before."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np

from greywhale.commission.arm_on_port import ArmOnPort
from greywhale.commission.choose import confirm
from greywhale.commission.search import KP, JointSearch
from greywhale.commission.trials import Trial, Trials
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.table import ParameterTable
from greywhale.simulate.controllers import controllers_of
from tests.commission.test_search import verdict


class OneRestlessJoint:
    """Trials on an arm whose joint 1 is restless beside the others with all but the controller from before."""

    def __init__(self) -> None:
        self.table = ParameterTable.defaults()
        self.done: list[Trial] = []

    def known(self) -> bool:
        return True

    def play(self, rig: ArmOnPort | None, rows: np.ndarray) -> Trial:
        restless = bool((rows[1] != controllers_of(self.table)[1]).any())
        verdicts = tuple(verdict(0.1, restless=restless and joint == 1) for joint in range(JOINTS))
        trial = SimpleNamespace(rows=rows.copy(), verdicts=verdicts, bearable=not restless, name="trial")
        self.done.append(cast(Trial, trial))
        return self.done[-1]

    def ranked(self) -> list[Trial]:
        return [trial for trial in self.done if trial.bearable]


def test_a_joint_that_stays_restless_is_softened_twice_and_then_gets_its_controller_from_before() -> None:
    trials = OneRestlessJoint()
    before = controllers_of(trials.table)
    stiff = before.copy()
    stiff[:, KP] *= 2
    searches = [JointSearch(joint, trials.table.period_ms) for joint in range(JOINTS)]
    for search in searches:
        search.add(before[search.joint], verdict(1.0), "before")
        search.add(stiff[search.joint], verdict(0.1), "trial")
    best = confirm(cast(Trials, trials), searches, lambda: cast(ArmOnPort, None))
    stiffness = [trial.rows[1][KP] / before[1][KP] for trial in trials.done]
    first, softer, softest, last = stiffness
    assert first > softer > softest
    assert last == 1.0
    assert np.array_equal(best.rows[1], before[1])
    assert np.array_equal(np.delete(best.rows, 1, axis=0), np.delete(stiff, 1, axis=0))
