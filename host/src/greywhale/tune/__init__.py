"""Tuning of the four controllers on an identified arm.

>>> outcome = tune(load_model("model.toml"))
>>> outcome.save("controller.toml")
"""

from greywhale.tune.outcome import Curve, HeldOut, Outcome
from greywhale.tune.space import STRATEGIES
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
