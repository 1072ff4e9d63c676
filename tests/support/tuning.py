"""Models and tunings in little time: what fits are off is measured on one log, motions and judgements are short, and
what is possible is worked out once for all tests.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from greywhale.identify import bootstrap, sampled_plants, search
from greywhale.loop import human_reaches
from greywhale.tune import default, model
from greywhale.tune.judge import held_out
from greywhale.tune.judge.margins import Margins
from greywhale.tune.limits import TuningLimits
from greywhale.tune.possible import scale_of
from greywhale.tune.request import TuningRequest
from greywhale.tune.search import lockstep
from greywhale.tune.search.objective import ErrorScale
from greywhale.tune.search.training import TrainingMotion

_known: dict[bytes, ErrorScale] = {}


def shorten(patch: pytest.MonkeyPatch) -> None:
    def shared(
        drills: Sequence[TrainingMotion],
        plants: np.ndarray,
        before: np.ndarray,
        threads: int,
        judging: TuningLimits,
    ) -> ErrorScale:
        arrays = [
            plants,
            before,
            *(array for drill in drills for array in (drill.motion.angles, drill.experiment.weight_s)),
        ]
        key = b"".join(array.tobytes() for array in arrays)
        if key not in _known:
            _known[key] = scale_of(drills, plants, before, threads, judging)
        return _known[key]

    patch.setattr(bootstrap, "LOGS", 1)
    patch.setattr(lockstep, "KEPT", 2)  # two candidates a joint are enough to try the last judgement,
    usual = default.DefaultMethod.__init__
    patch.setattr(
        default.DefaultMethod, "__init__", lambda self, task: usual(self, replace(task, judging=short_of(task)))
    )
    patch.setattr(default, "scale_of", shared)
    patch.setattr(held_out, "human_reaches", lambda seed, seconds: human_reaches(seed, 5.0))


def short_of(task: TuningRequest) -> TuningLimits:
    """Its limits with short motions and rests, and three candidates with less voltage or integral."""
    limits = task.judging
    return replace(
        limits,
        training=replace(limits.training, hold_s=0.6, human_s=3.0, slow_s=4.0),
        margins=replace(limits.margins, long_rest_s=limits.margins.rest_s),
        choice=replace(limits.choice, gain_reductions=limits.choice.gain_reductions[::4]),
    )


def judge_nothing(patch: pytest.MonkeyPatch) -> None:
    """For tests of what is chosen: nothing is said of its margins and of motions on which nothing was tuned."""
    patch.setattr(Margins, "check", lambda margins, controllers: ())
    patch.setattr(default, "judge_held_out", lambda *arguments: ())


def few_plants(patch: pytest.MonkeyPatch) -> None:
    """For tests of more than a tuning: a model stands for few arms beside its own."""
    patch.setattr(model, "sampled_plants", lambda arm, samples, seed: sampled_plants(arm, min(samples, 2), seed))


def few_orders(patch: pytest.MonkeyPatch) -> None:
    """For tests of more than an identification: of what a model may have beside its motors, one order is tried."""
    patch.setattr(search, "TURNS", search.TURNS[:1])
