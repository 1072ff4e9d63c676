"""What trials tell the next round: their logs, and a plant that hunts as the arm did."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greywhale.arm.plants import column, plant_row
from greywhale.commission.evidence import Evidence, failing_plants, to_fit, to_validate
from greywhale.commission.journal import CommissioningJournal
from greywhale.commission.motions import check_motion
from greywhale.commission.trials import Trials
from greywhale.files.arm import default_arm
from greywhale.files.log import read_log
from greywhale.loop.controllers import controllers_of
from tests.commission.test_trials import BETTER, play, play_before, stiffer
from tests.support.arms import make_arm
from tools.support.simulated_rig import ROOM, SimulatedRig

pytestmark = pytest.mark.slow
JOINT = 2


def test_the_plant_that_shows_the_hunting_is_the_model_with_one_change(tmp_path: Path) -> None:
    rig = SimulatedRig(make_arm(joint_2={"gear": {"half_gap": 0.02}}))
    with CommissioningJournal(tmp_path, {}, resume=False) as journal:
        trials = Trials(journal, check_motion(ROOM), rig.before)
        play_before(trials, rig)
        trial = play(trials, rig, stiffer(trials, [JOINT], 12.0))
        assert trial.verdicts[JOINT].hunts
    model = default_arm()
    plants = failing_plants(model, trials)
    assert len(plants) == sum(one.hunts for one in trial.verdicts)
    mine = plants[[one.joint for one in trial.verdicts if one.hunts].index(JOINT)]
    changed = np.flatnonzero(mine != plant_row(model))
    assert len(changed) == 1
    assert changed[0] in [column(name, JOINT) for name in ("pot_play", "half_gap")]


def test_an_arm_that_rests_gives_no_such_plant(trials: Trials, rig: SimulatedRig) -> None:
    play_before(trials, rig)
    assert play(trials, rig, stiffer(trials, [1], BETTER)).passed
    assert len(failing_plants(default_arm(), trials)) == 0


def test_the_best_trials_are_fitted_and_the_first_recording_validates(trials: Trials, rig: SimulatedRig) -> None:
    before = play_before(trials, rig)
    excite = Evidence((read_log(before.path),), (trials.table,))
    assert to_fit(excite, trials) == excite
    for joints in ([0], [1], [0, 1], [2]):
        play(trials, rig, stiffer(trials, joints, BETTER))
    fit, validate = to_fit(excite, trials), to_validate(trials)
    assert [log.name for log in validate.logs][:1] == [str(before.path)]
    assert len(fit.logs) == 3
    assert len({log.name for log in (*fit.logs[1:], *validate.logs)}) == 4
    for known in (fit, validate):
        for log, table in zip(known.logs, known.tables, strict=True):
            assert log.origin.param_crc == table.crc
            trial = next(one for one in trials.done if str(one.path) == log.name)
            assert np.array_equal(controllers_of(table), trial.rows)
