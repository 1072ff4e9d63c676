"""The shapes of one input's sets, and their corners."""

from __future__ import annotations

from collections.abc import Sequence

from greywhale.base.types import Controllers
from greywhale.fuzzy.settings import SET_UNIT
from greywhale.loop import CONTROLLER_COLUMNS
from greywhale.pictures import looks
from greywhale.pictures.plotting import Axes

# Of the error and of its change: left, the middle's two, right.
_CORNERS = ("ne_c", "ze_a", "ze_c", "pe_b"), ("nce_c", "zce_a", "zce_c", "pce_b")


def corners_of(controllers: Controllers, joint: int, change: bool) -> tuple[float, ...]:
    """The corners of one input's sets: of the error, or of its change."""
    columns = map(CONTROLLER_COLUMNS.index, _CORNERS[change])
    return tuple(float(controllers[joint, column]) / SET_UNIT for column in columns)


def draw_shapes(
    axes: Axes, corners: Sequence[float], look: looks.Look, names: Sequence[str | None] = (None,) * 3
) -> None:
    """NE [-1,-1,left,0], ZE [a,0,c], PE [0,right,1,1]: every foot is at zero. `names` are for a legend."""
    left, a, c, right = corners
    shapes = (
        ([-1.0, left, 0.0], [1.0, 1.0, 0.0]),
        ([a, 0.0, c], [0.0, 1.0, 0.0]),
        ([0.0, right, 1.0], [0.0, 1.0, 1.0]),
    )
    for (x, y), colour, name in zip(shapes, looks.SIGNS, names, strict=True):
        axes.plot(x, y, label=name, **looks.Look(colour, look.style, look.width).line)
