"""The motions that a person at the bench can make without a file, by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from greywhale.files.trajectory import Trajectory
from greywhale.loop import human_reaches, multi_steps


@dataclass(frozen=True)
class Motion:
    """A motion: `title` names it on a page."""

    title: str
    make: Callable[[], Trajectory]


MOTIONS = {
    "reaches": Motion("Reach here and there", human_reaches),
    "steps": Motion("Take the paper's steps", multi_steps),
}
