"""Pictures of the paper's report: responses, convergence, sets, control surfaces and ranks, each as a PNG."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from greywhale.base.types import Controllers, Floats
from greywhale.pictures import looks
from greywhale.pictures.identification import Trace, plot_convergence, plot_responses
from greywhale.pictures.looks import DARK, GREEN, GREY, SIGNS
from greywhale.pictures.membership import corners_of, draw_shapes
from greywhale.pictures.page import JOINTS as JOINT_TITLES
from greywhale.pictures.page import (
    SMALL,
    WIDE,
    headline,
    leave,
    legend_below,
    png,
    style,
)
from greywhale.pictures.plotting import Line2D, plt
from greywhale.protocol.firmware import JOINTS
from greywhale_paper.pictures.ranks import plot_ranks

J_WORDS = "J = ITAE [rad s²] + ITAU [V s²]"
PAPER = looks.PAPERS_METHOD.colour
_BAR = (0.9, 0.42 / 3.1, 0.02, 1.0 - (0.26 + 0.42) / 3.1)  # left, bottom, width, height
_SETS = {"e": ("NE", "ZE", "PE"), "ce": ("NCE", "ZCE", "PCE"), "u": ("NU", "ZU", "PU")}


def responses(
    traces: Sequence[Trace], against: Trace, title: str, error: str, *, window: tuple[float, float] | None = None
) -> bytes:
    with style():
        return png(plot_responses(traces, against, title, error, window=window))


def convergence(curves: Mapping[str, Sequence[float]], title: str) -> bytes:
    with style():
        return png(plot_convergence(curves, title, looks.PAPERS_METHOD))


def convergence_of_joints(runs: Sequence[Sequence[Mapping[str, Sequence[float]]]], title: str, agents: int) -> bytes:
    """Two by two panels: J over the iterations of a pack of `agents`, the first run strong."""
    with style():
        figure, grid = plt.subplots(2, 2, figsize=(WIDE, 4.4), sharex=True)
        figure.subplots_adjust(**leave(figure, 0.62, 0.12, 0.42, 0.5, wspace=0.2, hspace=0.26))
        headline(figure, title)
        for joint, axes in enumerate(grid.flat):
            for number, run in reversed(list(enumerate(runs))):
                curve = run[joint]
                iteration = np.array(curve["evaluations"]) / agents - 1.0
                strong = number == 0
                axes.step(
                    iteration,
                    curve["cost"],
                    where="post",
                    color=PAPER if strong else GREY,
                    linewidth=1.5 if strong else 0.6,
                    label="first seed" if strong else "other seeds" if number == 1 else None,
                )
            axes.set_title(JOINT_TITLES[joint])
            axes.margins(y=0.08)
        grid[0, 0].legend(frameon=False, fontsize=SMALL)
        for axes in grid[-1]:
            axes.set_xlabel("iteration")
        figure.supylabel(J_WORDS, x=0.06 / WIDE, ha="left", fontsize="medium")
        return png(figure)


def sets_before(controllers: Controllers) -> bytes:
    """Fig. 11: both inputs and the output."""
    with style():
        figure, row = plt.subplots(1, 3, figsize=(WIDE, 2.1), sharey=True)
        figure.subplots_adjust(**leave(figure, 0.5, 0.12, 0.42, 0.26, wspace=0.1))
        draw_shapes(row[0], corners_of(controllers, 0, False), looks.SETS_AFTER, _SETS["e"])
        draw_shapes(row[1], corners_of(controllers, 0, True), looks.SETS_AFTER, _SETS["ce"])
        width = 0.02
        for centre, colour, name in zip((-1.0, 0.0, 1.0), SIGNS, _SETS["u"], strict=True):
            row[2].plot(
                [centre - width, centre, centre + width], [0.0, 1.0, 0.0], color=colour, linewidth=1.3, label=name
            )
        row[2].set_xlim(-1.08, 1.08)
        for axes, title in zip(row, ("error $K_p\\,e$", "change of error $K_d\\,ce$", "output"), strict=True):
            axes.set_title(title)
            axes.set_xlabel("normalised")
            axes.legend(frameon=False, fontsize=SMALL, loc="center", bbox_to_anchor=(0.77, 0.5))
        row[0].set_ylabel("membership")
        return png(figure)


def tuneable() -> bytes:
    """Fig. 12: the corners that are tuned, by their names, and how far each may go."""
    names = (
        ("Ne_trapmf_c", "Ze_trimf_a", "Ze_trimf_c", "Pe_trapmf_b"),
        ("Nce_trapmf_c", "Zce_trimf_a", "Zce_trimf_c", "Pce_trapmf_b"),
    )
    with style():
        figure, row = plt.subplots(1, 2, figsize=(WIDE, 2.5), sharey=True)
        figure.subplots_adjust(**leave(figure, 0.5, 0.12, 0.42, 0.26, wspace=0.08))
        for axes, own, words in zip(row, names, (_SETS["e"], _SETS["ce"]), strict=True):
            corners = (-0.6, -0.5, 0.5, 0.6)
            draw_shapes(axes, corners, looks.SETS_AFTER, words)
            for x, y, name, place in zip(corners, (1.0, 0.0, 0.0, 1.0), own, (0.6, 0.16, 0.16, 0.6), strict=True):
                side = 1.0 if x > 0.0 else -1.0
                axes.plot([x], [y], "o", color=GREEN, zorder=4)
                axes.annotate(
                    name, (x, y), (0.97 * side, place), ha="right" if x > 0.0 else "left", fontsize=SMALL, color=GREEN,
                    arrowprops={"arrowstyle": "-", "color": GREEN, "linewidth": 0.7},
                )  # fmt: skip
            axes.annotate("", (-1.0, 1.05), (0.0, 1.05), arrowprops={"arrowstyle": "<->", "color": GREY})
            axes.annotate("", (0.0, 1.05), (1.0, 1.05), arrowprops={"arrowstyle": "<->", "color": GREY})
            axes.set_title("error" if words is _SETS["e"] else "change of error")
            axes.set_xlabel("normalised")
            axes.legend(frameon=False, fontsize=SMALL, loc="center left", bbox_to_anchor=(0.0, 0.38))
        row[0].set_ylabel("membership")
        return png(figure)


def sets_after(before: Controllers, after: Mapping[str, Controllers]) -> bytes:
    """Fig. 16: the sets of each joint before (dashed) and after, a column for each source and input."""
    sources = list(after.items())
    with style():
        figure, grid = plt.subplots(JOINTS, 2 * len(sources), figsize=(WIDE, 5.6), sharex=True, sharey=True)
        figure.subplots_adjust(**leave(figure, 0.72, 0.12, 0.66, 0.6, wspace=0.1, hspace=0.16))
        for column, (name, controllers) in enumerate(sources):
            for change in (False, True):
                words = _SETS["ce" if change else "e"]
                for joint in range(JOINTS):
                    axes = grid[joint, 2 * column + change]
                    draw_shapes(axes, corners_of(before, joint, change), looks.SETS_BEFORE, words)
                    draw_shapes(axes, corners_of(controllers, joint, change), looks.SETS_AFTER, words)
                    axes.set_xticks((-1.0, 0.0, 1.0))
                grid[0, 2 * column + change].set_title(
                    f"{name}:\n{'change of error' if change else 'error'}".replace(", ", ",\n"), fontsize=9
                )
        for joint in range(JOINTS):
            grid[joint, 0].set_ylabel(f"Joint {joint}\nmembership")
        for axes in grid[-1]:
            axes.set_xlabel("normalised", fontsize=SMALL)
        lines = [Line2D([], [], color=colour) for colour in SIGNS]
        lines += [Line2D([], [], **look.line) for look in (looks.SETS_BEFORE, looks.SETS_AFTER)]
        labels = ["NE / NCE", "ZE / ZCE", "PE / PCE", "before", "after"]
        legend_below(figure, lines, labels)
        return png(figure)


def surfaces(outputs: Mapping[str, Floats]) -> bytes:
    """The control surface: fuzzy outputs (rows, columns) over an even grid of change of error and error, -1 to 1."""
    with style():
        figure, row = plt.subplots(1, len(outputs), figsize=(WIDE, 3.1), sharey=True)
        figure.subplots_adjust(**leave(figure, 0.7, 0.75, 0.42, 0.26, wspace=0.08))
        for axes, (name, u) in zip(np.atleast_1d(row), outputs.items(), strict=True):
            y, x = (np.linspace(-1.0, 1.0, count) for count in u.shape)
            shade = axes.contourf(x, y, u, levels=np.linspace(-1.0, 1.0, 21), cmap="RdBu_r")
            axes.contour(x, y, u, levels=(-0.5, 0.0, 0.5), colors=DARK, linewidths=0.7)
            axes.set_title(name)
            axes.set_xlabel("error $K_p\\,e$")
            axes.set_xticks((-1.0, -0.5, 0.0, 0.5, 1.0), ("−1", "−0.5", "0", "0.5", "1"))
            axes.grid(False)
        np.atleast_1d(row)[0].set_ylabel("change of error $K_d\\,ce$")
        bar = figure.colorbar(shade, cax=figure.add_axes(_BAR), ticks=(-1.0, -0.5, 0.0, 0.5, 1.0))
        bar.set_label("fuzzy output")
        return png(figure)


def ranks(places: Mapping[str, Mapping[str, float]], title: str) -> bytes:
    with style():
        return png(plot_ranks(places, title))
