"""How well the follower followed: the paper's measures, overshoot and settling time, per joint and in total."""

from greywhale.measure.compare import more_overshoot
from greywhale.measure.evaluate import Evaluation, JointMeasures, evaluate
from greywhale.measure.settings import Settings

__all__ = ["Evaluation", "JointMeasures", "Settings", "evaluate", "more_overshoot"]
