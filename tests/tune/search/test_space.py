"""Every point of a box is a controller that the firmware accepts, and what is stored is what is tried."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.fuzzy.settings import LEAST_WIDTH, SET_UNIT, JointSettings
from greywhale.loop import CONTROLLER_COLUMNS, default_controller
from greywhale.protocol.schema import Refusal
from greywhale.tune.search.space import CE_TICKS, GAINS, STRATEGIES, Space, check_bounds

BEFORE = default_controller()


def box(strategy: str, kind: Literal["default", "paper"] = "default", period_ms: int = 1) -> Space:
    if kind == "paper":
        return Space.paper(strategy, BEFORE)
    return Space.default(strategy, BEFORE, 15_000, period_ms)


def anywhere(space: Space, count: int = 200, seed: int = 1) -> np.ndarray:
    """Points all over the box, some on its bounds."""
    random = np.random.default_rng(seed)
    share = np.clip(random.uniform(-0.2, 1.2, (count, 4, space.dimensions)), 0.0, 1.0)
    return np.asarray(space.lower + share * (space.upper - space.lower))


@pytest.mark.parametrize("strategy", STRATEGIES)
@pytest.mark.parametrize("kind", ["default", "paper"])
@pytest.mark.parametrize("period_ms", [1, 20, 50])
def test_the_firmware_takes_every_point(strategy: str, kind: Literal["default", "paper"], period_ms: int) -> None:
    space = box(strategy, kind, period_ms)
    for rows in space.controllers(anywhere(space)):
        for row in rows:
            settings = JointSettings(*(int(value) for value in row))
            assert settings.refusal(period_ms) is Refusal.NONE
            settings.controller(period_ms)


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_a_strategy_changes_its_own_numbers_only(strategy: str) -> None:
    space = box(strategy)
    changed = (space.controllers(anywhere(space)) != BEFORE).any(axis=(0, 1))
    names = {name for name, differs in zip(CONTROLLER_COLUMNS, changed, strict=True) if differs}
    sets, gains = set(CONTROLLER_COLUMNS[:8]), set(CONTROLLER_COLUMNS[8:])
    assert names == {"mf": sets, "sf": gains, "both": sets | gains}[strategy]


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_stored_numbers_come_back_as_themselves(strategy: str) -> None:
    space = box(strategy)
    stored = space.controllers(anywhere(space))
    np.testing.assert_array_equal(space.controllers(space.points(stored)), stored)


def test_the_supply_bounds_ku_to_its_double_and_the_firmware_to_30_volts() -> None:
    for supply_mv, highest in ((6_000, 12_000), (15_000, 30_000), (24_000, 30_000)):
        space = Space.default("both", BEFORE, supply_mv, 1)
        assert space.controllers(space.upper + np.zeros((1, 4, 13)))[0, :, 11].tolist() == [highest] * 4


def test_ki_goes_from_none_to_the_most_that_the_firmware_takes() -> None:
    for period_ms, most in ((1, 1000.0), (20, 204.8)):
        space = box("both", period_ms=period_ms)
        ends = space.controllers(np.stack([space.lower, space.upper])[:, None] + np.zeros((2, 4, 13)))
        assert (ends[0, :, 10] == 0).all()
        np.testing.assert_allclose(ends[1, :, 10] / 65536, most, rtol=1e-3)


def test_most_of_the_kis_that_are_tried_do_something() -> None:
    """Below some 30 V/(rad s) an integral does next to nothing; a logarithm from 0.01 would try little else."""
    tried = box("both").controllers(anywhere(box("both"), 2000))[..., 10] / 65536
    assert np.mean(tried > 30.0) > 0.7


def test_the_papers_box_is_table_7() -> None:
    space = box("mf", "paper")
    assert space.names == ("Ne_c", "Ze_a", "Ze_c", "Pe_b", "Nce_c", "Zce_a", "Zce_c", "Pce_b")
    assert space.lower.tolist() == [-1, -1, 0, 0, -1, -1, 0, 0]
    assert space.upper.tolist() == [0, 0, 1, 1, 0, 0, 1, 1]


def test_widths_that_no_board_takes_are_widened_and_counted() -> None:
    space = box("mf", "paper")
    points = np.full((1, 4, 8), 0.5) * np.where(space.upper > 0, 1.0, -1.0)
    assert space.count_narrow(points) == 0
    points[0, 2, :3] = [-0.0099, 0.0, 0.01]  # 0.01 is stored as the next width above: 163.84 becomes 164
    assert space.count_narrow(points) == 2
    assert space.controllers(points)[0, 2, :3].tolist() == [-LEAST_WIDTH, -LEAST_WIDTH, LEAST_WIDTH]


def test_the_reduced_box_is_the_same_to_both_sides_and_lets_kp_and_kd_be() -> None:
    space = box("both").reduce()
    assert space.names == ("Ze_c", "Pe_b", "Zce_c", "Pce_b", "Ki", "Ku", CE_TICKS)
    rows = space.controllers(anywhere(space))
    for left, right in (("ne_c", "pe_b"), ("ze_a", "ze_c"), ("nce_c", "pce_b"), ("zce_a", "zce_c")):
        assert (rows[..., CONTROLLER_COLUMNS.index(left)] == -rows[..., CONTROLLER_COLUMNS.index(right)]).all()
    assert (rows[..., 8] == 1 << 16).all()
    assert (rows[..., 9] == round(0.3 * (1 << 16))).all()
    assert box("sf").reduce().names == (*GAINS, CE_TICKS)
    assert box("mf").reduce().names == ("Ze_c", "Pe_b", "Zce_c", "Pce_b")


def test_restretching_keeps_the_law() -> None:
    """Sets half as wide with half the factor mean the same voltage for the same error."""
    space = box("both").reduce()
    stretched = space.restretch(BEFORE)
    assert (stretched[:, 8] == 1 << 16).all()
    assert (stretched[:, 9] == round(0.3 * (1 << 16))).all()
    for old, new in zip(BEFORE, stretched, strict=True):
        one, other = (JointSettings(*(int(value) for value in row)).controller(1) for row in (old, new))
        e, ce = (np.random.default_rng(3).integers(-limit, limit, 500).astype(np.int32) for limit in (3000, 60))
        np.testing.assert_allclose(one.u(e, ce), other.u(e, ce), atol=0.01 * 32768)


def test_bounds_hold() -> None:
    bounds = {"Ku": (3.0, 5.0), "Ze_c": (0.1, 0.2), "Ne_c": (-0.5, -0.4)}
    for space in (box("both").with_bounds(bounds), box("both").with_bounds(bounds).reduce()):
        rows = space.controllers(anywhere(space))
        assert rows[..., 11].min() >= 3_000
        assert rows[..., 11].max() <= 5_000
        assert np.abs(rows[..., 2] / SET_UNIT - 0.15).max() < 0.0501
        assert np.abs(rows[..., 0] / SET_UNIT + 0.45).max() < 0.0501
        moved = space.controllers(space.points(BEFORE[None]))[0]
        assert (moved[:, 11] == 5_000).all()


def test_opposite_sides_with_nothing_in_common_stay_two_variables() -> None:
    space = box("mf").with_bounds({"Ze_a": (-0.2, -0.1), "Ze_c": (0.3, 0.4)}).reduce()
    assert {"Ze_a", "Ze_c"} <= set(space.names)


@pytest.mark.parametrize(
    ("strategy", "bounds", "sentence"),
    [
        ("both", {"Kq": (0.0, 1.0)}, "'Kq'; there are Ne_c"),
        ("both", {"Ku": (9.0, 3.0)}, "9 and 3; give the lower one first"),
        ("both", {"Ku": (9.0, 9.0)}, "the bounds of Ku are 9 and 9"),
        ("both", {"Ku": (9.0, 31.0)}, r"within 0.001..30"),
        ("both", {"Ze_c": (0.005, 0.5)}, r"within 0.01..1"),
        ("both", {"Ze_a": (0.1, 0.5)}, r"within -1..-0.01"),
        ("both", {"Kp": (0.0, 1.0)}, "the bounds of Kp are 0 and 1,"),
        ("mf", {"Ku": (3.0, 9.0)}, "Ku is not searched by strategy mf"),
        ("sf", {"Ze_c": (0.1, 0.5)}, "Ze_c is not searched by strategy sf"),
    ],
)
def test_wrong_bounds_are_bad_usage(strategy: str, bounds: dict[str, tuple[float, float]], sentence: str) -> None:
    with pytest.raises(UserError, match=sentence) as caught:
        check_bounds(strategy, bounds)
    assert caught.value.exit_code == 2
    check_bounds("mf", {"Ze_c": (0.01, 0.5), "Ze_a": (-1.0, -0.01)})  # the narrowest, as people write it
