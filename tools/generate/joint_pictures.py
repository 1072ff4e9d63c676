"""Draws which way of each joint is positive, for docs/calibrate.md: `python -m tools.generate`.

Each view turns points by the right-hand rule about the joint's own axis (docs/arm.md); a test compares the axes with
those of the exported arm.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.types import Floats
from greywhale.board.calibrate.words import POSITIVE_WAYS
from tools import ROOT
from tools.generate.current import keep_current

PICTURE = ROOT / "docs" / "images" / "joints-positive.svg"
STYLE = 'font-family="DejaVu Sans, Arial, sans-serif" font-size="14"'
ARM, BEFORE, WAY = "#1f618d", "#bbbbbb", "#c0392b"
X, Y, Z = np.eye(3)  # along the arm at 0, up, to the arm's right
WIDTH, HEIGHT = 260.0, 240.0  # of a view
TURN = np.radians(40.0)
DRAWN = np.linspace(0.0, 1.0, 13)
Point = tuple[float, float]


@dataclass(frozen=True)
class View:
    """A joint seen so that `right` and `up` are so on the page; only `turning` lines turn, about `hinge`."""

    axis: Floats
    seen: str
    right: Floats
    up: Floats
    fixed: Sequence[tuple[Floats, Floats]]
    turning: Sequence[tuple[Floats, Floats]]
    hinge: Floats
    reach: float  # of the arrow


STAND = (-60 * Y, 0 * Y)
HAND = [(40 * Z, -40 * Z), (40 * Z, 40 * Z + 22 * Y), (-40 * Z, -40 * Z + 22 * Y)]
VIEWS = (
    View(Y, "seen from above", X, -Z, [], [(0 * X, 120 * X)], 0 * X, 95.0),
    View(Z, "seen from the arm's right", X, Y, [STAND], [(0 * X, 120 * X)], 0 * X, 95.0),
    View(Z, "seen from the arm's right", X, Y, [STAND, (0 * X, 70 * X)], [(70 * X, 140 * X)], 70 * X, 60.0),
    View(X, "seen from the elbow", Z, Y, [], HAND, 0 * X, 62.0),
)


def turned(point: Floats, axis: Floats, angle: float) -> Floats:
    """A point turned about an axis through the origin by the right-hand rule."""
    along = axis * (axis @ point)
    found: Floats = along + (point - along) * np.cos(angle) + np.cross(axis, point) * np.sin(angle)
    return found


class Picture:
    """An SVG that grows element by element; coordinates in pixels, y down."""

    def __init__(self, width: float, height: float, title: str) -> None:
        size = f'width="{width:g}" height="{height:g}"'
        self._parts = [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" {size} {STYLE}>',
            f"<title>{escape(title)}</title>",
            f'<rect {size} fill="#ffffff"/>',
        ]

    def text(self, x: float, y: float, text: str, anchor: str = "start", colour: str = "#111") -> None:
        self._parts.append(f'<text x="{x:g}" y="{y:g}" text-anchor="{anchor}" fill="{colour}">{escape(text)}</text>')

    def wire(self, points: Sequence[Point], colour: str, width: float) -> None:
        path = " ".join(f"{x:g},{y:g}" for x, y in points)
        self._parts.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="{width:g}"/>')

    def dot(self, x: float, y: float, colour: str) -> None:
        self._parts.append(f'<circle cx="{x:g}" cy="{y:g}" r="4" fill="{colour}"/>')

    def svg(self) -> str:
        return "\n".join([*self._parts, "</svg>", ""])


def draw() -> Picture:
    drawn = Picture(2 * WIDTH + 40, 2 * HEIGHT + 20, "Which way of each joint is positive")
    for joint, view in enumerate(VIEWS):
        left, top = 20 + WIDTH * (joint % 2), 10 + HEIGHT * (joint // 2)
        drawn.text(left, top + 20, f"joint {joint}, {JOINT_NAMES[joint]}")
        drawn.text(left, top + 40, f"{view.seen}:")
        drawn.text(left, top + 60, f"+ {POSITIVE_WAYS[joint].partition(',')[0]}", "start", WAY)
        centre = (left + (140 if joint == 3 else 60), top + 165)
        _draw_joint(drawn, view, centre)
    return drawn


def _draw_joint(drawn: Picture, view: View, centre: Point) -> None:
    def at(point: Floats) -> Point:
        return centre[0] + float(view.right @ point), centre[1] - float(view.up @ point)

    def there(point: Floats, angle: float = TURN) -> Floats:
        return view.hinge + turned(point - view.hinge, view.axis, angle)

    for one, other in view.turning:
        drawn.wire([at(one), at(other)], BEFORE, 6)
    for one, other in view.fixed:
        drawn.wire([at(one), at(other)], ARM, 6)
    for one, other in view.turning:
        drawn.wire([at(there(one)), at(there(other))], ARM, 6)
    drawn.dot(*at(view.hinge), "#222222")
    start = view.hinge + view.reach * (Z if view.axis is X else X)
    drawn.wire([at(there(start, share * TURN)) for share in DRAWN], WAY, 3)
    tip, before = there(start), there(start, 0.8 * TURN)
    outward = (tip - view.hinge) / view.reach
    drawn.wire([at(before + 7 * outward), at(tip), at(before - 7 * outward)], WAY, 3)
    x, y = at(view.hinge + 1.2 * (there(start, TURN / 2) - view.hinge))
    drawn.text(x, y + 5, "+", "middle", WAY)


def main(arguments: list[str]) -> int:
    """With `--check` nothing is written; 1 where the picture is stale."""
    return keep_current({str(PICTURE.relative_to(ROOT)): draw().svg()}, "--check" in arguments)
