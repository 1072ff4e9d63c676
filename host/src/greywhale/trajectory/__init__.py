"""Leader motion: what a person's hand does to the leader arm, read from a file or generated."""

from greywhale.trajectory.files import load_leader, save_leader
from greywhale.trajectory.generate import human_reaches, multi_steps, steps
from greywhale.trajectory.motion import JOINTS, POT_RANGE_RAD, Trajectory

__all__ = [
    "JOINTS",
    "POT_RANGE_RAD",
    "Trajectory",
    "human_reaches",
    "load_leader",
    "multi_steps",
    "save_leader",
    "steps",
]
