"""Block diagrams, and the arm in two dimensions, in the paper's words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from greywhale.files.arm import load_arm
from greywhale.pictures.looks import BLUE, DARK, ORANGE
from greywhale.pictures.page import LETTERS, SMALL, WIDE, leave, png, style
from greywhale.pictures.plotting import Axes, FancyBboxPatch, plt

Point = tuple[float, float]

_ARROW = {"arrowstyle": "-|>", "color": DARK, "linewidth": 1.1, "shrinkA": 0.0, "shrinkB": 0.0}


@dataclass(frozen=True)
class Box:
    """Words in a box around a place."""

    text: str
    x: float
    y: float
    width: float = 1.7
    height: float = 0.72


def diagram(
    boxes: Sequence[Box], arrows: Sequence[tuple[Sequence[Point], str]], height: float, extent: tuple[float, float]
) -> bytes:
    """Boxes, and arrows along points with their words near the first stretch's middle."""
    with style():
        figure, axes = plt.subplots(figsize=(WIDE, height))
        figure.subplots_adjust(left=0.01, right=0.99, bottom=0.02, top=0.98)
        axes.set_xlim(0.0, extent[0])
        axes.set_ylim(0.0, extent[1])
        axes.set_axis_off()
        for box in boxes:
            _box(axes, box)
        for points, words in arrows:
            _arrow(axes, points, words)
        return png(figure)


def _box(axes: Axes, box: Box) -> None:
    corner = (box.x - 0.5 * box.width, box.y - 0.5 * box.height)
    round_corners = "round,pad=0,rounding_size=0.08"
    axes.add_patch(
        FancyBboxPatch(corner, box.width, box.height, boxstyle=round_corners, facecolor="#eef3f8", edgecolor=BLUE)
    )
    axes.text(box.x, box.y, box.text, ha="center", va="center", fontsize=LETTERS, color=DARK)


def _arrow(axes: Axes, points: Sequence[Point], words: str) -> None:
    path = np.array(points)
    axes.plot(path[:-1, 0], path[:-1, 1], color=DARK, linewidth=1.1)
    axes.annotate("", path[-1], path[-2], arrowprops=_ARROW)
    if words:
        middle = 0.5 * (path[0] + path[1])
        level = abs(path[0, 1] - path[1, 1]) < 1e-9
        place = middle + ((0.0, 0.1) if level else (0.08, 0.0))
        axes.text(
            place[0],
            place[1],
            words,
            fontsize=SMALL,
            ha="center" if level else "left",
            va="bottom" if level else "center",
        )


def system() -> bytes:
    """Fig. 2: what is joined to what."""
    boxes = (
        Box("Leader arm\n4 potentiometers", 1.2, 1.6, 1.9),
        Box("Arduino\n4 fuzzy PD+I\ncontrollers", 4.2, 1.6, 1.9, 1.0),
        Box("Motor drivers\nDC supply", 7.0, 1.6, 1.7),
        Box("Follower arm\n4 DC servomotors\n4 potentiometers", 9.7, 1.6, 1.9, 1.0),
        Box("PC", 4.2, 0.4, 1.2, 0.5),
    )
    arrows = (
        (((2.15, 1.6), (3.25, 1.6)), "angles"),
        (((5.15, 1.6), (6.15, 1.6)), "duty"),
        (((7.85, 1.6), (8.75, 1.6)), "voltage"),
        (((9.7, 2.1), (9.7, 2.6), (4.2, 2.6), (4.2, 2.1)), "angles"),
        (((4.2, 1.1), (4.2, 0.65)), "serial link"),
    )
    return diagram(boxes, arrows, 1.86, (10.9, 2.9))


def identification() -> bytes:
    """Fig. 4: the procedure of grey-box identification."""
    boxes = (
        Box("Leader arm", 1.1, 1.8, 1.5),
        Box("Real follower arm\nin its loop", 4.0, 2.7, 2.0),
        Box("Euler–Lagrange model\nin the same loop", 4.0, 0.9, 2.2),
        Box("difference", 6.7, 1.8, 1.3, 0.6),
        Box("GWO-WOA\nleast MSE", 9.0, 1.8, 1.6),
    )
    arrows = (
        (((1.85, 1.8), (2.4, 1.8), (2.4, 2.7), (3.0, 2.7)), ""),
        (((2.4, 1.8), (2.4, 0.9), (2.9, 0.9)), ""),
        (((5.0, 2.7), (6.7, 2.7), (6.7, 2.1)), "measured angles"),
        (((5.1, 0.9), (6.7, 0.9), (6.7, 1.5)), "predicted angles"),
        (((7.35, 1.8), (8.2, 1.8)), "errors"),
        (((9.0, 1.44), (9.0, 0.25), (4.0, 0.25), (4.0, 0.54)), "20 motor values"),
    )
    return diagram(boxes, arrows, 2.16, (10.8, 3.3))


def law() -> bytes:
    """Fig. 9: the fuzzy PD+I controller."""
    boxes = (
        Box("$K_p$", 2.4, 2.4, 0.9, 0.55),
        Box("$K_d\\,\\Delta$", 2.4, 1.4, 0.9, 0.55),
        Box("$K_i \\int$", 2.4, 0.4, 0.9, 0.55),
        Box("fuzzy inference\n9 rules, min–max", 5.0, 1.9, 2.0, 1.1),
        Box("$K_u$", 7.2, 1.9, 0.9, 0.55),
        Box("+", 8.8, 1.9, 0.5, 0.5),
    )
    arrows = (
        (((0.4, 1.4), (1.95, 1.4)), "e(k)"),
        (((1.5, 1.4), (1.5, 2.4), (1.95, 2.4)), ""),
        (((1.5, 1.4), (1.5, 0.4), (1.95, 0.4)), ""),
        (((2.85, 2.4), (3.4, 2.4), (3.4, 2.2), (4.0, 2.2)), ""),
        (((2.85, 1.4), (3.4, 1.4), (3.4, 1.6), (4.0, 1.6)), ""),
        (((6.0, 1.9), (6.75, 1.9)), ""),
        (((7.65, 1.9), (8.55, 1.9)), ""),
        (((2.85, 0.4), (8.8, 0.4), (8.8, 1.65)), ""),
        (((9.05, 1.9), (10.0, 1.9)), "u(k)"),
    )
    return diagram(boxes, arrows, 1.93, (10.3, 2.9))


def scheme() -> bytes:
    """Fig. 10: one controller a joint, in joint space."""
    boxes, arrows = [], []
    for joint in range(4):
        y = 3.6 - joint
        boxes += [
            Box(f"leader, joint {joint}", 1.0, y, 1.5, 0.55),
            Box(f"fuzzy PD+I {joint}", 4.3, y, 1.6, 0.55),
            Box(f"motor {joint}", 6.9, y, 1.2, 0.55),
        ]
        arrows += [
            (((1.75, y), (3.5, y)), f"$\\theta_{{m{joint}}}$"),
            (((5.1, y), (6.3, y)), f"$u_{joint}$"),
            (((7.5, y), (8.3, y)), ""),
            (((8.3, y - 0.18), (7.9, y - 0.18), (7.9, y - 0.42), (4.3, y - 0.42), (4.3, y - 0.28)), ""),
        ]
    boxes.append(Box("follower\narm", 8.95, 2.1, 1.3, 3.6))
    return diagram(boxes, arrows, 2.90, (10.0, 4.1))


def closed_loop() -> bytes:
    """Fig. 13: the loop in which the sets are tuned."""
    boxes = (
        Box("fuzzy PD+I\ncontroller", 3.6, 1.6, 1.7),
        Box("grey-box model\nof a joint", 6.9, 1.6, 1.8),
        Box("GWO-WOA\nleast ITAE + ITAU", 4.8, 2.9, 2.1),
        Box("−", 1.7, 1.6, 0.45, 0.45),
    )
    arrows = (
        (((0.2, 1.6), (1.47, 1.6)), "leader"),
        (((1.93, 1.6), (2.75, 1.6)), ""),
        (((4.45, 1.6), (6.0, 1.6)), ""),
        (((7.8, 1.6), (9.3, 1.6)), "follower"),
        (((8.6, 1.6), (8.6, 0.5), (1.7, 0.5), (1.7, 1.37)), ""),
        (((2.3, 1.6), (2.3, 3.1), (3.75, 3.1)), "e(k)"),
        (((5.2, 1.6), (5.2, 2.54)), "u(k)"),
        (((3.75, 2.75), (3.2, 2.75), (3.2, 1.96)), "sets"),
    )
    return diagram(boxes, arrows, 2.23, (9.6, 3.5))


def arm() -> bytes:
    """Fig. 3: the links of the follower to scale, in a pose."""
    links = load_arm("white_box").link
    angles = (0.5 * np.pi, 0.7, 0.7 - 0.9, 0.7 - 0.9)
    points = [np.zeros(2)]
    for link, angle in zip(links, angles, strict=True):
        points.append(points[-1] + link.length * np.array([np.cos(angle), np.sin(angle)]))
    path = np.array(points)
    with style():
        figure, axes = plt.subplots(figsize=(WIDE, 3.6))
        figure.subplots_adjust(**leave(figure, 0.6, 0.12, 0.42, 0.1))
        axes.plot(path[:, 0], path[:, 1], "-", color=BLUE, linewidth=5, alpha=0.35, solid_capstyle="round")
        for number, (link, angle) in enumerate(zip(links, angles, strict=True)):
            along = np.array([np.cos(angle), np.sin(angle)])
            centre = path[number] + link.centre * along
            axes.plot(*centre, "o", color=ORANGE, markersize=6)
            aside = centre + 0.016 * np.array([-along[1], along[0]])
            words = f"$L_{number}$ = {1000 * link.length:g} mm, {1000 * link.mass:g} g"
            axes.text(aside[0], aside[1], words, fontsize=SMALL, va="bottom", ha="left" if number == 3 else "right")
        for place, word in ((0, "base yaw $\\theta_0$"), (1, "shoulder $\\theta_1$"), (2, "wrist pitch $\\theta_2$")):
            axes.plot(*path[place], "o", color=DARK, markersize=8, fillstyle="none", markeredgewidth=1.6)
            aside = (0.0, -0.032) if place == 2 else (0.012, -0.012)
            axes.annotate(word, path[place] + aside, fontsize=SMALL, va="top", ha="center" if place == 2 else "left")
        axes.annotate("wrist roll $\\theta_3$", path[3] + (0.0, -0.018), fontsize=SMALL, va="top")
        axes.plot(*path[3], "s", color=DARK, markersize=7, fillstyle="none", markeredgewidth=1.6)
        axes.set_xlim(-0.13, 0.4)
        axes.set_ylim(-0.03, 0.24)
        axes.set_aspect("equal")
        axes.set_xlabel("x [m]")
        axes.set_ylabel("y [m]")
        return png(figure)
