"""Random controllers and the places where they are hard: corners of the sets, narrow sets, extreme scaling factors."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import strategies as st
from numpy.typing import NDArray

from greywhale.fuzzy.settings import (
    GAIN_UNIT,
    LARGEST_KI_PERIOD,
    LEAST_WIDTH,
    MOST_CE_TICKS,
    SET_UNIT,
    JointSettings,
    load_joints,
)

TABLES = Path(__file__).parents[2] / "shared" / "fuzzy_tables"
LARGEST = 32767


Case = tuple[JointSettings, int]
Points = Callable[[JointSettings, int, int], tuple[NDArray[np.int64], NDArray[np.int64]]]


def _logarithmic(lowest: int, highest: int) -> st.SearchStrategy[int]:
    return st.floats(0.0, 1.0).map(lambda part: round(lowest * (highest / lowest) ** part))


@pytest.fixture(scope="session")
def cases() -> st.SearchStrategy[Case]:
    """Settings that compile() takes, and a control period."""
    width = st.one_of(
        _logarithmic(LEAST_WIDTH, SET_UNIT),
        st.sampled_from([LEAST_WIDTH, SET_UNIT]),
        st.integers(LEAST_WIDTH, SET_UNIT),
    )
    gain = st.one_of(st.just(0), _logarithmic(1, 64 * GAIN_UNIT), st.just(64 * GAIN_UNIT))

    @st.composite
    def case(draw: st.DrawFn) -> Case:
        period = draw(st.one_of(st.sampled_from([1, 20, 50]), st.integers(1, 50)))
        most_ki = min(1000 * GAIN_UNIT, (LARGEST_KI_PERIOD - 1) // period)
        ki = draw(st.one_of(st.just(0), _logarithmic(1, most_ki)))
        left = [-draw(width) for _ in range(4)]
        right = [draw(width) for _ in range(4)]
        settings = JointSettings(
            ne_c=left[0],
            ze_a=left[1],
            ze_c=right[0],
            pe_b=right[1],
            nce_c=left[2],
            zce_a=left[3],
            zce_c=right[2],
            pce_b=right[3],
            kp=draw(gain),
            kd=draw(gain),
            ki=ki,
            ku_mv=draw(st.integers(0, 30_000)),
            ce_ticks=draw(st.one_of(st.just(1), st.integers(1, MOST_CE_TICKS))),
        )
        return settings, period

    return case()


def _corners(settings: JointSettings, period_ms: int) -> tuple[list[float], list[float]]:
    """Sizes at which a set begins or ends, in 1/4096 rad."""
    e = [abs(width) * SET_UNIT / max(settings.kp, 1) for width in settings.as_tuple()[:4]]
    ce = [
        abs(width) * SET_UNIT * settings.ce_ticks * period_ms / max(20 * settings.kd, 1)
        for width in settings.as_tuple()[4:8]
    ]
    return e, ce


@pytest.fixture(scope="session")
def points() -> Points:
    """(settings, period, seed) -> errors and changes: around every corner, between them, and anywhere."""

    def pick(random: np.random.Generator, corners: list[float]) -> NDArray[np.int64]:
        corner = random.choice(corners, 400) * random.choice([1.0, -1.0], 400)
        near = np.clip(corner, -LARGEST, LARGEST).astype(np.int64) + random.integers(-2, 3, 400)
        between = np.clip(corner * random.random(400), -LARGEST, LARGEST).astype(np.int64)
        anywhere = random.integers(-LARGEST, LARGEST + 1, 400)
        kind = random.integers(0, 7, 400)
        value = np.where(kind < 3, near, np.where(kind < 6, between, anywhere))
        value[:5] = [0, 1, -1, LARGEST, -LARGEST]
        shuffled: NDArray[np.int64] = np.clip(random.permutation(value), -LARGEST, LARGEST)
        return shuffled

    def choose(settings: JointSettings, period_ms: int, seed: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        random = np.random.default_rng(seed)
        e, ce = _corners(settings, period_ms)
        return pick(random, e), pick(random, ce)

    return choose


@pytest.fixture(scope="session", params=["before_tuning", "table_8", "table_9", "table_10"])
def paper_joints(request: pytest.FixtureRequest) -> tuple[JointSettings, ...]:
    """The four joints of each of the paper's tables."""
    return load_joints(TABLES / f"{request.param}.toml")
