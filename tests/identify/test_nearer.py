"""A torque per volt that a fit took far from the arm file's comes back, unless the log tells it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.base.types import show_no_progress
from greywhale.files.arm import load_arm
from greywhale.identify import search
from greywhale.identify.candidate import Candidate
from greywhale.identify.data import prepare
from greywhale.identify.limits import IDENTIFICATION_LIMITS
from greywhale.identify.nearer import far_joints
from greywhale.identify.space import KINDS, Parameter, Space
from greywhale.loop import human_reaches
from tests.identify.conftest import alone
from tools.support.recordings import record, table_of

# A model of the default arm's roll, as a search once found it: it explains all motion as well with five times the
# torque, teeth that hardly bend and much load friction.
ASTRAY = {"alpha": 1.57, "inertia": 0.0394, "damping": 0.848, "coulomb": 0.409, "breakaway": 0.377, "stribeck": 0.078}
ASTRAY |= {"gap": 0.00603, "drag": 0.0036, "teeth": 0.00315, "load": 0.489}
ROLL = 3


@pytest.mark.slow
def test_a_light_link_does_not_lead_its_torque_astray(
    white_box: ArmParameters, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(search, "TURNS", ((),))  # no other quantities are tried
    arm = load_arm("default")
    log = record(arm, alone(human_reaches(33, 12.0), (ROLL,)), tmp_path / "fit.csv", table_of("before_tuning"))
    space = Space.of(white_box, tuple(ASTRAY), (ROLL,))
    begun = Candidate(space, np.array([KINDS[kind].to_search(value) for kind, value in ASTRAY.items()]), "", 0.0)

    def found(far: float) -> float:
        limits = replace(IDENTIFICATION_LIMITS, search=replace(IDENTIFICATION_LIMITS.search, far_doubts=far))
        one = search.Search(white_box, [prepare(log, 1, limits)], (), (ROLL,), 0, show_no_progress, best=begun)
        one.run()
        assert one.best is not None
        return float(np.exp(one.best.x[0]))

    true = float(np.exp(Space.of(arm, ("alpha",), (ROLL,)).start()[0]))
    assert found(np.inf) < 0.3 * true  # on its own it does not come back
    # By six other motions it comes back to 0.9 to 1.3 times the true one.
    assert found(IDENTIFICATION_LIMITS.search.far_doubts) == pytest.approx(true, rel=0.5)


def test_only_torques_beyond_the_arm_files_interval_are_far_and_pitch_joints_go_together(
    white_box: ArmParameters,
) -> None:
    space = Space.of(white_box, ("alpha", "inertia"), range(4))
    x = space.start()
    for joint, kind, doubts in ((0, "alpha", 1.6), (1, "alpha", -1.7), (3, "inertia", 3.0)):
        index = space.parameters.index(Parameter(joint, kind))
        x[index] += doubts * space.doubts()[index]
    assert far_joints(Candidate(space, x, ""), IDENTIFICATION_LIMITS.search) == [1, 2]
