"""A joint of a URDF and the body that it moves, in the base's frame."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from greywhale.base.types import Floats


@dataclass
class Body:
    """Links that move as one: mass (kg), centre of mass (3,) m, inertia (3, 3) kg m² about it, axes of the base."""

    names: list[str] = field(default_factory=list)
    mass: float = 0.0
    centre: Floats = field(default_factory=lambda: np.zeros(3))
    inertia: Floats = field(default_factory=lambda: np.zeros((3, 3)))

    def add(self, name: str, mass: float, centre: Floats, inertia: Floats) -> None:
        """Weld a link to it."""
        self.names.append(name)
        if mass <= 0.0:
            return
        both = self.mass + mass
        middle = (self.mass * self.centre + mass * centre) / both
        self.inertia = (
            self.inertia + _parallel(self.mass, self.centre - middle) + inertia + _parallel(mass, centre - middle)
        )
        self.mass, self.centre = both, middle


@dataclass(frozen=True)
class TurningJoint:
    """A joint that turns: a point on its axis and the axis (3,), in the base's frame; the body that it moves.

    `low` and `high` are its limits (rad), those of a joint that is `endless` two turns apart. `effort` (N m) and
    `velocity` (rad/s) are 0 where they are not known, `friction` (N m) and `damping` (N m s) NaN where not given.
    """

    name: str
    point: Floats
    axis: Floats
    low: float
    high: float
    effort: float
    velocity: float
    friction: float
    damping: float
    body: Body
    endless: bool = False


def _parallel(mass: float, away: Floats) -> Floats:
    """The inertia that a mass adds about a point so far from it (Steiner)."""
    return mass * (float(away @ away) * np.eye(3) - np.outer(away, away))
