"""Pictures of a tuning: sets (the paper's Figs. 11 and 16), responses (Figs. 14, 15, 17), convergence (Fig. 19).

The same numbers give the same file, byte for byte.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from greywhale.base.types import Controllers, Floats
from greywhale.pictures import looks
from greywhale.pictures.membership import corners_of, draw_shapes
from greywhale.pictures.page import (
    JOINTS,
    LARGEST_ERROR,
    WIDE,
    headline,
    label_responses,
    leave,
    legend_below,
    make_logarithmic,
    mark_beyond,
)
from greywhale.pictures.plotting import Axes, Figure, Line2D, plt
from greywhale.protocol.joints import ALL, Joints

_SET_NAMES = (("NE", "ZE", "PE"), ("NCE", "ZCE", "PCE"))
_INPUTS = {"error": "$K_p\\,e$", "change of error": "$K_d\\,\\Delta e$"}
_UNCHANGED = "unchanged by the tuning"
_RESPONSES = (looks.BEFORE, looks.AFTER, looks.FLOOR)


@dataclass(frozen=True)
class Response:
    """Angles (rows, 4) in rad at `time_s` (rows,), with a word and figures for the legend and the titles."""

    time_s: Floats
    angles: Floats
    mse: Floats  # (4,) rad^2


def cost_words(method: str) -> str:
    """The cost of a method with its unit, for an axis."""
    if method == "paper":
        return "best J = ITAE [rad s²] + ITAU [V s²]"
    return "best cost [0: floor, 1: before tuning]"


def plot_sets(before: Controllers, after: Controllers, joints: Joints = ALL) -> Figure:
    """The input sets of controllers as a board stores them, int32 (4, 13): before dashed, after solid.

    Sets that the tuning left as they were are drawn once, and it is said. This and the others below are figures of
    pyplot's that the caller closes.
    """
    corners = [
        [[corners_of(rows, joint, change) for rows in (before, after)] for change in (False, True)] for joint in ALL
    ]
    some = any(one[0] != one[1] for joint in corners for one in joint)
    count = len(joints)
    height = 7.0 - 1.46 * (len(JOINTS) - count)
    figure, grid = plt.subplots(count, 2, figsize=(WIDE, height), sharex=True, sharey=True, squeeze=False)
    figure.subplots_adjust(**leave(figure, 0.5, 0.12, 0.66, 0.5, wspace=0.07, hspace=0.36))
    which = "before and after tuning" if some else _UNCHANGED
    headline(figure, f"Input membership functions {which}")
    for joint, row in zip(joints, grid, strict=True):
        for axes, (name, symbol), (old, new) in zip(row, _INPUTS.items(), corners[joint], strict=True):
            changed = old != new
            if changed:
                draw_shapes(axes, old, looks.SETS_BEFORE)
            draw_shapes(axes, new, looks.SETS_AFTER)
            same = f" ({_UNCHANGED})" if some and not changed else ""
            axes.set_title(f"{JOINTS[joint]}: {name}{same}")
            axes.set_xlim(-1.0, 1.0)
            axes.set_xticks((-1.0, -0.5, 0.0, 0.5, 1.0), ("−1", "−0.5", "0", "0.5", "1"))
            axes.set_ylim(-0.03, 1.05)
            axes.set_yticks((0.0, 0.5, 1.0))
            if joint == joints[-1]:
                axes.set_xlabel(f"{symbol}, limited to [−1, 1]")
        row[0].set_ylabel("membership")
    _label_sets(figure, some)
    return figure


def _label_sets(figure: Figure, changed: bool) -> None:
    after = looks.SETS_AFTER
    lines = [Line2D([], [], color=colour, linewidth=after.width) for colour in looks.SIGNS]
    words = [" / ".join(pair) for pair in zip(*_SET_NAMES, strict=True)]
    if changed:
        lines += [Line2D([], [], **look.line) for look in (looks.SETS_BEFORE, after)]
        words += ["before tuning", "after tuning"]
    legend_below(figure, lines, words)


def plot_responses(
    time_s: Floats, leader: Floats, responses: Mapping[str, Response], title: str, joints: Joints = ALL
) -> Figure:
    """Leader (rows, 4) and followers: for each joint the whole motion, its error, and its largest move close up.

    The first word of a response's name stands before its error in the titles.
    """
    figure = plt.figure(figsize=(WIDE, 8.6 - 1.85 * (len(JOINTS) - len(joints))))
    headline(figure, title)
    lines = dict(zip(("leader", *responses), (looks.LEADER, *_RESPONSES), strict=False))
    errors = {
        joint: [
            (one.time_s, np.interp(one.time_s, time_s, leader[:, joint]) - one.angles[:, joint], lines[name])
            for name, one in responses.items()
        ]
        for joint in joints
    }
    largest = max(float(np.abs(one[1]).max()) for each in errors.values() for one in each)
    below = label_responses(figure, {name: Line2D([], [], **look.line) for name, look in lines.items()}, largest)
    grid = figure.add_gridspec(len(joints), 1, **leave(figure, 0.62, 0.1, 0.44 + below, 0.46), hspace=0.33)
    close = _close_up(time_s, leader)
    for place, joint in enumerate(joints):
        cells = grid[place].subgridspec(2, 2, width_ratios=(1.9, 1), height_ratios=(1.7, 1), wspace=0.3, hspace=0.1)
        whole = figure.add_subplot(cells[0, 0], sharex=figure.axes[0] if place else None)
        error = figure.add_subplot(cells[1, 0], sharex=whole)
        near = figure.add_subplot(cells[:, 1], sharex=figure.axes[2] if place else None)
        whole.tick_params(labelbottom=False)
        _draw_angles(whole, time_s, leader[:, joint], responses, joint)
        _draw_angles(near, time_s, leader[:, joint], responses, joint)
        figures = ", ".join(f"{name.split()[0]} {one.mse[joint]:#.3g}" for name, one in responses.items())
        whole.set_title(f"{JOINTS[joint]}; MSE [rad²]: {figures}", loc="left")
        whole.set_ylabel("angle [rad]")
        near.set_ylabel("angle [rad]")
        error.set_ylabel("error [rad]")
        whole.set_xlim(time_s[0], time_s[-1])
        near.set_xlim(*close)
        _fit(near, time_s, leader[:, joint], [(one.time_s, one.angles[:, joint]) for one in responses.values()])
        for times, difference, look in errors[joint]:
            error.plot(times, difference, **look.thin().line)
        mark_beyond(error, LARGEST_ERROR, errors[joint])
        figure.align_ylabels([whole, error])
        if joint == joints[-1]:
            error.set_xlabel("time [s]")
            near.set_xlabel("time [s], the largest move")
    return figure


def _draw_angles(axes: Axes, time_s: Floats, leader: Floats, responses: Mapping[str, Response], joint: int) -> None:
    axes.plot(time_s, leader, label="leader", **looks.LEADER.line)
    for (name, one), look in zip(responses.items(), _RESPONSES, strict=False):
        axes.plot(one.time_s, one.angles[:, joint], label=name, **look.line)


def _close_up(time_s: Floats, leader: Floats) -> tuple[float, float]:
    """The time around the largest move that all joints make within a moment."""
    step = max(1, round(0.1 / float(np.median(np.diff(time_s)))))
    moved = np.abs(leader[step:] - leader[:-step]).sum(axis=1)
    start = float(time_s[int(np.argmax(moved > 0.99 * moved.max()))]) if len(moved) else float(time_s[0])
    return start - 0.05, start + 0.45


def _fit(axes: Axes, time_s: Floats, leader: Floats, curves: Sequence[tuple[Floats, Floats]]) -> None:
    """The angles that are seen between the panel's times, with a margin."""
    first, last = axes.get_xlim()
    seen = [angles[(times >= first) & (times <= last)] for times, angles in ((time_s, leader), *curves)]
    values = np.concatenate(seen)
    margin = 0.06 * max(float(np.ptp(values)), 1e-3)
    axes.set_ylim(values.min() - margin, values.max() + margin)


def plot_convergence(
    curves: Sequence[tuple[npt.NDArray[np.int64], Floats]], title: str, cost_name: str, joints: Joints = ALL
) -> Figure:
    """A panel a joint: best cost so far over evaluations; `cost_name` names it with its unit."""
    rows = (len(joints) + 1) // 2
    figure, grid = plt.subplots(rows, 2, figsize=(WIDE, 4.6 if rows == 2 else 2.9), sharex=True, squeeze=False)
    figure.subplots_adjust(**leave(figure, 0.62, 0.14, 0.42, 0.62, wspace=0.24, hspace=0.36))
    headline(figure, title)
    figure.supylabel(cost_name, x=0.06 / WIDE, ha="left", fontsize="medium")
    for joint, axes in zip(joints, grid.flat, strict=False):
        evaluations, cost = curves[joint]
        axes.step(evaluations, cost, where="post", **looks.AFTER.line)
        last = int(np.flatnonzero(cost > cost[-1])[-1]) + 1 if (cost > cost[-1]).any() else 0
        axes.plot(evaluations[last], cost[last], "o", color=looks.AFTER.colour, markersize=4)
        axes.set_title(f"{JOINTS[joint]}\n{cost[-1]:.3g} after {evaluations[last]:,} evaluations")
        if cost.min() > 0.0 and cost.max() > 20.0 * cost.min():  # a wide range
            make_logarithmic(axes)
        axes.set_xlim(left=0)
    rises = any((np.diff(cost) > 0.0).any() for _, cost in (curves[joint] for joint in joints))
    along = "evaluations; each stage judges the best anew" if rises else "evaluations"
    for axes in grid[-1]:
        axes.set_xlabel(along)
    for axes in grid.flat[len(joints) :]:
        axes.remove()
        # Now the panel above is the lowest of its column.
        for above in grid[:-1, 1]:
            above.tick_params(labelbottom=True)
            above.set_xlabel(along)
    return figure
