"""Measures of following: the paper's measures, overshoot, settling time, swings."""

from greywhale.measure.evaluate import Evaluation, JointMeasures, evaluate, more_overshoot

__all__ = ["Evaluation", "JointMeasures", "evaluate", "more_overshoot"]
