"""Links as bodies: mass, centre and moments agree with the sum over many small pieces."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm.make.body import Body, Section, bar, tube, uniform, with_parts

LENGTH, DENSITY = 0.14, 2700.0
FINE = 400


def pieces(width: float, height: float, inside: np.ndarray | None = None) -> np.ndarray:
    """(n, 2) m: the middles of small squares of a section, those that are inside."""
    across, up = np.meshgrid(*((np.arange(FINE) + 0.5) / FINE - 0.5,) * 2)
    points = np.column_stack([width * across.ravel(), height * up.ravel()])
    return points if inside is None else points[inside]


def summed(points: np.ndarray, area: float) -> Body:
    """The body of which these are the pieces of every section, by summing up."""
    along = (np.arange(FINE) + 0.5) / FINE * LENGTH
    mass = DENSITY * area * LENGTH
    width2, height2 = (points**2).mean(axis=0)
    slender = ((along - LENGTH / 2) ** 2).mean()
    return Body(mass, LENGTH / 2, mass * (width2 + height2), mass * (slender + width2), mass * (slender + height2))


def same(one: Body, other: Body, rel: float) -> None:
    for name in ("mass", "centre", "along", "about_height", "about_width"):
        assert getattr(one, name) == pytest.approx(getattr(other, name), rel=rel), name


def made(section: Section) -> Body:
    return uniform(section, LENGTH, DENSITY * section.area * LENGTH)


def test_a_bar() -> None:
    same(made(bar(0.03, 0.01)), summed(pieces(0.03, 0.01), 0.03 * 0.01), 2e-5)


@pytest.mark.parametrize("wall", [0.002, 0.005, 0.0125])
def test_a_tube_and_a_rod(wall: float) -> None:
    square = pieces(0.025, 0.025)
    radius = np.hypot(*square.T)
    ring = square[(radius <= 0.0125) & (radius >= 0.0125 - wall)]
    same(made(tube(0.025, wall)), summed(ring, len(ring) / FINE**2 * 0.025**2), 2e-2)
    assert tube(0.025, 0.0125).area == pytest.approx(np.pi * 0.0125**2)


def test_parts_move_the_centre_and_add_by_their_distance_from_it() -> None:
    link = made(tube(0.02, 0.001))
    loaded = with_parts(link, 0.2, 0.12)
    assert loaded.mass == pytest.approx(link.mass + 0.2)
    about_joint = link.about_width + link.mass * link.centre**2 + 0.2 * 0.12**2
    assert loaded.about_width + loaded.mass * loaded.centre**2 == pytest.approx(about_joint)
    assert loaded.mass * loaded.centre == pytest.approx(link.mass * link.centre + 0.2 * 0.12)
    assert loaded.along == link.along
