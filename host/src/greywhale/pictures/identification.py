"""Responses of an arm and its models (the paper's Figs. 7-8, and others of that form), and convergence (Fig. 6)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from greywhale.base.types import Floats
from greywhale.pictures.looks import DARK, GREY, Look
from greywhale.pictures.page import (
    JOINTS,
    LARGEST_ERROR,
    WIDE,
    headline,
    label_responses,
    leave,
    make_logarithmic,
    mark_beyond,
)
from greywhale.pictures.plotting import Figure, Line2D, plt
from greywhale.protocol.joints import ALL, Joints


@dataclass(frozen=True)
class Trace:
    """Angles (rows, 4), rad, at times (rows,), s, and how they look."""

    name: str
    time: Any
    angles: Any
    look: Look


def plot_responses(
    traces: Sequence[Trace],
    against: Trace,
    title: str,
    error: str,
    *,
    window: tuple[float, float] | None = None,
    joints: Joints = ALL,
    said: Sequence[str] = (),
) -> Figure:
    """A panel a joint: these traces, and below how far those behind `against` are from it, which `error` says.

    `said` stands below each joint's name. The figure is one of pyplot's, which the caller closes.
    """
    rows = (len(joints) + 1) // 2
    figure = plt.figure(figsize=(WIDE, 0.9 + (2.9 if said else 2.1) * rows))
    headline(figure, title)
    behind = list(traces)[list(traces).index(against) + 1 :]
    first, last = window or (min(np.min(one.time) for one in traces), max(np.max(one.time) for one in traces))
    off = {joint: [_off(one, against, joint, first, last) for one in behind] for joint in joints}
    largest = max(float(np.abs(one[1]).max(initial=0.0)) for errors in off.values() for one in errors)
    lines = {one.name: Line2D([], [], **one.look.line) for one in traces}
    below = label_responses(figure, {**lines, f"error: {error}": Line2D([], [], linestyle="none")}, largest)
    room = leave(figure, 0.67, 0.12, 0.46 + below, 0.75 if said else 0.48)
    grid = figure.add_gridspec(rows, 2, **room, wspace=0.29, hspace=0.4)
    for place, joint in enumerate(joints):
        cells = grid[divmod(place, 2)].subgridspec(2, 1, height_ratios=(2.2, 1), hspace=0.07)
        angle = figure.add_subplot(cells[0])
        strip = figure.add_subplot(cells[1], sharex=angle)
        for one in traces:
            angle.plot(one.time, np.array(one.angles)[:, joint], **one.look.line)
        angle.set_xlim(first, last)
        for time, difference, look in off[joint]:
            strip.plot(time, difference, **look.thin().line)
        strip.axhline(0.0, color=DARK, linewidth=0.5)
        mark_beyond(strip, LARGEST_ERROR, off[joint])
        angle.set_title("\n".join([JOINTS[joint], *said[joint : joint + 1]]))
        angle.tick_params(labelbottom=False)
        angle.set_ylabel("angle [rad]")
        strip.set_ylabel("error [rad]")
        strip.set_xlabel("time [s]")
        figure.align_ylabels([angle, strip])
    return figure


def _off(one: Trace, against: Trace, joint: int, first: float, last: float) -> tuple[Floats, Floats, Look]:
    """The times (s) of a trace from first to last, its distance (rad) from another trace then, and its look."""
    time = np.asarray(one.time, dtype=np.float64)
    seen = (time >= first) & (time <= last)
    reference = np.interp(time[seen], np.asarray(against.time), np.array(against.angles)[:, joint])
    return time[seen], reference - np.array(one.angles)[seen, joint], one.look


def plot_convergence(curves: Mapping[str, Sequence[float]], title: str, look: Look) -> Figure:
    """Best costs so far, rad², over iterations; the first curve is drawn as `look` says, the others pale."""
    figure, axes = plt.subplots(figsize=(WIDE, 3.0))
    figure.subplots_adjust(**leave(figure, 0.7, 0.12, 0.42, 0.3))
    for place, (name, curve) in enumerate(curves.items()):
        drawn = {"color": GREY, "linewidth": 0.6} if place else {**look.thin(1.5).line, "label": name, "zorder": 3}
        axes.step(np.arange(len(curve)), curve, where="post", **drawn)
    make_logarithmic(axes)
    axes.set_xlabel("iteration")
    axes.set_ylabel("best summed MSE [rad²]")
    axes.set_title(title)
    if len(curves) > 1:
        axes.plot([], [], color=GREY, linewidth=0.6, label="other seeds")
        axes.legend(frameon=False)
    return figure
