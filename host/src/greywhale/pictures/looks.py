"""The look of each thing, in every picture alike: leader, follower, before, after, model, voltage, floor.

The colours are Okabe and Ito's: told apart by colour-blind readers too.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

DARK, GREY, ORANGE, BLUE, GREEN = "#222222", "#888888", "#D55E00", "#0072B2", "#009E73"
PURPLE, AMBER, SKY = "#CC79A7", "#E69F00", "#56B4E9"


@dataclass(frozen=True)
class Look:
    """A line's colour, style and width in points."""

    colour: str
    style: str = "-"
    width: float = 1.0

    @property
    def line(self) -> dict[str, Any]:
        """For Matplotlib's `plot`."""
        return {"color": self.colour, "linestyle": self.style, "linewidth": self.width}

    def thin(self, width: float = 0.7) -> Look:
        """This look with a thinner line, for strips and for lines behind others."""
        return replace(self, width=width)


LEADER = Look(DARK, width=1.3)
FOLLOWER = Look(BLUE)  # as recorded
BEFORE = Look(ORANGE)
AFTER = Look(BLUE)
VOLTAGE = Look(PURPLE, width=0.7)
VOLTAGE_LIMIT = Look(DARK, ":", 0.9)
MODEL = Look(GREEN)
WHITE_BOX = Look(GREY)  # the arm file that an identification begins with
FLOOR = Look(DARK, "--", 0.9)
PAPERS_METHOD = Look(AMBER)
PRINTED = Look(SKY, "-.")
# The followers of several logs in one picture. Two are most often before and after.
FOLLOWERS = (BEFORE, AFTER, PAPERS_METHOD, replace(PRINTED, style="-"))
# Sets: negative, zero and positive, as on a control surface.
SIGNS = (ORANGE, DARK, BLUE)
SETS_BEFORE, SETS_AFTER = Look(GREY, "--", 0.8), Look(GREY, "-", 1.3)
