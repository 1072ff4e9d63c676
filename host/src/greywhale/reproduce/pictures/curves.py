"""Responses, convergence, sets and control surfaces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from greywhale.firmware import JOINTS
from greywhale.fuzzy.settings import SET_UNIT
from greywhale.loop import CONTROLLER_COLUMNS
from greywhale.reproduce.pictures.drawing import BLUE, DARK, GREEN, ORANGE, PURPLE, TITLES, png, styled
from greywhale.reproduce.work.errata import Law

Floats = npt.NDArray[np.float64]
Controllers = npt.NDArray[np.int32]

COLOURS = (ORANGE, BLUE, GREEN, PURPLE)
_E, _CE = ("ne_c", "ze_a", "ze_c", "pe_b"), ("nce_c", "zce_a", "zce_c", "pce_b")
_SETS = {"e": ("NE", "ZE", "PE"), "ce": ("NCE", "ZCE", "PCE"), "u": ("NU", "ZU", "PU")}


@dataclass(frozen=True)
class Trace:
    """Angles (rows, 4), rad, at times (rows,), s."""

    name: str
    time: Any
    angles: Any


def responses(
    first: Trace,
    traces: Sequence[Trace],
    title: str,
    *,
    window: tuple[float, float] | None = None,
    faint: Trace | None = None,
) -> bytes:
    """Two by two panels: what all others are compared with, then these; `faint` is shown behind all."""
    with styled():
        figure, grid = plt.subplots(2, 2, figsize=(9.0, 6.4), sharex=True)
        figure.subplots_adjust(left=0.08, right=0.985, bottom=0.14, top=0.9, wspace=0.18, hspace=0.2)
        figure.suptitle(title, fontsize=11, fontweight="bold", y=0.975)
        for joint, axes in enumerate(grid.flat):
            if faint is not None:
                axes.plot(
                    faint.time, np.array(faint.angles)[:, joint], ":", color=DARK, linewidth=0.9, label=faint.name
                )
            axes.plot(first.time, np.array(first.angles)[:, joint], color=DARK, linewidth=1.4, label=first.name)
            for one, colour in zip(traces, COLOURS, strict=False):
                axes.plot(one.time, np.array(one.angles)[:, joint], color=colour, linewidth=1.1, label=one.name)
            axes.set_title(TITLES[joint], fontsize=9)
            axes.margins(x=0.01, y=0.08)
            if window is not None:
                axes.set_xlim(*window)
        _label(grid, "time [s]", "angle [rad]")
        handles, labels = grid[0, 0].get_legend_handles_labels()
        figure.legend(
            handles, labels, loc="lower center", bbox_to_anchor=(0.5, 0.005), ncols=len(labels), frameon=False
        )
        return png(figure)


def _label(grid: Any, x: str, y: str) -> None:
    for axes in grid[-1]:
        axes.set_xlabel(x)
    for axes in grid[:, 0]:
        axes.set_ylabel(y)


def convergence(curves: Mapping[str, Sequence[float]], title: str, y: str, first: str = "") -> bytes:
    """Best costs so far over iterations in one panel; the curve `first` is drawn strong, the others pale."""
    with styled():
        figure, axes = plt.subplots(figsize=(7.0, 3.8))
        figure.subplots_adjust(left=0.12, right=0.98, bottom=0.13, top=0.9)
        for name, curve in curves.items():
            strong = name == first
            axes.step(
                np.arange(1, len(curve) + 1),
                curve,
                where="post",
                color=BLUE if strong else "#999999",
                linewidth=1.8 if strong else 0.7,
                label=name if strong else None,
                zorder=3 if strong else 2,
            )
        axes.set_yscale("log")
        axes.set_xlabel("iteration")
        axes.set_ylabel(y)
        axes.set_title(title, fontsize=10)
        axes.plot([], [], color="#999999", linewidth=0.7, label="other seeds")
        axes.legend(frameon=False)
        return png(figure)


def convergence_of_joints(runs: Sequence[Sequence[Mapping[str, Sequence[float]]]], title: str, agents: int) -> bytes:
    """Two by two panels: J over the iterations of a pack of `agents`, the first run strong."""
    with styled():
        figure, grid = plt.subplots(2, 2, figsize=(8.0, 5.4), sharex=True)
        figure.subplots_adjust(left=0.1, right=0.985, bottom=0.1, top=0.89, wspace=0.2, hspace=0.24)
        figure.suptitle(title, fontsize=11, fontweight="bold", y=0.975)
        for joint, axes in enumerate(grid.flat):
            for number, run in reversed(list(enumerate(runs))):
                curve = run[joint]
                iteration = np.array(curve["evaluations"]) / agents - 1.0
                strong = number == 0
                axes.step(
                    iteration,
                    curve["cost"],
                    where="post",
                    color=BLUE if strong else "#aaaaaa",
                    linewidth=1.7 if strong else 0.7,
                    label="first seed" if strong else "other seeds" if number == 1 else None,
                )
            axes.set_title(TITLES[joint], fontsize=9)
            axes.margins(y=0.08)
        grid[0, 0].legend(frameon=False, fontsize=8)
        _label(grid, "iteration", "J = ITAE + ITAU")
        return png(figure)


def sets_of(controllers: Controllers, joint: int, change: bool) -> tuple[float, float, float, float]:
    """The corners of one input's sets."""
    names = _CE if change else _E
    left, a, c, right = (float(controllers[joint, CONTROLLER_COLUMNS.index(name)]) / SET_UNIT for name in names)
    return left, a, c, right


def _draw_sets(axes: Axes, corners: tuple[float, float, float, float], names: Sequence[str], style: str = "-") -> None:
    left, a, c, right = corners
    shapes = (
        ([-1.0, left, 0.0], [1.0, 1.0, 0.0]),
        ([a, 0.0, c], [0.0, 1.0, 0.0]),
        ([0.0, right, 1.0], [0.0, 1.0, 1.0]),
    )
    for (x, y), colour, name in zip(shapes, (ORANGE, DARK, BLUE), names, strict=True):
        axes.plot(x, y, style, color=colour, linewidth=1.6, label=name)
    axes.set_xlim(-1.03, 1.03)
    axes.set_ylim(-0.03, 1.08)


def sets_before(controllers: Controllers) -> bytes:
    """Fig. 11: both inputs and the output."""
    with styled():
        figure, row = plt.subplots(1, 3, figsize=(9.4, 2.8), sharey=True)
        figure.subplots_adjust(left=0.07, right=0.985, bottom=0.2, top=0.88, wspace=0.1)
        _draw_sets(row[0], sets_of(controllers, 0, False), _SETS["e"])
        _draw_sets(row[1], sets_of(controllers, 0, True), _SETS["ce"])
        width = 0.02
        for centre, colour, name in zip((-1.0, 0.0, 1.0), (ORANGE, DARK, BLUE), _SETS["u"], strict=True):
            row[2].plot(
                [centre - width, centre, centre + width], [0.0, 1.0, 0.0], color=colour, linewidth=1.6, label=name
            )
        row[2].set_xlim(-1.08, 1.08)
        for axes, title in zip(row, ("error $K_p\\,e$", "change of error $K_d\\,ce$", "output"), strict=True):
            axes.set_title(title, fontsize=9)
            axes.set_xlabel("normalised")
            axes.legend(frameon=False, fontsize=8, loc="center", bbox_to_anchor=(0.77, 0.5))
        row[0].set_ylabel("membership")
        return png(figure)


def tuneable() -> bytes:
    """Fig. 12: the corners that are tuned, by their names, and how far each may go."""
    names = (
        ("Ne_trapmf_c", "Ze_trimf_a", "Ze_trimf_c", "Pe_trapmf_b"),
        ("Nce_trapmf_c", "Zce_trimf_a", "Zce_trimf_c", "Pce_trapmf_b"),
    )
    with styled():
        figure, row = plt.subplots(1, 2, figsize=(9.4, 3.2), sharey=True)
        figure.subplots_adjust(left=0.07, right=0.985, bottom=0.16, top=0.9, wspace=0.08)
        for axes, own, words in zip(row, names, (_SETS["e"], _SETS["ce"]), strict=True):
            corners = (-0.6, -0.5, 0.5, 0.6)
            _draw_sets(axes, corners, words)
            for x, y, name, place in zip(corners, (1.0, 0.0, 0.0, 1.0), own, (0.6, 0.16, 0.16, 0.6), strict=True):
                side = 1.0 if x > 0.0 else -1.0
                axes.plot([x], [y], "o", color=GREEN, zorder=4)
                axes.annotate(
                    name, (x, y), (0.97 * side, place), ha="right" if x > 0.0 else "left", fontsize=8, color=GREEN,
                    arrowprops={"arrowstyle": "-", "color": GREEN, "linewidth": 0.7},
                )  # fmt: skip
            axes.annotate("", (-1.0, 1.05), (0.0, 1.05), arrowprops={"arrowstyle": "<->", "color": "#777777"})
            axes.annotate("", (0.0, 1.05), (1.0, 1.05), arrowprops={"arrowstyle": "<->", "color": "#777777"})
            axes.set_title("error" if words is _SETS["e"] else "change of error", fontsize=9)
            axes.set_xlabel("normalised")
            axes.legend(frameon=False, fontsize=8, loc="center left", bbox_to_anchor=(0.0, 0.38))
        row[0].set_ylabel("membership")
        return png(figure)


def sets_after(before: Controllers, after: Mapping[str, Controllers]) -> bytes:
    """Fig. 16: the sets of each joint before (dotted) and after, a column for each source and input."""
    sources = list(after.items())
    with styled():
        figure, grid = plt.subplots(JOINTS, 2 * len(sources), figsize=(10.0, 7.6), sharex=True, sharey=True)
        figure.subplots_adjust(left=0.06, right=0.985, bottom=0.1, top=0.91, wspace=0.08, hspace=0.16)
        for column, (name, controllers) in enumerate(sources):
            for change in (False, True):
                words = _SETS["ce" if change else "e"]
                for joint in range(JOINTS):
                    axes = grid[joint, 2 * column + change]
                    _draw_sets(axes, sets_of(before, joint, change), words, ":")
                    _draw_sets(axes, sets_of(controllers, joint, change), words)
                    axes.set_xticks((-1.0, 0.0, 1.0))
                grid[0, 2 * column + change].set_title(
                    f"{name}:\n{'change of error' if change else 'error'}", fontsize=9
                )
        for joint in range(JOINTS):
            grid[joint, 0].set_ylabel(f"Joint {joint}")
        for axes in grid[-1]:
            axes.set_xlabel("normalised", fontsize=8)
        lines = [Line2D([], [], color=colour) for colour in (ORANGE, DARK, BLUE)]
        lines += [Line2D([], [], color="#777777", linestyle=style) for style in (":", "-")]
        labels = ["NE / NCE", "ZE / ZCE", "PE / PCE", "before", "after"]
        figure.legend(lines, labels, loc="lower center", ncols=5, frameon=False)
        return png(figure)


def surfaces(controllers: Mapping[str, Controllers], joint: int) -> bytes:
    """The control surface: the fuzzy output over both inputs."""
    axis = np.linspace(-1.0, 1.0, 201)
    x, y = np.meshgrid(axis, axis)
    with styled():
        figure, row = plt.subplots(1, len(controllers), figsize=(9.4, 4.1), sharey=True)
        figure.subplots_adjust(left=0.07, right=0.9, bottom=0.13, top=0.89, wspace=0.08)
        for axes, (name, rows) in zip(np.atleast_1d(row), controllers.items(), strict=True):
            law = Law.of(np.repeat(rows[joint][None], JOINTS, axis=0))
            law = Law(law.sets, np.ones_like(law.gains))
            points = [np.repeat(one.ravel()[:, None], JOINTS, axis=1) for one in (x, y)]
            u = law.fuzzy(*points)[0][:, 0].reshape(x.shape)
            shade = axes.contourf(x, y, u, levels=np.linspace(-1.0, 1.0, 21), cmap="RdBu_r")
            axes.contour(x, y, u, levels=(-0.5, 0.0, 0.5), colors=DARK, linewidths=0.7)
            axes.set_title(name, fontsize=9)
            axes.set_xlabel("error $K_p\\,e$")
            axes.set_xticks((-1.0, -0.5, 0.0, 0.5, 1.0), ("−1", "−0.5", "0", "0.5", "1"))
            axes.grid(False)
        np.atleast_1d(row)[0].set_ylabel("change of error $K_d\\,ce$")
        bar = figure.colorbar(shade, cax=figure.add_axes((0.915, 0.13, 0.02, 0.76)), ticks=(-1.0, -0.5, 0.0, 0.5, 1.0))
        bar.set_label("fuzzy output")
        return png(figure)


def ranks(places: Mapping[str, Mapping[str, float]], title: str) -> bytes:
    """Mean ranks of methods, a group of bars for each problem; the lowest is best."""
    problems = list(places)
    methods = list(next(iter(places.values())))
    with styled():
        figure, axes = plt.subplots(figsize=(9.4, 3.6))
        figure.subplots_adjust(left=0.07, right=0.985, bottom=0.19, top=0.9)
        width = 0.8 / len(problems)
        for number, (problem, colour) in enumerate(zip(problems, (DARK, *COLOURS), strict=False)):
            at = np.arange(len(methods)) + (number - 0.5 * (len(problems) - 1)) * width
            axes.bar(at, [places[problem][method] for method in methods], width, color=colour, label=problem)
        axes.set_xticks(
            range(len(methods)), [method.replace(", ", ",\n").replace(" (", "\n(") for method in methods], fontsize=8
        )
        axes.set_ylabel("mean rank (1 is best)")
        axes.grid(axis="x", visible=False)
        axes.set_title(title, fontsize=10)
        axes.legend(frameon=False, ncols=len(problems), fontsize=8, loc="upper left")
        axes.set_ylim(0, len(methods) + 1.2)
        return png(figure)
