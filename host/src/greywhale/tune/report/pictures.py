"""Pictures of a tuning: sets (the paper's Figs. 11 and 16), responses (Figs. 14, 15, 17), convergence (Fig. 19).

The same numbers give the same file, byte for byte: no display, no date and no random identifier goes into it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib

from greywhale.firmware import JOINTS

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from greywhale.arm.parameters import JOINT_NAMES
from greywhale.errors import UserError, os_reason
from greywhale.formats.whole import write_whole
from greywhale.fuzzy.settings import SET_UNIT
from greywhale.loop import CONTROLLER_COLUMNS

if TYPE_CHECKING:
    from greywhale.tune.outcome import Outcome

Floats = npt.NDArray[np.float64]
Controllers = npt.NDArray[np.int32]

# Okabe and Ito's palette: told apart by colour-blind readers too.
_LEADER, _BEFORE, _AFTER, _FLOOR = "#222222", "#D55E00", "#0072B2", "#009E73"
_SET_COLOURS = ("#D55E00", "#222222", "#0072B2")
_SET_NAMES = (("NE", "ZE", "PE"), ("NCE", "ZCE", "PCE"))
# For the error and its change: the columns of the corners (left, the middle's two, right), and the name of the sets.
_INPUTS = {
    "error": (("ne_c", "ze_a", "ze_c", "pe_b"), "$K_p\\,e$"),
    "change of error": (("nce_c", "zce_a", "zce_c", "pce_b"), "$K_d\\,\\Delta e$"),
}
# A close-up shows so much before and after the largest jump of the leader.
_CLOSE_BEFORE_S, _CLOSE_AFTER_S = 0.05, 0.45
_JUMP_S = 0.1
_WIDE_COSTS = 20.0  # from here on a logarithmic axis
# Jumps would hide the error that is left after them (rad).
_LARGEST_ERROR = 0.2


@dataclass(frozen=True)
class Response:
    """Angles (rows, 4) in rad at `time_s` (rows,), with a word and figures for the legend and the titles."""

    time_s: Floats
    angles: Floats
    mse: Floats  # (4,) rad^2


def draw(outcome: Outcome, folder: Path) -> list[Path]:
    """Write all pictures of a tuning into `folder`; their paths."""
    drawn = [draw_sets(folder / "sets.png", outcome.before, outcome.after)]
    for one in outcome.held_out:
        responses = {
            "before tuning": Response(one.time_s, one.angles_before, one.mse_before),
            "after tuning": Response(one.time_s, one.angles_after, one.mse_after),
        }
        if one.floor is not None:
            responses["floor (ideal controller)"] = Response(one.floor.time_s, one.floor.angles, one.floor.mse)
        path = folder / f"responses_{re.sub('[^a-z]+', '_', one.name)}.png"
        drawn.append(draw_responses(path, one.time_s, one.leader, responses, f"Response to {one.name}"))
    if outcome.curves and all(curve.cost for curve in outcome.curves):
        curves = [(np.array(one.evaluations), np.array(one.cost)) for one in outcome.curves]
        title = f"Convergence of the tuning: method {outcome.method}, strategy {outcome.strategy}"
        drawn.append(draw_convergence(folder / "convergence.png", curves, title))
    return drawn


def draw_sets(path: Path, before: Controllers, after: Controllers) -> Path:
    """Draw the input sets of controllers as a board stores them, int32 (4, 12): before dashed, after solid."""
    with set_style():
        return _save(plot_sets(before, after), path)


def draw_responses(path: Path, time_s: Floats, leader: Floats, responses: Mapping[str, Response], title: str) -> Path:
    """Draw leader (rows, 4) and followers: for each joint the whole motion, its error, and its largest move close up.

    The first word of a response's name stands before its error in the titles.
    """
    with set_style():
        return _save(plot_responses(time_s, leader, responses, title), path)


def draw_convergence(path: Path, curves: Sequence[tuple[npt.NDArray[np.int64], Floats]], title: str) -> Path:
    """A panel a joint: best cost so far over evaluations."""
    with set_style():
        return _save(plot_convergence(curves, title), path)


def set_style() -> AbstractContextManager[None]:
    """Matplotlib's settings for these pictures, for as long as the context lasts."""
    return matplotlib.rc_context({"font.size": 9, "axes.grid": True, "grid.alpha": 0.3, "axes.axisbelow": True})


def plot_sets(before: Controllers, after: Controllers) -> Figure:
    """What `draw_sets` writes, as a figure of pyplot's that the caller closes."""
    figure, grid = plt.subplots(JOINTS, 2, figsize=(9.0, 9.4), sharex=True, sharey=True)
    figure.subplots_adjust(left=0.075, right=0.985, bottom=0.095, top=0.925, wspace=0.07, hspace=0.34)
    figure.suptitle("Input membership functions before and after tuning", fontsize=12, fontweight="bold", y=0.985)
    for joint, row in enumerate(grid):
        for axes, (name, (columns, symbol)) in zip(row, _INPUTS.items(), strict=True):
            for controllers, style in ((before, "--"), (after, "-")):
                corners = [controllers[joint, CONTROLLER_COLUMNS.index(one)] / SET_UNIT for one in columns]
                _draw_sets(axes, corners, style)
            axes.set_title(f"Joint {joint}, {JOINT_NAMES[joint]}: {name}", fontsize=9)
            axes.set_xlim(-1.0, 1.0)
            axes.set_xticks((-1.0, -0.5, 0.0, 0.5, 1.0), ("−1", "−0.5", "0", "0.5", "1"))
            axes.set_ylim(-0.03, 1.05)
            if joint == JOINTS - 1:
                axes.set_xlabel(f"{symbol}, limited to [−1, 1]")
        row[0].set_ylabel("membership")
    lines = [Line2D([], [], color=colour, linewidth=1.5) for colour in _SET_COLOURS]
    lines += [Line2D([], [], color="#777777", linestyle=style, linewidth=1.3) for style in ("--", "-")]
    words = (*(" / ".join(pair) for pair in zip(*_SET_NAMES, strict=True)), "before tuning", "after tuning")
    figure.legend(lines, words, loc="lower center", ncols=len(words), frameon=False)
    return figure


def _draw_sets(axes: Axes, corners: Sequence[float], style: str) -> None:
    """NE [-1,-1,left,0], ZE [a,0,c], PE [0,right,1,1]: every foot is at zero."""
    left, a, c, right = corners
    shapes = (
        ([-1.0, left, 0.0], [1.0, 1.0, 0.0]),
        ([a, 0.0, c], [0.0, 1.0, 0.0]),
        ([0.0, right, 1.0], [0.0, 1.0, 1.0]),
    )
    for (x, y), colour in zip(shapes, _SET_COLOURS, strict=True):
        axes.plot(x, y, style, color=colour, linewidth=1.5 if style == "-" else 0.9)


def plot_responses(time_s: Floats, leader: Floats, responses: Mapping[str, Response], title: str) -> Figure:
    """What `draw_responses` writes, as a figure of pyplot's that the caller closes."""
    figure = plt.figure(figsize=(11.0, 12.6))
    figure.suptitle(title, fontsize=12, fontweight="bold", y=0.988)
    grid = figure.add_gridspec(JOINTS, 1, left=0.07, right=0.985, bottom=0.07, top=0.945, hspace=0.36)
    close = _close_up(time_s, leader)
    for joint in range(JOINTS):
        cells = grid[joint].subgridspec(2, 2, width_ratios=(2.1, 1), height_ratios=(2, 1), wspace=0.13, hspace=0.1)
        whole = figure.add_subplot(cells[0, 0])
        error = figure.add_subplot(cells[1, 0], sharex=whole)
        near = figure.add_subplot(cells[:, 1])
        whole.tick_params(labelbottom=False)
        _draw_angles(whole, time_s, leader[:, joint], responses, joint)
        _draw_angles(near, time_s, leader[:, joint], responses, joint)
        for one, colour in zip(responses.values(), (_BEFORE, _AFTER, _FLOOR), strict=False):
            lead = np.interp(one.time_s, time_s, leader[:, joint])
            error.plot(one.time_s, lead - one.angles[:, joint], color=colour, linewidth=0.8)
        figures = ",  ".join(f"{name.split()[0]} {one.mse[joint]:#.3g}" for name, one in responses.items())
        whole.set_title(f"Joint {joint}, {JOINT_NAMES[joint]}   (MSE in rad²:  {figures})", fontsize=9, loc="left")
        whole.set_ylabel("angle [rad]")
        error.set_ylabel("error [rad]")
        whole.set_xlim(time_s[0], time_s[-1])
        near.set_xlim(*close)
        _fit(near, time_s, leader[:, joint], [(one.time_s, one.angles[:, joint]) for one in responses.values()])
        near.set_title("quickest moment of all joints, close up", fontsize=9, loc="left")
        low, high = error.get_ylim()
        error.set_ylim(max(low, -_LARGEST_ERROR), min(high, _LARGEST_ERROR))
        figure.align_ylabels([whole, error])
        if joint == JOINTS - 1:
            error.set_xlabel("time [s]")
            near.set_xlabel("time [s]")
    handles, labels = whole.get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", bbox_to_anchor=(0.5, 0.006), ncols=len(labels), frameon=False)
    return figure


def _draw_angles(axes: Axes, time_s: Floats, leader: Floats, responses: Mapping[str, Response], joint: int) -> None:
    axes.plot(time_s, leader, color=_LEADER, linewidth=1.5, label="leader")
    styles = ((_BEFORE, "-", 1.1), (_AFTER, "-", 1.1), (_FLOOR, "--", 1.1))
    for (name, one), (colour, style, width) in zip(responses.items(), styles, strict=False):
        axes.plot(one.time_s, one.angles[:, joint], style, color=colour, linewidth=width, label=name)


def _close_up(time_s: Floats, leader: Floats) -> tuple[float, float]:
    """The time around the largest move that all joints make within a moment."""
    step = max(1, round(_JUMP_S / float(np.median(np.diff(time_s)))))
    moved = np.abs(leader[step:] - leader[:-step]).sum(axis=1)
    start = float(time_s[int(np.argmax(moved > 0.99 * moved.max()))]) if len(moved) else float(time_s[0])
    return start - _CLOSE_BEFORE_S, start + _CLOSE_AFTER_S


def _fit(axes: Axes, time_s: Floats, leader: Floats, curves: Sequence[tuple[Floats, Floats]]) -> None:
    """The angles that are seen between the panel's times, with a margin."""
    first, last = axes.get_xlim()
    seen = [angles[(times >= first) & (times <= last)] for times, angles in ((time_s, leader), *curves)]
    values = np.concatenate(seen)
    margin = 0.06 * max(float(np.ptp(values)), 1e-3)
    axes.set_ylim(values.min() - margin, values.max() + margin)


def plot_convergence(curves: Sequence[tuple[npt.NDArray[np.int64], Floats]], title: str) -> Figure:
    """What `draw_convergence` writes, as a figure of pyplot's that the caller closes."""
    figure, grid = plt.subplots(2, 2, figsize=(9.0, 6.0), sharex=True)
    figure.subplots_adjust(left=0.105, right=0.985, bottom=0.09, top=0.885, wspace=0.24, hspace=0.24)
    figure.suptitle(title, fontsize=12, fontweight="bold", y=0.975)
    for joint, (axes, (evaluations, cost)) in enumerate(zip(grid.flat, curves, strict=True)):
        axes.step(evaluations, cost, where="post", color=_AFTER, linewidth=1.4)
        last = int(np.flatnonzero(cost > cost[-1])[-1]) + 1 if (cost > cost[-1]).any() else 0
        axes.plot(evaluations[last], cost[last], "o", color=_BEFORE, markersize=5)
        said = f"Joint {joint}, {JOINT_NAMES[joint]}: {cost[-1]:.3g} after {evaluations[last]:,} evaluations"
        axes.set_title(said, fontsize=9)
        if cost.min() > 0.0 and cost.max() > _WIDE_COSTS * cost.min():
            axes.set_yscale("log")
        axes.set_xlim(left=0)
    for axes in grid[1]:
        axes.set_xlabel("evaluations")
    for axes in grid[:, 0]:
        axes.set_ylabel("best cost so far")
    return figure


def _save(figure: Figure, path: Path) -> Path:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, lambda file: figure.savefig(file, format="png", dpi=150, metadata={"Software": None}))
    except OSError as error:
        raise UserError(f"{path}: cannot be written: {os_reason(error)}.") from None
    finally:
        plt.close(figure)
    return path
