"""How well the follower followed: the paper's three measures, per joint and in total."""

from greywhale.measure.evaluate import Evaluation, JointMeasures, Settings, evaluate

__all__ = ["Evaluation", "JointMeasures", "Settings", "evaluate"]
