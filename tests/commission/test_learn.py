"""Learning goes to a process of its own: what it takes along is whole there, and notes nothing in the journal."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from functools import partial

from greywhale.arm.plants import PLANT_COLUMNS
from greywhale.commission import CommissioningRequest
from greywhale.commission.evidence import Evidence, failing_plants
from greywhale.commission.learn import RoundTuner
from greywhale.commission.trials import Trials
from greywhale.files.arm import default_arm
from greywhale.loop.controllers import controllers_of


def test_a_round_that_learns_goes_to_another_process(
    trials: Trials, options: Callable[..., CommissioningRequest]
) -> None:
    trials.journal.note("excite", {"log": "excite.csv"})
    failing = partial(failing_plants, trials=trials)
    start, fit = controllers_of(trials.table), Evidence((), ())
    tuner = RoundTuner(trials.journal, 1, options(), default_arm(), fit, None, start, failing)
    there = pickle.loads(pickle.dumps(tuner.tune)).__self__
    assert there.path == tuner.path
    assert there.journal.get("excite") == {"log": "excite.csv"}
    assert there.failing(there.nominal).shape == (0, len(PLANT_COLUMNS))
