"""One picture of leader against follower: a panel a joint with strips of error and voltage below it, for some logs.

Where several logs (before and after tuning) have the same motion, the leader is drawn once. The same logs give the same
file, byte for byte.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from greywhale.base.errors import BadUsage
from greywhale.base.types import Floats
from greywhale.files.log import Log
from greywhale.files.log.driven import as_slice, following_rows
from greywhale.files.log.held import Numbers
from greywhale.files.log.layout import QUANTITIES
from greywhale.measure import Evaluation, evaluate
from greywhale.pictures import looks
from greywhale.pictures.kinds import kind_of
from greywhale.pictures.page import JOINTS, WIDE, headline, leave, legend_below, save, style
from greywhale.pictures.plotting import Artist, Axes, Figure, Line2D, plt
from greywhale.pictures.thinning import thin
from greywhale.protocol.joints import ALL, Joints
from greywhale.protocol.table import ParameterTable

# Leaders closer than this everywhere (rad) are drawn as one line. A motion that is played again is so late at most (s).
_SAME_LEADER, _SAME_MOMENT_S = 0.05, 0.04
_MOST_LOGS = len(looks.FOLLOWERS)
# Room below a title's first line (inches a line), and the letters that fit into a line above a panel.
_LINE, _LETTERS = 0.13, 42
_ANGLE, _STRIP, _TITLE, _BETWEEN, _AXIS = 1.45, 0.62, 0.2, 0.07, 0.4  # heights in inches
_VOLTAGE_ROOM = 1.12
# The leader is dashed and lies on top: an arm that follows closely would hide it.
_LEADERS = ("--", ":", "-.", "-")
_OVER = 3.0  # of the orders in which lines are drawn
# A voltage's course is its mean over this time; what potentiometers' noise adds is drawn faintly behind it.
_MEAN_S, _FAINT = 0.025, 0.3
# Rows that are averaged at once, so that a log of an hour needs little memory.
_PART = 1 << 16


@dataclass(frozen=True)
class Trace:
    """The measured part of a log with the word it has in the legend; time starts at 0."""

    label: str
    time: Floats
    leader: Numbers
    follower: Numbers
    mse: tuple[float, ...]
    voltage: Numbers | None = None
    supply_v: float | None = None  # the limit of the voltage, where it is known
    joints: Joints = ALL  # in use


def trace(log: Log, label: str, supply_v: float | None = None, measured: Evaluation | None = None) -> Trace:
    """The part of a log in which the motors followed (all of it if they never did).

    `supply_v` is the motors' supply, where the log may not tell it by its parameters, or by the CRC of the defaults.
    `measured` are the log's measures, where they are known.
    """
    table = log.origin.table
    if table is None and log.origin.param_crc == ParameterTable.defaults().crc:
        table = ParameterTable.defaults()
    if supply_v is None and table is not None:
        supply_v = table.supply_v
    part = log.part(as_slice(following_rows(log)))
    mse = tuple(joint.mse for joint in (measured or evaluate(log)).joints)
    numbers = {name: part.held(name) for name in QUANTITIES}
    return Trace(label, part.time - part.time[0], mse=mse, supply_v=supply_v, joints=log.joints_in_use, **numbers)


def draw_following(path: str | Path, traces: Sequence[Trace], title: str) -> None:
    """Write the picture; the ending of `path` chooses PNG, SVG or PDF."""
    target = Path(path)
    kind_of(target)
    if not 1 <= len(traces) <= _MOST_LOGS:
        raise BadUsage(f"a picture shows 1 to {_MOST_LOGS} logs, not {len(traces)}.")
    with style():
        save(plot_following(traces, title), target)


def plot_following(traces: Sequence[Trace], title: str) -> Figure:
    """Draw the figure that `draw_following` writes, in pyplot; the caller closes it."""
    strips = 2 if any(one.voltage is not None for one in traces) else 1
    joints = sorted({joint for one in traces for joint in one.joints})
    count = (len(joints) + 1) // 2  # of rows
    figures = {joint: _figures(traces, joint) for joint in joints}
    above = _TITLE + _LINE * max(len(one) for one in figures.values())
    panel = _ANGLE + strips * (_STRIP + _BETWEEN)
    height = 0.3 + count * (above + panel + _AXIS) + 0.12 + _LINE * (len(traces) + 2)
    figure = plt.figure(figsize=(WIDE, height))
    headline(figure, title)
    handles = _handles(traces)
    below = legend_below(figure, list(handles.values()), list(handles))
    room = leave(figure, 0.73, 0.1, 0.08 + below + _AXIS, 0.24 + above)
    between = above + _AXIS
    hspace = between / ((height * (room["top"] - room["bottom"]) - (count - 1) * between) / count)
    grid = figure.add_gridspec(count, 2, **room, wspace=0.33, hspace=hspace)
    for place, joint in enumerate(joints):
        rows = grid[divmod(place, 2)].subgridspec(
            1 + strips, 1, height_ratios=(_ANGLE, *[_STRIP] * strips), hspace=_BETWEEN / (panel / (1 + strips))
        )
        axes = [figure.add_subplot(rows[0])]
        axes += [figure.add_subplot(rows[row], sharex=axes[0]) for row in range(1, 1 + strips)]
        _draw_angle(axes[0], traces, joint)
        axes[0].set_title("\n".join((JOINTS[joint], *figures[joint])))
        _draw_error(axes[1], traces, joint)
        if strips == 2:
            _draw_voltage(axes[2], traces, joint)
        for one in axes[:-1]:
            one.tick_params(labelbottom=False)
        axes[-1].set_xlabel("time [s]")
        axes[0].set_xlim(0.0, max(one.time[-1] for one in traces))
        figure.align_ylabels(axes)
    return figure


def _figures(traces: Sequence[Trace], joint: int) -> list[str]:
    """The joint's mean squared errors, in lines that fit above its panel."""
    said = ", ".join(f"{one.label} {one.mse[joint]:.2g}".replace(" ", "\xa0") for one in traces)
    words = f"MSE\xa0[rad²]: {said}" if len(traces) > 1 else f"MSE\xa0{traces[0].mse[joint]:.2g}\xa0rad²"
    return textwrap.wrap(words, _LETTERS, break_long_words=False, break_on_hyphens=False)


def _looks(traces: Sequence[Trace]) -> Sequence[looks.Look]:
    return looks.FOLLOWERS[: len(traces)] if len(traces) > 1 else (looks.FOLLOWER,)


def _handles(traces: Sequence[Trace]) -> dict[str, Artist]:
    """The legend's lines by their words; it stands once below all panels, where it covers no curve."""
    handles: dict[str, Artist] = {}
    for words, look, _ in _leaders(traces):
        handles[words] = Line2D([], [], **look.line)
    for one, look in zip(traces, _looks(traces), strict=True):
        handles[f"follower, {one.label}"] = Line2D([], [], **look.line)
    if len(traces) == 1 and traces[0].voltage is not None:
        handles["voltage"] = Line2D([], [], **looks.VOLTAGE.line)
    for words in _limits(traces):
        handles[words] = Line2D([], [], **looks.VOLTAGE_LIMIT.line)
    return handles


def _leaders(traces: Sequence[Trace]) -> list[tuple[str, looks.Look, Trace]]:
    """The leaders to be drawn: one where all logs have the same motion, else each in a style of its own."""
    if _same_leader(traces):
        return [("leader", replace(looks.LEADER, style=_LEADERS[0]), traces[0])]
    return [
        (f"leader, {one.label}", replace(looks.LEADER, style=dashes), one)
        for one, dashes in zip(traces, _LEADERS, strict=False)
    ]


def _limits(traces: Sequence[Trace]) -> dict[str, float]:
    """The limits of the voltage by their words; where logs do not tell them, the largest voltage in these."""
    limits, largest = {}, 0.0
    for one in traces:
        if one.supply_v is not None and one.voltage is not None:
            limits[f"voltage limit, {one.supply_v:g} V"] = one.supply_v
        elif one.voltage is not None:
            largest = max(largest, float(one.voltage.max()), -float(one.voltage.min()))
    return limits | (
        {f"largest voltage, {largest:.1f} V": largest} if largest > max(limits.values(), default=0.0) else {}
    )


def _draw_angle(axes: Axes, traces: Sequence[Trace], joint: int) -> None:
    for _, look, one in _leaders(traces):
        axes.plot(*thin(one.time, one.leader[:, joint]), zorder=_OVER, **look.line)
    for one, look in zip(traces, _looks(traces), strict=True):
        axes.plot(*thin(one.time, one.follower[:, joint]), **look.line)
    axes.set_ylabel("angle [rad]")


def _draw_error(axes: Axes, traces: Sequence[Trace], joint: int) -> None:
    axes.axhline(0.0, color=looks.DARK, linewidth=0.5)
    for one, look in zip(traces, _looks(traces), strict=True):
        axes.plot(*thin(one.time, one.leader[:, joint] - one.follower[:, joint]), **look.thin().line)
    axes.set_ylabel("error [rad]")


def _draw_voltage(axes: Axes, traces: Sequence[Trace], joint: int) -> None:
    limits = _limits(traces)
    for limit in limits.values():
        for side in (-limit, limit):
            axes.axhline(side, **looks.VOLTAGE_LIMIT.line)
    voltages = _looks(traces) if len(traces) > 1 else (looks.VOLTAGE,)
    for one, look in zip(traces, voltages, strict=True):
        if one.voltage is not None:
            line = look.thin(looks.VOLTAGE.width).line
            axes.plot(*thin(one.time, one.voltage[:, joint]), alpha=_FAINT, **line)
            axes.plot(*thin(one.time, _average(one.time, one.voltage[:, joint])), **line)
    most = _VOLTAGE_ROOM * max(limits.values(), default=1.0)
    axes.set_ylim(-most, most)
    axes.set_ylabel("voltage [V]")


def _average(time: Floats, voltage: Floats) -> Floats:
    """The running mean; of fewer samples at both ends."""
    half = int(_MEAN_S / 2.0 * (len(time) - 1) / (time[-1] - time[0])) if len(time) > 1 else 0
    sums = np.concatenate([[0.0], np.cumsum(voltage)])
    mean = np.empty(len(voltage))
    for begin in range(0, len(voltage), _PART):
        rows = np.arange(begin, min(begin + _PART, len(voltage)))
        first, last = np.maximum(rows - half, 0), np.minimum(rows + half + 1, len(voltage))
        mean[rows] = (sums[last] - sums[first]) / (last - first)
    return mean


def _same_leader(traces: Sequence[Trace]) -> bool:
    """True if all leaders make the same motion: never far from where the first is then, or is within a moment."""
    first = traces[0]
    for other in traces[1:]:
        time = np.arange(0.0, min(first.time[-1], other.time[-1]), _SAME_MOMENT_S / 8)
        for joint in range(first.leader.shape[1]):
            a = np.interp(time, first.time, first.leader[:, joint])
            b = np.interp(time, other.time, other.leader[:, joint])
            moments = np.lib.stride_tricks.sliding_window_view(np.pad(a, 8, mode="edge"), 17)
            beyond = np.maximum(b - moments.max(axis=1), moments.min(axis=1) - b)
            if np.max(beyond, initial=0.0) > _SAME_LEADER:
                return False
    return True
