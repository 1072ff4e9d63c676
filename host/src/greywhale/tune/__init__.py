"""Tuning of the four controllers on an identified arm.

>>> outcome = tune(load_model("model.toml"))
>>> save(outcome, "controller.toml")  # of greywhale.tune.report.controller_file
"""

from greywhale.tune.judge.held_out import HeldOut
from greywhale.tune.outcome import Curve, Outcome
from greywhale.tune.search.space import STRATEGIES
from greywhale.tune.tuning import DEFAULT_BUDGET, DEFAULT_STRATEGY, METHODS, check_request, tune

__all__ = [
    "DEFAULT_BUDGET",
    "DEFAULT_STRATEGY",
    "METHODS",
    "STRATEGIES",
    "Curve",
    "HeldOut",
    "Outcome",
    "check_request",
    "tune",
]
