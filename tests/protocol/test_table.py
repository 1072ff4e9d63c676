"""The parameter table by name: what it refuses, how it changes, what it tells of its board; and lists of joints."""

from __future__ import annotations

import pytest

from greywhale.base.errors import UserError
from greywhale.protocol.joints import ALL, listed, parse, require_same
from greywhale.protocol.schema import Board
from greywhale.protocol.table import ParameterTable, find_board, refuse_unknown

DEFAULTS = ParameterTable.defaults()


def test_a_change_leaves_the_rest_the_board_and_the_name() -> None:
    nano = DEFAULTS.for_board(Board.NANO328).with_name("mine")
    changed = nano.with_raw({"joint2.kp": 77, "supply_mv": 9000})
    assert changed.changes() == {"supply_mv": 9000, "joint2.kp": 77}
    assert (changed.board, changed.name) == (Board.NANO328, "mine")
    assert nano.changes() == {}
    assert changed.with_raw(DEFAULTS.by_name()) == nano


def test_a_follower_without_a_potentiometer_is_a_joint_that_is_not_in_use() -> None:
    assert DEFAULTS.joints_in_use == (0, 1, 2, 3)
    assert DEFAULTS.with_raw({"follower1.scale": 0, "follower2.scale": -5}).joints_in_use == (0, 2, 3)
    assert DEFAULTS.with_raw({"leader1.scale": 0}).joints_in_use == (0, 1, 2, 3)  # a host leads it


def test_equal_values_on_another_board_are_another_table() -> None:
    assert DEFAULTS.with_name("elsewhere") == DEFAULTS
    assert DEFAULTS.for_board(Board.NANO328) != DEFAULTS


@pytest.mark.parametrize(
    ("key", "board"), [("nano328", Board.NANO328), ("esp32", Board.UNKNOWN), (None, Board.UNKNOWN)]
)
def test_boards_go_by_the_key_of_a_log(key: str | None, board: Board) -> None:
    assert find_board(key) is board


def test_an_unknown_name_is_told_with_its_place() -> None:
    refuse_unknown(("joint0.kp",), "model.toml", "identify again")
    with pytest.raises(UserError, match=r"model.toml: joint0.kq is no parameter of a board; identify again\."):
        refuse_unknown(("joint0.kp", "joint0.kq"), "model.toml", "identify again")


def test_a_table_for_fewer_joints_leaves_the_others_no_range() -> None:
    table = DEFAULTS.with_joints((1,))
    assert table.joints_in_use == (1,)
    assert table.each("leader", "scale")[2] == 0
    lower, upper = table.limits_raw()
    assert (lower[1], upper[1]) == (DEFAULTS["joint1.limit_min"], DEFAULTS["joint1.limit_max"])
    assert (lower[0], upper[0], lower[3], upper[3]) == (0, 0, 0, 0)
    assert table.each("joint", "limit_min") == DEFAULTS.each("joint", "limit_min"), "the stored ones stay"


@pytest.mark.parametrize(
    ("text", "joints"), [("0,1", (0, 1)), (" 3 , 1", (1, 3)), ("2", (2,)), ("0,1,2,3", ALL), ("3,2,1,0", ALL)]
)
def test_a_list_is_read_in_any_order(text: str, joints: tuple[int, ...]) -> None:
    assert parse(text) == joints
    assert parse(listed(joints)) == joints


@pytest.mark.parametrize("text", ["", "4", "-1", "0,0", "0,", "0 1", "all", "0.0", "٣"])
def test_what_is_no_list_is_refused(text: str) -> None:
    with pytest.raises(UserError, match=r"--joints: .* is no list of joints; give one or more of 0 to 3"):
        parse(text)


def test_two_that_differ_are_told_with_a_remedy() -> None:
    require_same("arm.toml", (0, 1), "log.csv", (0, 1))
    with pytest.raises(UserError, match=r"arm.toml uses all four joints, but log.csv uses joints 0 and 1. .*`fixed = "):
        require_same("arm.toml", ALL, "log.csv", (0, 1))
