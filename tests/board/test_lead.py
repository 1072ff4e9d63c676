"""Leading: the board plays the motion, whatever the line loses; a follower that lags slows it down."""

from __future__ import annotations

from collections import deque
from typing import cast

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.board.device import Device
from greywhale.board.lead import Leading, Plan
from greywhale.board.limits import LEAD
from greywhale.files.trajectory import Trajectory
from greywhale.loop import human_reaches
from greywhale.protocol import schema
from greywhale.protocol.firmware import POINT_S, STEP_LSB

LIMITS = np.array([np.full(4, -2.5), np.full(4, 2.5)])
RAD = 1.0 / 4096.0
BEGUN = schema.LeadReply(schema.State.SOFT_START, 250, (100, -2000, 33, 0))
START = np.array(BEGUN.reference) * RAD


class Board:
    """A board's queue of points, tick by tick, at the far end of a line that is late and loses frames."""

    port = "board"

    def __init__(self, lose: float = 0.0, delay: int = 2, seed: int = 1, speed: float = 1.0) -> None:
        self.random, self.lose, self.delay, self.speed = np.random.default_rng(seed), lose, delay, speed
        self.next, self.queue = BEGUN.next, deque[tuple[int, ...]]()
        self.point = np.array(BEGUN.reference) / 4.0
        self.tick = 0
        self.played: list[np.ndarray] = []
        self.fullest = self.sent = 0
        self._to_board: deque[tuple[int, int, tuple[int, ...]]] = deque()
        self._to_host: deque[tuple[int, schema.LeadPointReply]] = deque()
        self._answer: schema.LeadPointReply | None = None

    def lead_point(self, number: int, step: tuple[int, ...]) -> None:
        assert all(-127 <= one <= 127 for one in step)
        self.sent += 1
        if self.random.random() >= self.lose:
            self._to_board.append((self.tick + self.delay, number, step))

    def lead_progress(self) -> schema.LeadPointReply | None:
        while self._to_host and self._to_host[0][0] <= self.tick:
            self._answer = self._to_host.popleft()[1]
        return self._answer

    def clock(self) -> float:
        return self.tick / 1000 / self.speed

    def live(self) -> None:
        """A tick: take what has arrived, play a point every 16 ticks."""
        self.tick += 1
        while self._to_board and self._to_board[0][0] <= self.tick:
            _, number, step = self._to_board.popleft()
            if number == self.next and len(self.queue) < LEAD.room_points:
                self.queue.append(step)
                self.next = (self.next + 1) % 256
            self.fullest = max(self.fullest, len(self.queue))
            if self.random.random() >= self.lose:
                reply = schema.LeadPointReply(self.next, len(self.queue))
                self._to_host.append((self.tick + self.delay, reply))
        if self.tick % 16 == 0:
            if self.queue:
                self.point = self.point + np.array(self.queue.popleft())
            self.played.append(self.point * STEP_LSB)


def sample(tick: int, far: float = 0.0, state: schema.State = schema.State.FOLLOWING) -> schema.Sample:
    behind = (0, round(-far / RAD), 0, 0)
    return schema.Sample(tick, state, schema.Fault.NONE, (0, 0, 0, 0), behind, (0, 0, 0, 0))


def play(board: Board, plan: Plan, every: int = 1, ticks: int = 40_000) -> Leading:
    leading = Leading(cast(Device, board), BEGUN, plan, tracking_limit=0.9)
    for tick in range(ticks):
        board.live()
        if tick % every == 0:
            leading.keep_ahead(board.tick, sample(board.tick))
        if leading.done:
            return leading
    raise AssertionError("the motion never ended")


def moved(points: list[np.ndarray]) -> np.ndarray:
    """The points from the one before the first move to the one of the last."""
    rows = np.array(points)
    changes = np.flatnonzero(np.abs(np.diff(rows, axis=0)).max(axis=1) > 0)
    return rows[changes[0] : changes[-1] + 2]


def wanted(plan: Plan) -> np.ndarray:
    steps = np.round((plan.angles - START) / STEP_LSB)
    return moved(list(START + steps * STEP_LSB))


PLAN = Plan.of(human_reaches(2, 6.0), START, LIMITS, 0.1)


@pytest.mark.parametrize(
    ("lose", "delay", "every"), [(0.0, 2, 1), (0.0, 45, 1), (0.0, 30, 4), (0.1, 2, 1), (0.3, 20, 2)]
)
def test_every_point_is_played_once_and_in_its_turn(lose: float, delay: int, every: int) -> None:
    board = Board(lose, delay)
    leading = play(board, PLAN, every)
    path, goal = moved(board.played), wanted(PLAN)
    # Where a line that loses much lets the board wait, a point is played longer, but none is left out.
    kept = path[np.concatenate([[True], np.abs(np.diff(path, axis=0)).max(axis=1) > 0])]
    aim = goal[np.concatenate([[True], np.abs(np.diff(goal, axis=0)).max(axis=1) > 0])]
    assert np.allclose(kept, aim, atol=1e-12)
    if lose == 0.0:
        assert np.allclose(path, goal, atol=1e-12)
        assert leading.starved == 0
        assert board.sent == leading.points
    assert board.fullest <= LEAD.room_points
    assert leading.slowest == 1.0


def test_the_motion_begins_when_the_soft_start_is_over() -> None:
    board = Board()
    leading = Leading(cast(Device, board), BEGUN, PLAN, tracking_limit=0.9)
    for _ in range(1000):
        board.live()
        leading.keep_ahead(board.tick, sample(board.tick, state=schema.State.SOFT_START))
    assert np.allclose(board.played, board.played[0])
    assert len(board.queue) >= 10, "its queue is full by then"
    for _ in range(1000):
        board.live()
        leading.keep_ahead(board.tick, sample(board.tick))
    assert not np.allclose(board.played[-1], board.played[0])


def test_a_simulated_board_that_lives_fast_gets_a_lost_point_again_in_time() -> None:
    """By this machine's clock alone, forty times as many of its ticks would pass, and the motion would stand still."""
    real, fast = Board(lose=0.02), Board(lose=0.02, speed=40.0)
    assert play(real, PLAN).starved == play(fast, PLAN).starved == 0
    assert fast.sent > len(moved(fast.played)), "points were lost"
    assert np.allclose(moved(fast.played), moved(real.played), atol=1e-12)


def test_a_host_that_stood_still_sends_no_more_than_the_board_can_receive() -> None:
    board = Board()
    leading = Leading(cast(Device, board), BEGUN, PLAN, tracking_limit=0.9)
    for _ in range(6):
        waiting = []
        for _ in range(350):
            board.live()
            waiting.append(board.tick)
        sent = board.sent
        for tick in waiting:
            leading.keep_ahead(tick, sample(tick))
        assert board.sent - sent <= LEAD.room_points


def test_a_follower_that_lags_slows_the_motion_and_stops_it_before_the_fault() -> None:
    board = Board()
    leading = Leading(cast(Device, board), BEGUN, PLAN, tracking_limit=0.9)
    for tick in range(4000):
        board.live()
        far = 0.0 if tick < 1500 or tick > 3000 else 0.75  # of 0.9 rad at which the board counts a joint as lost
        leading.keep_ahead(board.tick, sample(board.tick, far))
        if tick == 2000:
            held = board.played[-1].copy()
        if tick == 2900:
            assert np.array_equal(board.played[-1], held), "it waits"
            assert leading.slowest == 0.0
    assert not np.array_equal(board.played[-1], held), "and goes on"
    steps = np.diff(np.array(board.played), axis=0)
    bends = np.abs(np.diff(steps, axis=0)).max() / POINT_S**2
    assert bends < 60.0, "without a jerk"


def test_an_arm_that_never_follows_ends_in_a_sentence() -> None:
    board = Board()
    leading = Leading(cast(Device, board), BEGUN, PLAN, tracking_limit=0.9)
    with pytest.raises(UserError, match="cannot follow this motion"):
        for _ in range(60_000):
            board.live()
            leading.keep_ahead(board.tick, sample(board.tick, 0.85))


def test_a_plan_goes_slowly_to_its_first_pose_and_keeps_the_limits() -> None:
    motion = Trajectory(np.array([0.0, 1.0, 2.0]), np.array([[1.0, 0, 0, 0], [1.2, 0, 0, 0], [1.0, 0, 0, 0]]))
    narrow = LIMITS.copy()
    narrow[1, 0] = 1.1
    plan = Plan.of(motion, np.zeros(4), narrow, 0.5)
    speed = np.abs(np.diff(plan.angles[:, 0])) / POINT_S
    first = int(np.argmax(plan.angles[:, 0] >= 1.0 - 1e-9))
    assert speed[:first].max() <= 0.51
    assert plan.angles[:, 0].max() == pytest.approx(1.1 - STEP_LSB)
    assert plan.duration_s == pytest.approx(first * POINT_S + 2.0 + 0.5, abs=0.1)
    assert np.allclose(plan.angles[-30:], motion.angles[-1])
