"""Multi-sines that keep their limits by construction.

Whatever its numbers, such a motion stays in its ranges and below its speeds and accelerations, and begins and ends at
rest where the arm is. A sum of sines of fixed frequencies is stretched over the joint's range. It is faded in from the
present pose and out to it, and shrunk towards that pose until speed and acceleration fit. Each of these steps keeps the
range, because each point lies between the pose and a point of the range. The board draws the motion as a B-spline of
these points, so its positions, speeds and accelerations are means of theirs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greywhale.base.types import Floats
from greywhale.files.trajectory import Trajectory
from greywhale.identify.excite.limits import Limits
from greywhale.identify.limits import IDENTIFICATION_LIMITS, ExcitationLimits
from greywhale.loop.leader_motions import minimum_jerk
from greywhale.protocol.firmware import JOINTS, POINT_S

SINES = 6  # of a joint
SHORTEST_S, LONGEST_S = 4.0, 600.0  # that may be asked for


@dataclass(frozen=True)
class Shape:
    """All multi-sines of a length: each is a vector of `size` numbers in [-1, 1]."""

    limits: Limits
    seconds: float
    wanted: ExcitationLimits = IDENTIFICATION_LIMITS.excitation

    @property
    def size(self) -> int:
        return 2 * SINES * JOINTS

    @property
    def frequencies(self) -> Floats:
        """(joints, sines) Hz, even over the octaves. No two joints share one, so that they can be told apart."""
        lowest, highest = self.wanted.frequencies_hz
        lowest = max(lowest, 1.0 / self.seconds)
        place = (np.arange(SINES)[None, :] + np.arange(JOINTS)[:, None] / JOINTS) / (SINES - 1 + 0.75)
        return lowest * (highest / lowest) ** place

    @property
    def time_s(self) -> Floats:
        return np.arange(round(self.seconds / POINT_S) + 1, dtype=np.float64) * POINT_S

    def angles(self, numbers: Floats) -> Floats:
        """(points, 4) rad, 16 ms apart."""
        numbers = np.clip(numbers, -1.0, 1.0).reshape(2, JOINTS, SINES)
        fade, time_s = self._fade(self.time_s), self._played_time
        weights = np.exp(self.wanted.amplitude_spread_log * numbers[0]) / self.frequencies
        phases = np.pi * numbers[1]
        angles = np.zeros((len(fade), JOINTS))
        limits = self.limits
        for joint in range(JOINTS):
            turns = 2.0 * np.pi * self.frequencies[joint][:, None] * time_s + phases[joint][:, None]
            wave = weights[joint] @ np.sin(turns)
            stretched = (wave - wave.min()) / np.ptp(wave)
            within = limits.low[joint] + (limits.high[joint] - limits.low[joint]) * stretched
            way = fade * (within - limits.pose[joint])
            angles[:, joint] = limits.pose[joint] + way * self._shrink_factor(way, joint)
        return angles

    @property
    def _played_time(self) -> Floats:
        """Time on the multi-sine's own clock, which stands still in the pauses, (points,) s."""
        time_s = self.time_s
        pace = np.ones(len(time_s))
        count = int(self.wanted.pauses_per_s * self.seconds)
        for middle in self.seconds * (np.arange(count) + 0.5) / max(count, 1):
            near = np.abs(time_s - middle) / (self.wanted.pause_s / 2.0)
            pace *= minimum_jerk(2.0 * near - 1.0)
        return np.cumsum(pace) * POINT_S

    def trajectory(self, angles: Floats) -> Trajectory:
        return Trajectory(self.time_s, angles)

    def _fade(self, time_s: Floats) -> Floats:
        fade_s, rest_s = min(self.wanted.fade_s, self.wanted.fade_share * self.seconds), self.wanted.rest_s
        return minimum_jerk((time_s - rest_s) / fade_s) * minimum_jerk((self.seconds - rest_s - time_s) / fade_s)

    def _shrink_factor(self, way: Floats, joint: int) -> float:
        """The factor, at most 1, that keeps speed and acceleration."""
        speed = float(np.abs(np.diff(way)).max()) / POINT_S
        acceleration = float(np.abs(np.diff(way, 2)).max()) / POINT_S**2
        most = max(speed / self.limits.speed[joint], acceleration / self.limits.acceleration[joint])
        return 1.0 / max(float(most), 1.0)


def board_reference(angles: Floats) -> Floats:
    """The reference (ticks, 4) rad that a board draws through points (rows, 4): a uniform quadratic B-spline."""
    points = np.vstack([angles[:1], angles, angles[-1:]])
    before, after = np.diff(points[:-1], axis=0), np.diff(points[1:], axis=0)
    middle = (points[:-2] + points[1:-1]) / 2.0
    share = (np.arange(1, 17) / 16.0)[None, :, None]
    pieces = middle[:, None] + before[:, None] * share + (after - before)[:, None] * share**2 / 2.0
    return pieces.reshape(-1, angles.shape[1])
