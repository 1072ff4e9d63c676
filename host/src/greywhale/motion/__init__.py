"""Motions of a leader, and how well the follower followed: the paper's measures, overshoot and settling time."""

from greywhale.motion.evaluate import Evaluation, JointMeasures, evaluate, more_overshoot
from greywhale.motion.generate import human_reaches, multi_steps, steps

__all__ = [
    "Evaluation",
    "JointMeasures",
    "evaluate",
    "human_reaches",
    "more_overshoot",
    "multi_steps",
    "steps",
]
