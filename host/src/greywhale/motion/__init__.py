"""Motions of a leader, and how well the follower followed: the paper's measures, overshoot and settling time."""

from greywhale.motion.compare import more_overshoot
from greywhale.motion.evaluate import Evaluation, JointMeasures, evaluate
from greywhale.motion.generate import human_reaches, multi_steps, steps
from greywhale.motion.settings import Settings

__all__ = [
    "Evaluation",
    "JointMeasures",
    "Settings",
    "evaluate",
    "human_reaches",
    "more_overshoot",
    "multi_steps",
    "steps",
]
