"""A picture of visits: how far each came from where its joint was led, pose by pose, from below and from above."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from greywhale.base.errors import BadUsage
from greywhale.measure.repeatability import Repeatability
from greywhale.pictures import looks
from greywhale.pictures.page import JOINTS, WIDE, headline, leave, legend_below, save, style
from greywhale.pictures.plotting import Axes, Figure, Line2D, plt

_HEIGHT = 1.7  # of a panel in inches
_MARKS = {-1: "^", 0: "o", 1: "v"}  # it came from below, from where it was, from above
_WORDS = {-1: "from below", 0: "without a move", 1: "from above"}


def draw_repeatability(path: str | Path, measured: Mapping[str, Repeatability]) -> None:
    """Write the picture of logs by their words in the legend; the ending of `path` chooses PNG, SVG or PDF."""
    if len(measured) > len(looks.FOLLOWERS):
        raise BadUsage(f"a picture shows 1 to {len(looks.FOLLOWERS)} logs, not {len(measured)}.")
    with style():
        save(_plot(measured), Path(path))


def _plot(measured: Mapping[str, Repeatability]) -> Figure:
    joints = sorted({joint for one in measured.values() for pose in one.poses for joint in pose.joints})
    rows = (len(joints) + 1) // 2
    figure = plt.figure(figsize=(WIDE, 0.7 + rows * (_HEIGHT + 0.6)))
    headline(figure, "Visits of poses")
    sides = {
        approach.sides[0]
        for one in measured.values()
        for pose in one.poses
        for place in pose.joints.values()
        for approach in place.approaches
    }
    colours = dict(zip(measured, (look.colour for look in looks.FOLLOWERS), strict=False))
    handles = (
        {name: Line2D([], [], **_look(colour, "s")) for name, colour in colours.items()} if len(measured) > 1 else {}
    )
    handles |= {_WORDS[side]: Line2D([], [], **_look(looks.DARK, _MARKS[side])) for side in sorted(sides)}
    below = legend_below(figure, list(handles.values()), list(handles))
    grid = figure.add_gridspec(rows, 2, **leave(figure, 0.6, 0.1, 0.5 + below, 0.5), wspace=0.25, hspace=0.6 / _HEIGHT)
    for place, joint in enumerate(joints):
        axes = figure.add_subplot(grid[divmod(place, 2)])
        axes.set_title(JOINTS[joint])
        for number, (name, one) in enumerate(measured.items()):
            _draw(axes, one, joint, colours[name], (number + 0.5) / len(measured))
        axes.set_xlim(0.5, max(len(one.poses) for one in measured.values()) + 0.5)
        axes.set_xlabel("pose")
        axes.set_ylabel("off by [mrad]")
    return figure


def _draw(axes: Axes, measured: Repeatability, joint: int, colour: str, share: float) -> None:
    """The visits of a joint, at a share of the room beside each pose's number."""
    axes.axhline(0.0, color=looks.DARK, linewidth=0.5)
    axes.set_xticks(range(1, len(measured.poses) + 1))
    for number, pose in enumerate(measured.poses, 1):
        for approach in pose.joints[joint].approaches if joint in pose.joints else ():
            sizes = 1e3 * approach.deviations[:, 0]  # mrad
            axes.plot([number + 0.6 * (share - 0.5)] * len(sizes), sizes, **_look(colour, _MARKS[approach.sides[0]]))


def _look(colour: str, mark: str) -> dict[str, Any]:
    return {"color": colour, "marker": mark, "markersize": 2.5, "linestyle": "none", "fillstyle": "none"}
