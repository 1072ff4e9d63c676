"""Lists of joints: as people write them, as sentences have them, and two that differ."""

from __future__ import annotations

import pytest

from greywhale.base.errors import UserError
from greywhale.protocol.joints import ALL, listed, named, parse, require_same, unused


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


def test_sentences() -> None:
    assert named((2,)) == "joint 2"
    assert named((0, 1)) == "joints 0 and 1"
    assert named((0, 1, 3)) == "joints 0, 1 and 3"
    assert named(ALL) == "all four joints"
    assert unused((0, 3)) == (1, 2)


def test_two_that_differ_are_told_with_a_remedy() -> None:
    require_same("arm.toml", (0, 1), "log.csv", (0, 1))
    with pytest.raises(UserError, match=r"arm.toml uses all four joints, but log.csv uses joints 0 and 1. .*`fixed = "):
        require_same("arm.toml", ALL, "log.csv", (0, 1))
