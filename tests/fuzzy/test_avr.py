"""The AVR firmware image on the simulated boards gives the bits of the native build: 75,000 random vectors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from greywhale.fuzzy import twin
from greywhale.fuzzy.settings import SET_UNIT, JointSettings
from greywhale.protocol.schema import Refusal
from tests.fuzzy.conftest import Case, Points
from tools.support.fuzzy_on_board import FuzzyOnBoard

LARGEST = 32767


def _error(leader: np.int64, follower: np.int64) -> int:
    return int(np.clip(leader - follower, -LARGEST, LARGEST))


@pytest.fixture(scope="module", params=["atmega2560", "atmega328p"])
def board(request: pytest.FixtureRequest) -> FuzzyOnBoard:
    return FuzzyOnBoard(request.param)


# 150 controllers x 200 points on each of two boards, and 75 x 100 periods.
@pytest.mark.slow
@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_inference(cases: st.SearchStrategy[Case], points: Points, board: FuzzyOnBoard, data: st.DataObject) -> None:
    joint, period = data.draw(cases)
    e, ce = (values[:200] for values in points(joint, period, data.draw(st.integers(0, 2**32 - 1))))
    before = np.clip(e - ce, -LARGEST, LARGEST)
    ce = np.clip(e - before, -LARGEST, LARGEST)
    native = joint.controller(period).u(e.astype(np.int32), ce.astype(np.int32))
    refusal, _ = board.compile(joint, period)
    assert refusal is Refusal.NONE
    for k in range(len(e)):
        board.set_state(0, int(before[k]))
        got = board.step(int(e[k]), 32767)
        assert got.u_fuzzy == np.clip(native[k], -LARGEST, LARGEST)
        assert not got.no_rule


@pytest.mark.slow
@settings(max_examples=75, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_whole_periods(
    cases: st.SearchStrategy[Case], points: Points, board: FuzzyOnBoard, data: st.DataObject
) -> None:
    """Trajectories: jumps, saturation, the integral at its ends, the first period."""
    joint, period = data.draw(cases)
    random = np.random.default_rng(data.draw(st.integers(0, 2**32 - 1)))
    leader, follower = points(joint, period, data.draw(st.integers(0, 2**32 - 1)))
    leader, follower = (np.clip(values[:100], -32768, 32767) for values in (leader, follower))
    limit = np.where(random.random(100) < 0.5, random.integers(0, 3000, 100), random.integers(0, 32768, 100))
    native, board_state = joint.controller(period), data.draw(st.sampled_from(["start", "end"]))
    board.compile(joint, period)
    board.set_state(0, None)
    expected = native.run(leader.astype(np.int16), follower.astype(np.int16), limit.astype(np.uint16))
    for k in range(100):
        got = board.step(_error(leader[k], follower[k]), int(limit[k]))
        assert got.u_fuzzy == expected["u_fuzzy"][k]
        assert got.volts_mv == expected["volts_mv"][k]
        assert got.saturated == expected["saturated"][k]
        assert got.integral == (int(expected["integral"][k]) << 16) + int(expected["fraction"][k])
    if board_state == "end":
        _at_the_ends_of_the_integral(joint, period, board, leader, follower)


def _at_the_ends_of_the_integral(
    joint: JointSettings, period: int, board: FuzzyOnBoard, leader: NDArray[np.int64], follower: NDArray[np.int64]
) -> None:
    ours = twin.Controller(joint, period)
    for integral in (twin.INTEGRAL_END - 1, -twin.INTEGRAL_END, twin.INTEGRAL_END - 70_000, 70_000 - twin.INTEGRAL_END):
        for k in range(8):
            ours.integral, ours.errors = integral, np.full(joint.ce_ticks, follower[k])
            board.set_state(integral, int(follower[k]))
            run = ours.run([leader[k]], [follower[k + 1]], [32767])
            got = board.step(_error(leader[k], follower[k + 1]), 32767)
            assert got.volts_mv == run.volts_mv[0]
            assert got.integral == run.integral[0]


FINE = JointSettings(-4915, -4915, 4915, 4915, -1638, -1638, 1638, 1638, 33620, 10486, 20513, 15000)


def _gain(width: int, end: float) -> int:
    """The gain with which a ramp of this width is full at this size."""
    return round(width * SET_UNIT / end)


@pytest.mark.parametrize("end", [13, 127.9, 128.1, 255.9, 256.1, 400], ids=str)
@pytest.mark.parametrize("outer", [1.0, 3.0], ids=["alike", "outer is long"])
def test_short_and_medium_ramps_at_every_size(board: FuzzyOnBoard, end: float, outer: float) -> None:
    width = 3000
    far = round(width * outer)
    sets = {"ze_a": -width, "ze_c": width, "ne_c": -far, "pe_b": far}
    changes = {"zce_a": -width, "zce_c": width, "nce_c": -far, "pce_b": far}
    gain = _gain(width, end)
    joint = replace(FINE, **sets, **changes, kp=gain, kd=gain)
    side = twin.compile_settings(joint, 20).e[0]
    assert side.zero_shift == (8 if end < 128 else 1 if end < 256 else 0)
    assert board.compile(joint, 20)[0] is Refusal.NONE
    random = np.random.default_rng(0)
    e = np.arange(-300, 301)
    for ce in (e, -e, random.integers(-300, 301, len(e))):
        expected = twin.infer(twin.compile_settings(joint, 20), e, ce).u
        for error, change, u in zip(e.tolist(), ce.tolist(), expected.tolist(), strict=True):
            board.set_state(0, error - change)
            assert board.step(error, 32767).u_fuzzy == np.clip(u, -LARGEST, LARGEST), (error, change)


def test_refusals(board: FuzzyOnBoard) -> None:
    assert board.compile(FINE, 20)[0] is Refusal.NONE
    assert board.compile(FINE, 51)[0] is Refusal.PERIOD
    board.set_state(0, 900)
    before = board.step(1000, 32767)
    for spoiled in ({"ne_c": 200}, {"ze_c": 16385}, {"pce_b": 163}, {"kd": (64 << 16) + 1}):
        settings_ = JointSettings(**{**FINE.__dict__, **spoiled})
        assert board.compile(settings_, 20)[0] is settings_.refusal(20)
    board.set_state(0, 900)
    assert board.step(1000, 32767) == before
