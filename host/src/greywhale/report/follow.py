"""One picture of leader against follower: a panel a joint with a strip of the error below it, for one log or several.

Where several logs (before and after tuning) have the same motion, the leader is drawn once. The same logs give the same
file, byte for byte: no display, no date and no random identifier goes into it.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from greywhale.errors import BAD_USAGE, UserError
from greywhale.files.log import Log
from greywhale.formats.whole import write_whole
from greywhale.measure import evaluate

Floats = NDArray[np.float64]

JOINT_NAMES = ("base yaw", "shoulder pitch", "wrist pitch", "wrist roll")
# The formats, and the entry of each that would make two pictures of the same logs differ.
_CHANGING = {".png": "Software", ".svg": "Date", ".pdf": "CreationDate"}
FORMATS = tuple(_CHANGING)
_LEADER_COLOUR = "#222222"
# Okabe and Ito's palette: told apart by colour-blind readers too.
_COLOURS = ("#D55E00", "#0072B2", "#009E73", "#CC79A7")
# Leaders closer than this everywhere (rad) are drawn as one line.
_SAME_LEADER = 0.05
_MOST_LOGS = len(_COLOURS)


@dataclass(frozen=True)
class Trace:
    """The measured part of a log with the word it has in the legend; time starts at 0."""

    label: str
    time: Floats
    leader: Floats
    follower: Floats
    mse: tuple[float, ...]


def trace(log: Log, label: str) -> Trace:
    """The part of a log in which the motors followed (all of it if they never did)."""
    following = log.state == "following"
    part = following if following.any() else np.ones(len(log.time), dtype=bool)
    time = log.time[part]
    measures = evaluate(log)
    return Trace(
        label, time - time[0], log.leader[part], log.follower[part], tuple(joint.mse for joint in measures.joints)
    )


def draw_following(path: str | Path, traces: Sequence[Trace], title: str) -> None:
    """Write the picture; the ending of `path` chooses PNG, SVG or PDF."""
    target = Path(path)
    if target.suffix.lower() not in FORMATS:
        raise UserError(f"{path}: pictures end in {', '.join(FORMATS)}.", exit_code=BAD_USAGE)
    if not 1 <= len(traces) <= _MOST_LOGS:
        raise UserError(f"a picture shows 1 to {_MOST_LOGS} logs, not {len(traces)}.", exit_code=BAD_USAGE)
    with set_style():
        figure = plot_following(traces, title)
        kind = target.suffix.lower()
        try:
            write_whole(
                target,
                lambda file: figure.savefig(file, format=kind[1:], dpi=150, metadata={_CHANGING[kind]: None}),
            )
        finally:
            plt.close(figure)


def set_style() -> AbstractContextManager[None]:
    """Matplotlib's settings for this picture, for as long as the context lasts."""
    return matplotlib.rc_context({"svg.hashsalt": "greywhale", "font.size": 9, "axes.grid": True, "grid.alpha": 0.3})


def plot_following(traces: Sequence[Trace], title: str) -> Figure:
    """What `draw_following` writes, as a figure of pyplot's that the caller closes."""
    # Fixed margins: a layout solver's result differs in the last digits from run to run.
    figure = plt.figure(figsize=(11.0, 8.6))
    figure.suptitle(title, fontsize=12, fontweight="bold", y=0.98)
    grid = figure.add_gridspec(2, 2, left=0.082, right=0.985, bottom=0.1, top=0.915, wspace=0.2, hspace=0.3)
    shared_leader = _same_leader(traces)
    for joint in range(len(JOINT_NAMES)):
        rows = grid[divmod(joint, 2)].subgridspec(2, 1, height_ratios=(3, 1), hspace=0.08)
        angle = figure.add_subplot(rows[0])
        error = figure.add_subplot(rows[1], sharex=angle)
        angle.tick_params(labelbottom=False)
        _draw_angle(angle, traces, joint, shared_leader)
        _draw_error(error, traces, joint)
        figure.align_ylabels([angle, error])
    # Drawn once below all panels: four equal legends would only cover the curves.
    handles, labels = angle.get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", bbox_to_anchor=(0.5, 0.005), ncols=len(labels), frameon=False)
    return figure


def _draw_angle(axes: Axes, traces: Sequence[Trace], joint: int, shared_leader: bool) -> None:
    leaders = traces[:1] if shared_leader else traces
    for index, one in enumerate(leaders):
        label = "leader" if shared_leader else f"leader, {one.label}"
        style = "-" if index == 0 else "--"
        axes.plot(one.time, one.leader[:, joint], style, color=_LEADER_COLOUR, linewidth=1.6, label=label)
    for one, colour in zip(traces, _COLOURS, strict=False):
        axes.plot(one.time, one.follower[:, joint], color=colour, linewidth=1.1, label=f"follower, {one.label}")
    figures = ", ".join(f"{one.label} {one.mse[joint]:.2g}" for one in traces)
    axes.set_title(f"Joint {joint}, {JOINT_NAMES[joint]}\nMSE in rad²: {figures}", fontsize=9)
    axes.set_ylabel("angle [rad]")


def _draw_error(axes: Axes, traces: Sequence[Trace], joint: int) -> None:
    for one, colour in zip(traces, _COLOURS, strict=False):
        axes.plot(one.time, one.leader[:, joint] - one.follower[:, joint], color=colour, linewidth=0.9)
    axes.axhline(0.0, color=_LEADER_COLOUR, linewidth=0.6)
    axes.set_ylabel("error [rad]")
    axes.set_xlabel("time [s]")


def _same_leader(traces: Sequence[Trace]) -> bool:
    first = traces[0]
    for other in traces[1:]:
        end = min(first.time[-1], other.time[-1])
        grid = np.linspace(0.0, end, 500)
        for joint in range(first.leader.shape[1]):
            a = np.interp(grid, first.time, first.leader[:, joint])
            b = np.interp(grid, other.time, other.leader[:, joint])
            if np.max(np.abs(a - b)) > _SAME_LEADER:
                return False
    return True
