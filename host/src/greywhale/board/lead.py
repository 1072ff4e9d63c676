"""Leads a board along a motion.

Control points go out ahead of their time. A lost point is sent again. The pace falls when a follower does not keep up.
The board's own ticks time everything, as in `stream`: a simulated board may live faster than this machine. What is sent
again waits for this machine's clock as well, at the pace of the board's life so far: after a pause it finds hundreds of
ticks at once, and so many points would flood the board.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.board.device import Device
from greywhale.board.limits import LEAD
from greywhale.board.refusal import RefusedError
from greywhale.board.stream import why_stopped
from greywhale.files.trajectory import Trajectory
from greywhale.protocol import schema
from greywhale.protocol.firmware import (
    ANGLE_LSB,
    FASTEST_LED_RAD_S,
    JOINTS,
    LONGEST_STEP,
    POINT_S,
    POINT_TICKS,
    STEP_LSB,
)


def leadable(limits: Floats) -> Floats:
    """The least and the greatest angles (2, 4) to which points may lead within the joints' `limits`, rad."""
    rounding = np.where(limits[1] > limits[0], STEP_LSB, 0.0)  # points are rounded to steps
    return np.array([limits[0] + rounding, limits[1] - rounding])


class Reference(Protocol):
    """Angles in rad at any place up to the `end`, both counted in points; each place is asked for once, in order."""

    @property
    def end(self) -> float: ...
    def at(self, place: float) -> Floats: ...


@dataclass(frozen=True)
class Plan:
    """A motion in the form that the board gets: `angles` (rad, rows 16 ms apart), from one pose at rest to another."""

    angles: Floats

    @classmethod
    def of(cls, motion: Trajectory, start: Floats, limits: Floats, rest_s: float = 0.0) -> Plan:
        """From `start` (rad) at rest to the motion's first pose, then the motion, then `rest_s` at its last pose.

        All is within the joints' `limits` (2, 4), which the board also sets for a leader arm. Joints that are not in
        use have no room between theirs.
        """
        from greywhale.loop.leader_motions import minimum_jerk  # beside the simulated loop, which no board needs

        low, high = leadable(limits)
        first = np.clip(motion.angles[0], low, high)
        way = float(np.abs(first - start).max())
        # A minimum-jerk path is 1.875 times as fast in its middle as on average.
        approach = int(np.ceil(1.875 * way / LEAD.approach_rad_s / POINT_S)) if way > STEP_LSB else 0
        share = minimum_jerk(np.arange(1, approach + 1) / max(approach, 1))
        times = np.arange(0.0, motion.duration_s + POINT_S, POINT_S)
        parts = [
            start[None] + share[:, None] * (first - start)[None],
            motion.at(times),
            np.tile(motion.angles[-1], (2 + round(rest_s / POINT_S), 1)),
        ]
        plan = cls(np.clip(np.vstack(parts), low, high))
        speed = np.abs(np.diff(plan.angles, axis=0)).max(axis=0) / POINT_S
        joint = int(speed.argmax())
        if speed[joint] > FASTEST_LED_RAD_S:
            raise UserError(
                f"the motion moves joint {joint} at {speed[joint]:.3g} rad/s, but a board can be led at "
                f"{FASTEST_LED_RAD_S:.3g} rad/s at most; give it more time."
            )
        return plan

    @property
    def duration_s(self) -> float:
        return self.end * POINT_S

    @property
    def end(self) -> float:
        return float(len(self.angles) - 1)

    def at(self, place: float) -> Floats:
        """The angles at any place, counted in rows."""
        row = min(int(place), len(self.angles) - 2)
        share = min(place - row, 1.0)
        angles: Floats = (1.0 - share) * self.angles[row] + share * self.angles[row + 1]
        return angles


class Leading:
    """Feeds a reference to a board that this host leads; call `keep_ahead` with every sample."""

    def __init__(
        self,
        device: Device,
        begun: schema.LeadReply,
        plan: Reference,
        tracking_limit: float,
        ahead: int = LEAD.room_points,
    ) -> None:
        """`tracking_limit` in rad, 0 for none. The board is kept `ahead` points ahead: fewer let it hear sooner what
        has just been decided, and more wait longer for a host that is late.
        """
        self._device = device
        self._ahead = ahead
        self._plan = plan
        self._limit = tracking_limit or float("inf")
        self._first = begun.next
        self._origin = np.array(begun.reference) * ANGLE_LSB
        self._last_point = np.zeros(JOINTS, dtype=np.int64)  # steps from the origin, of all points made
        self._points: list[tuple[int, int, int, int]] = []
        self._sent = self._taken = 0  # points; self._points[self._taken:] are not known to have arrived
        self._waiting = self._heard = 0  # points that the board had to play, and the tick at which it said so
        self._since, self._since_s = 0, 0.0  # tick and time of the last progress
        self._answer: schema.LeadPointReply | None = None
        self._place, self._pace, self._wanted = 0.0, 1.0, 1.0
        self._last_tick = 0
        self._began: tuple[int, float] | None = None  # tick and time of the first sample
        self._made_all, self._resting = False, True
        self.slowest = 1.0
        self.starved = 0

    @property
    def fraction(self) -> float:
        return min(1.0, self._place / self._plan.end)

    @property
    def points(self) -> int:
        return len(self._points)

    @property
    def done(self) -> bool:
        return self._made_all and self._taken == len(self._points) and self._points_left(self._last_tick) <= -2

    def keep_ahead(self, tick: int, sample: schema.Sample) -> None:
        """Read the board's answers and send as many points as it has room for; `tick` counts the board's ticks from
        anywhere.

        The motion begins once the soft start is over. Before that the board is told to rest, so that its queue is full.
        """
        self._last_tick = tick
        self._began = self._began or (tick, self._device.clock())
        self._resting = sample.state is not schema.State.FOLLOWING
        self._hear(tick)
        self._watch(sample)
        if self._taken < self._sent and self._waited(tick, LEAD.patience_ticks):
            self._sent = self._taken
            self._note_progress(tick)
        room = min(LEAD.at_once_points, self._ahead - max(0, self._points_left(tick)) - (self._sent - self._taken))
        while room > 0 and self._make_points(self._sent + 1):
            if self._sent == self._taken:
                self._note_progress(tick)
            self._device.lead_point((self._first + self._sent) % 256, self._points[self._sent])
            self._sent += 1
            room -= 1

    def _points_left(self, tick: int) -> int:
        """The number of points that the board has yet to play, by its last answer and the time since."""
        return self._waiting - (tick - self._heard) // POINT_TICKS

    def _note_progress(self, tick: int) -> None:
        self._since, self._since_s = tick, self._device.clock()

    def _waited(self, tick: int, ticks: int) -> bool:
        """True if the last progress is so long ago, by the board and by this machine."""
        if tick - self._since <= ticks or self._began is None:
            return False
        began, began_s = self._began
        now_s = self._device.clock()
        ticks_per_ms = max(1.0, (tick - began) / max(1000 * (now_s - began_s), 1.0))  # above 1 for a simulated board
        return 1000 * (now_s - self._since_s) * ticks_per_ms > ticks

    def _hear(self, tick: int) -> None:
        try:
            answer = self._device.lead_progress()
        except RefusedError as refused:
            if refused.detail == schema.LeadRefusal.NOT_LEADING:
                raise why_stopped(self._device) from None
            raise
        if answer is None or answer is self._answer:
            return
        self._answer = answer
        taken = self._taken + (answer.next - self._first - self._taken) % 256
        if taken > self._sent:
            return  # an old answer to a point that was sent twice
        if answer.waiting <= 1 and self._taken and not self._made_all:
            self.starved += 1
        if taken > self._taken:
            self._note_progress(tick)
        elif self._sent > taken and self._waited(tick, LEAD.retry_ticks):
            self._sent = taken
            self._note_progress(tick)
        self._taken, self._waiting, self._heard = taken, answer.waiting, tick

    def _watch(self, sample: schema.Sample) -> None:
        """Let the pace fall when a follower is far from the reference."""
        far = max(abs(a - b) for a, b in zip(sample.leader, sample.follower, strict=True)) * ANGLE_LSB / self._limit
        self._wanted = min(1.0, max(0.0, (LEAD.stops_share - far) / (LEAD.stops_share - LEAD.slows_share)))

    def _make_points(self, count: int) -> bool:
        """Make points until there are `count`; False when the plan ends before."""
        end = self._plan.end
        while len(self._points) < count and not self._made_all:
            if self._resting:
                self._points.append((0, 0, 0, 0))
                continue
            self._pace += min(max(self._wanted - self._pace, -LEAD.pace_step), LEAD.pace_step)
            self.slowest = min(self.slowest, self._pace)
            self._place = min(self._place + self._pace, end)
            if len(self._points) > LEAD.longest_ratio * end + 1000:
                raise UserError(
                    f"{self._device.port}: the arm cannot follow this motion: it would take more than "
                    f"{LEAD.longest_ratio:g} times its length; check that every joint moves freely, or lower its range."
                )
            target = np.round((self._plan.at(self._place) - self._origin) / STEP_LSB).astype(np.int64)
            step = np.clip(target - self._last_point, -LONGEST_STEP, LONGEST_STEP)
            self._last_point += step
            self._points.append((int(step[0]), int(step[1]), int(step[2]), int(step[3])))
            self._made_all = self._place >= end and bool((target == self._last_point).all())
        return len(self._points) >= count
