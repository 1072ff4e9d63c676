"""Looks for the slowest and the least exact inputs of the controller over all its parameters: random, then climbing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import numpy as np

from greywhale.fuzzy.settings import LARGEST_K, LARGEST_KI, LARGEST_KI_PERIOD, LEAST_WIDTH, SET_UNIT, JointSettings

LARGEST = 32767
NEGATIVE = ("ne_c", "ze_a", "nce_c", "zce_a")
WIDTHS = tuple(field.name for field in fields(JointSettings))[:8]


@dataclass(frozen=True)
class Point:
    """A controller, what it remembers and what it is given."""

    settings: JointSettings
    period_ms: int
    e: int
    ce: int
    integral: int
    limit_mv: int

    @property
    def previous(self) -> int:
        """The last error that makes this change of error."""
        return max(-LARGEST, min(LARGEST, self.e - self.ce))


class Random:
    """Draws points, most of them where the sets bend."""

    def __init__(self, seed: int) -> None:
        self.random = np.random.default_rng(seed)

    def _log(self, lowest: float, highest: float) -> int:
        part: float = self.random.random()
        return round(float(lowest * (highest / lowest) ** part))

    def _width(self) -> int:
        kind = self.random.random()
        return LEAST_WIDTH if kind < 0.15 else SET_UNIT if kind < 0.3 else self._log(LEAST_WIDTH, SET_UNIT)

    def settings(self, period_ms: int) -> JointSettings:
        widths = {name: self._width() * (-1 if name in NEGATIVE else 1) for name in WIDTHS}
        most_ki = min(LARGEST_KI, (LARGEST_KI_PERIOD - 1) // period_ms)
        gains = {"kp": self._log(1, LARGEST_K), "kd": self._log(1, LARGEST_K), "ki": self._log(1, most_ki)}
        return JointSettings(**widths, **gains, ku_mv=int(self.random.integers(0, 30_001)))

    def _size(self, corners: list[float]) -> int:
        value = float(self.random.choice(corners)) * self.random.choice([1.0, self.random.random()])
        if self.random.random() < 0.1:
            value = self._log(1, LARGEST)
        return int(self.random.choice([-1, 1])) * int(min(value + self.random.integers(-1, 2), LARGEST))

    def place(self, settings: JointSettings, period_ms: int) -> tuple[int, int]:
        e = [abs(width) * SET_UNIT / max(settings.kp, 1) for width in settings.as_tuple()[:4]]
        ce = [abs(width) * SET_UNIT * period_ms / max(20 * settings.kd, 1) for width in settings.as_tuple()[4:8]]
        return self._size(e), self._size(ce)

    def point(self) -> Point:
        period = int(self.random.choice([1, 20, int(self.random.integers(1, 51))]))
        settings = self.settings(period)
        e, ce = self.place(settings, period)
        end = 1 << 46
        return Point(
            settings, period, e, ce, int(self.random.integers(-end, end)), int(self.random.integers(0, 30_001))
        )

    def near(self, point: Point) -> Point:
        """A neighbour, with one or two things changed."""
        other = self.point()
        kind = self.random.integers(0, 5)
        if kind < 2:
            name = str(self.random.choice(WIDTHS if kind == 0 else ("kp", "kd", "ku_mv")))
            return replace(point, settings=replace(point.settings, **{name: getattr(other.settings, name)}))
        if kind < 4:
            name = "e" if kind == 2 else "ce"
            moved = getattr(point, name) + int(self.random.normal(0, 10.0 ** self.random.uniform(0, 3)))
            return replace(point, **{name: max(-LARGEST, min(LARGEST, moved))})
        if self.random.random() < 0.5:
            e, ce = self.place(point.settings, point.period_ms)
            return replace(point, e=e, ce=ce)
        return replace(point, integral=other.integral, limit_mv=other.limit_mv)


def climb(cost: Callable[[Point], float], random: Random, draws: int, climbs: int) -> list[float]:
    """The costs of the random draws, and at last the highest that was found."""
    points = [random.point() for _ in range(draws)]
    costs = [cost(point) for point in points]
    highest = -1.0
    for index in np.argsort(costs)[::-1][:8]:
        point, reached = points[int(index)], costs[int(index)]
        for _ in range(climbs):
            candidate = random.near(point)
            value = cost(candidate)
            if value >= reached:
                point, reached = candidate, value
        highest = max(highest, reached)
    return [*costs, highest]
