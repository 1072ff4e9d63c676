"""The person at the bench: moves the leader arm along a motion, and lifts the follower back when the motors are off.

The person waits for the drivers' enable pin (a board's LED shows the same), lets the soft start pass, plays the motion
once and holds the last pose, or leads live, wherever they are told. A while after the motors went off, the person
brings both arms back to the first pose and holds them there, so that the next enable is accepted. Until then nobody
touches the follower, so that a fall or coasting after a stop shows.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.files.trajectory import Trajectory
from greywhale.protocol.joints import ALL, Joints
from greywhale_sim.streamed_leader import StreamedLeader

Place = tuple[Floats | None, Floats | None, float]  # of leader and follower, None: where it is; seconds on the way

START_S = 1.5  # from enable to the first movement: the soft start takes 1 s
LET_GO_S = 0.5  # from motors off to the hand on the follower
BRING_BACK_S = 1.0  # from where the arms are to the first pose


class LeaderPlayer:
    """Leader angles for every slice; `hold` is the pose in which the hand holds the follower, None when it is free.

    Joints that are not in use stay at 0, whatever the motion and the hands want.
    """

    def __init__(self, motion: Trajectory, slice_s: float, start_s: float = START_S, joints: Joints = ALL) -> None:
        self._slice_s = slice_s
        self._in_use = np.array([float(joint in joints) for joint in ALL])
        self._start = round(start_s / slice_s)
        self._let_go = round(LET_GO_S / slice_s)
        self._bring_back = max(1, round(BRING_BACK_S / slice_s))
        self._learn(motion)
        self._on = 0  # slices since the motors went on
        self._off = self._let_go + self._bring_back  # slices since they went off, or since the hands set out
        self._left_at = (self._row(0), self._row(0))  # both arms when the hand takes them
        self.rest = (self.home, self.home)  # where the hands bring leader and follower
        self._further: list[Place] = []  # and then, one after the other
        self._way = self._bring_back  # slices until they are there
        self.angles: Floats = self.home
        self._taken_at: Floats = self.home  # the leader arm when the motors went on
        self.hold: Floats | None = self.home
        self.plays = 0
        self._streamed: StreamedLeader | None = None  # in the place of the motion

    def take_up(self, motion: Trajectory) -> None:
        """Play another motion from the next enable on; held arms are brought to its first pose within a second."""
        self._streamed = None
        self._learn(motion)
        self.rest, self._further = (self.home, self.home), []
        if self.hold is not None:
            self._set_out(self._bring_back)

    def lead(self, angles: Floats) -> None:
        """Lead to angles (4,) rad, now, whether the motors are on or off, and to others when this is called again.

        While they are off, the other hand brings the follower along. Ends with `take_up` and with `bring`.
        """
        self._streamed = self._streamed or StreamedLeader(self.angles)
        self._streamed.target = angles * self._in_use
        self._further = []

    def bring(self, leader: Floats | None, follower: Floats | None, seconds: float) -> None:
        """Bring a held arm, or both, to angles (4,) rad within so many seconds; both are held until the next enable."""
        self.bring_along([(leader, follower, seconds)])

    def bring_along(self, places: Sequence[Place]) -> None:
        """Bring held arms to one place after another."""
        if self.hold is None:
            raise UserError("the hands are on the arms only while the motors are off; stop them first.")
        self._streamed = None
        self._further = list(places)
        self._bring_next()

    def step(self, enabled: bool, follower: Floats) -> None:
        """Advance one slice; `follower` is where the follower is now."""
        if self._streamed is not None:
            self._streamed.step(self._slice_s)
            self.rest = (self._streamed.angles, self._streamed.angles)
        if enabled:
            self._follow_motion()
        elif self._off < self._let_go:
            self._off += 1
            self._on = 0
            self._left_at = (self.angles, follower.copy())
        elif self._off < self._let_go + self._way:
            self._off += 1
            share = (self._off - self._let_go) / self._way
            self.angles = self._left_at[0] + share * (self.rest[0] - self._left_at[0])
            self.hold = self._left_at[1] + share * (self.rest[1] - self._left_at[1])
        else:
            self.angles, self.hold = self.rest
            self._on = 0
            if self._further:
                self._bring_next()

    @property
    def finished(self) -> bool:
        """The motion was played to its end since the motors went on."""
        return self._on >= self._start + self._rows

    @property
    def on_the_way(self) -> bool:
        """True while the hands have places to go to."""
        return bool(self._further) or self._off < self._let_go + self._way

    def _bring_next(self) -> None:
        leader, follower, seconds = self._further.pop(0)
        self.rest = (
            self.rest[0] if leader is None else leader * self._in_use,
            self.rest[1] if follower is None else follower * self._in_use,
        )
        self._set_out(max(1, round(seconds / self._slice_s)))

    def _set_out(self, way: int) -> None:
        """Begin to bring both arms to their places, from where they are held."""
        assert self.hold is not None
        self._left_at = (self.angles, self.hold)
        self._off, self._way = self._let_go, way

    def _learn(self, motion: Trajectory) -> None:
        self._motion = motion
        self._rows = int(np.ceil(motion.duration_s / self._slice_s)) + 1
        self._chunk = np.empty((0, 4))
        self._chunk_first = 0
        self.home = self._row(0).copy()

    def _follow_motion(self) -> None:
        if self._on == 0:
            self._off = 0
            self.hold = None
            self.rest, self._further, self._way = (self.home, self.home), [], self._bring_back
            self._taken_at = self.angles
            if self._streamed is not None:
                self._streamed.take(self.angles)
        self._on += 1
        if self._streamed is not None:
            self.angles = self._streamed.angles
            return
        row = self._on - self._start
        if row < 0:  # the motors may have gone on while the arms were being brought back
            self.angles = self._taken_at + self._on / self._start * (self.home - self._taken_at)
        if row == self._rows:
            self.plays += 1
        if 0 <= row <= self._rows:
            self.angles = self._row(min(row, self._rows - 1))

    def _row(self, index: int) -> Floats:
        """The motion at slice `index`, from a chunk of one second, so that an hour of motion needs no more memory."""
        offset = index - self._chunk_first
        if not 0 <= offset < len(self._chunk):
            self._chunk_first = index
            times = np.arange(index, index + max(1, round(1.0 / self._slice_s)), dtype=np.float64) * self._slice_s
            self._chunk = self._motion.at(times) * self._in_use
            offset = 0
        row: Floats = self._chunk[offset]
        return row
