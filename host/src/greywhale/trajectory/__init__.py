"""Leader motion: what a person's hand does to the leader arm, recorded or generated."""

from greywhale.trajectory.generate import human_reaches, multi_steps, steps
from greywhale.trajectory.motion import POT_RANGE_RAD, Trajectory

__all__ = [
    "POT_RANGE_RAD",
    "Trajectory",
    "human_reaches",
    "multi_steps",
    "steps",
]
