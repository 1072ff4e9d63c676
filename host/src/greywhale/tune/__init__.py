"""Tuning of the four controllers on an identified arm.

>>> outcome = tune(load_model("model.toml"))
>>> save(outcome, "controller.toml")  # of greywhale.tune.report.controller_file
"""

from greywhale.tune.judge.held_out import HeldOut
from greywhale.tune.limits import TUNING_LIMITS, TuningLimits
from greywhale.tune.result import Curve, TuningResult
from greywhale.tune.run import DEFAULT_BUDGET, DEFAULT_STRATEGY, METHODS, check_request, tune
from greywhale.tune.search.space import STRATEGIES

__all__ = [
    "DEFAULT_BUDGET",
    "DEFAULT_STRATEGY",
    "METHODS",
    "STRATEGIES",
    "TUNING_LIMITS",
    "Curve",
    "HeldOut",
    "TuningLimits",
    "TuningResult",
    "check_request",
    "tune",
]
