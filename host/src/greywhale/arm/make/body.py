"""A link as a body: a bar or a tube of a material or a weight, with parts mounted on it.

Moments are about the centre of mass, kg m²; `along` is about the link's own line. Parts count as points on that line.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

# kg/m³
MATERIALS = {
    "aluminium": 2700.0,
    "steel": 7850.0,
    "acrylic": 1190.0,
    "pla": 1240.0,
    "abs": 1040.0,
    "plywood": 680.0,
    "pine": 500.0,
    "carbon": 1600.0,
}


@dataclass(frozen=True)
class Section:
    """A cut across the link: `area` m², and mean squares (m²) of width (pitch axis) and height over it."""

    area: float
    width2: float
    height2: float


def bar(width: float, height: float) -> Section:
    """A solid bar; width lies along the pitch axis, height across it (m)."""
    return Section(width * height, width**2 / 12.0, height**2 / 12.0)


def tube(outer: float, wall: float) -> Section:
    """A round tube, or a rod where the wall is half of the outer diameter (m)."""
    inner = outer - 2.0 * wall
    square = (outer**2 + inner**2) / 16.0
    return Section(math.pi / 4.0 * (outer**2 - inner**2), square, square)


@dataclass(frozen=True)
class Body:
    """A rigid link: mass (kg), its centre from the nearer joint (m), and moments about it (kg m²).

    `width` is about the pitch axis' own direction (z), `height` about the one across (y at zero pitch).
    """

    mass: float
    centre: float
    along: float
    about_height: float
    about_width: float


def uniform(section: Section, length: float, mass: float) -> Body:
    """A body with one section from joint to joint."""
    slender = length**2 / 12.0
    return Body(
        mass,
        length / 2.0,
        mass * (section.width2 + section.height2),
        mass * (slender + section.width2),
        mass * (slender + section.height2),
    )


def with_parts(body: Body, mass: float, distance: float) -> Body:
    """The body with so much mass (kg) added at one point of its line, `distance` (m) from the nearer joint."""
    total = body.mass + mass
    centre = (body.mass * body.centre + mass * distance) / total
    shifted = body.mass * (body.centre - centre) ** 2 + mass * (distance - centre) ** 2
    return Body(total, centre, body.along, body.about_height + shifted, body.about_width + shifted)
