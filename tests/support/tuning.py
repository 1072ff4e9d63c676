"""Models and tunings in little time: what fits are off is measured on one log, motions and judgements are short, and
what is possible is worked out once for all tests.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
import pytest

from greywhale.identify import bootstrap, sampled_plants
from greywhale.loop import human_reaches
from greywhale.tune import default, model
from greywhale.tune.judge import held_out
from greywhale.tune.judge.margins import REST_S, Margins
from greywhale.tune.possible import scale_of
from greywhale.tune.search import lockstep, training
from greywhale.tune.search.objective import ErrorScale
from greywhale.tune.search.training import TrainingMotion

_known: dict[bytes, ErrorScale] = {}


def shorten(patch: pytest.MonkeyPatch) -> None:
    def shared(
        drills: Sequence[TrainingMotion], plants: np.ndarray, before: np.ndarray, threads: int = 0
    ) -> ErrorScale:
        arrays = [
            plants,
            before,
            *(array for drill in drills for array in (drill.motion.angles, drill.experiment.weight_s)),
        ]
        key = b"".join(array.tobytes() for array in arrays)
        if key not in _known:
            _known[key] = scale_of(drills, plants, before, threads)
        return _known[key]

    patch.setattr(bootstrap, "LOGS", 1)
    patch.setattr(lockstep, "KEPT", 2)  # two candidates a joint are enough to try the last judgement,
    patch.setattr(default, "CALMER", default.CALMER[::4])  # and of those with less voltage or integral three
    patch.setattr(training, "moves", partial(training.moves, hold_s=0.6))
    patch.setattr(training, "HUMAN_S", 3.0)
    patch.setattr(training, "SLOW_S", 4.0)
    patch.setattr(default, "scale_of", shared)
    patch.setattr(default, "REST_LONG_S", REST_S)
    patch.setattr(held_out, "human_reaches", lambda seed, seconds: human_reaches(seed, 5.0))


def judge_nothing(patch: pytest.MonkeyPatch) -> None:
    """For tests of what is chosen: nothing is said of its margins and of motions on which nothing was tuned."""
    patch.setattr(Margins, "check", lambda margins, controllers: ())
    patch.setattr(default, "judge_held_out", lambda *arguments: ())


def few_plants(patch: pytest.MonkeyPatch) -> None:
    """For tests of more than a tuning: a model stands for few arms beside its own."""
    patch.setattr(model, "sampled_plants", lambda arm, samples, seed: sampled_plants(arm, min(samples, 2), seed))
