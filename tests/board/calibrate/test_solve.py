"""Zero, scale and limits from sweeps and poses: any mounting is found again and matched, contradictions are refused."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from greywhale.base.errors import UserError
from greywhale.board.calibrate.match import with_board_pots
from greywhale.board.calibrate.solve import Pose, match, slipped, solve
from greywhale.board.calibrate.sweep import Sweep
from greywhale.board.pots import FULL_SCALE
from greywhale.files.arm import default_arm
from greywhale.protocol import schema
from greywhale.protocol.firmware import ANGLE_LSB
from greywhale.protocol.table import ParameterTable
from greywhale.tune.board_checks import refuse_uncalibrated
from tests.support.arms import with_joints
from tools.support.calibrating_person import mounted_anyhow

ENDS = np.array([-1.0, 1.2])
FIRST = np.zeros(4)
SECOND = np.array([0.8, 0.9, -0.7, 0.5])
FITS = {
    "track": st.lists(st.floats(4.4, 6.0), min_size=8, max_size=8),
    "sign": st.lists(st.sampled_from((-1, 1)), min_size=8, max_size=8),
    "middle": st.lists(st.floats(-0.5, 0.5), min_size=8, max_size=8),
}


def mounted(track: list[float], sign: list[int], middle: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """True scale (8,) rad a count and true zero (8,) counts."""
    scale = np.array(sign) * np.array(track) / FULL_SCALE
    return scale, FULL_SCALE / 2 - np.array(middle) / scale


def pose(angles: np.ndarray, scale: np.ndarray, zero: np.ndarray) -> Pose:
    return Pose(angles, zero + np.tile(angles, 2) / scale)


def sweeps(scale: np.ndarray, zero: np.ndarray) -> list[Sweep]:
    ends = [np.sort(zero[pot] + ENDS / scale[pot]) for pot in range(8)]
    return [Sweep(pot, int(np.sign(scale[pot])), float(ends[pot][0]), float(ends[pot][1]), ()) for pot in range(8)]


@given(**FITS)
def test_any_mounting_is_found_from_two_known_poses(track: list[float], sign: list[int], middle: list[float]) -> None:
    scale, zero = mounted(track, sign, middle)
    found = solve(sweeps(scale, zero), pose(FIRST, scale, zero), pose(SECOND, scale, zero), None)
    assert found.scale == pytest.approx(scale)
    assert found.zero == pytest.approx(zero)
    assert found.limits == pytest.approx(np.tile(ENDS + np.array([0.03, -0.03]), (4, 1)))
    stored = found.changes()
    for pot, name in enumerate(f"{side}{n}" for side in ("leader", "follower") for n in range(4)):
        angle = (16 * zero[pot] + 16 * 0.7 / scale[pot] - stored[f"{name}.zero"]) * stored[f"{name}.scale"] / 2**25
        assert angle == pytest.approx(0.7, abs=1e-3), "as the firmware works it out"


@given(**FITS)
def test_unknown_tracks_agree_between_the_arms_after_one_more_pose(
    track: list[float], sign: list[int], middle: list[float]
) -> None:
    """The leader's track is taken as 300 degrees; the follower then shows what the leader shows, in any pose."""
    scale, zero = mounted(track, sign, middle)
    first, same = pose(FIRST, scale, zero), pose(SECOND, scale, zero)
    about = solve(sweeps(scale, zero), first, None, np.radians(300.0))
    found = match(about, sweeps(scale, zero), first, same)
    shown = (pose(np.array([-0.5, 0.3, 1.0, 0.4]), scale, zero).counts - found.zero) * found.scale
    assert shown[4:] == pytest.approx(shown[:4])


SCALE, ZERO = mounted([5.2] * 8, [1] * 8, [0.0] * 8)
GOOD, NEAR = pose(SECOND, SCALE, ZERO), pose(np.array([0.8, 0.1, 0.8, 0.8]), SCALE, ZERO)
SLIPPED = Pose(SECOND, np.where(np.arange(8) == 6, ZERO - 20.0, GOOD.counts))
OTHER_END = [one if one.pot != 3 else Sweep(3, -1, one.low, one.high, ()) for one in sweeps(SCALE, ZERO)]
ELSEWHERE = sweeps(SCALE, ZERO + (np.arange(8) == 4) * 2.5 / SCALE)


@pytest.mark.parametrize(
    ("swept", "second", "words"),
    [
        (sweeps(SCALE, ZERO), NEAR, r"0\.1 rad at joint 1"),
        (sweeps(SCALE, ZERO), SLIPPED, "^follower potentiometer 2 "),
        (OTHER_END, GOOD, "^leader potentiometer 3 .* positive end first"),
        (ELSEWHERE, None, "^joint 0 has no range"),
    ],
    ids=["poses alike", "slipped", "the wrong end", "no common range"],
)
def test_a_contradiction_is_refused_by_name(swept: list[Sweep], second: Pose | None, words: str) -> None:
    with pytest.raises(UserError, match=words):
        solve(swept, pose(FIRST, SCALE, ZERO), second, None if second else 5.2)


def test_the_same_pose_twice_shows_what_slipped() -> None:
    first = pose(FIRST, SCALE, ZERO)
    again = first.counts.copy()
    again[1] += 9.0
    assert "first pose: leader potentiometer 1 (by 9 counts); " in slipped(first, Pose(FIRST, again))
    assert slipped(first, Pose(FIRST, first.counts + 7.0)) == ""
    everywhere = slipped(first, Pose(FIRST, first.counts + 1000.0))
    assert "leader potentiometer 0 (by 1000 counts), 1 (1000), " in everywhere
    assert ", follower potentiometer 0 (1000), 1 (1000), 2 (1000), 3 (1000); " in everywhere


def test_limits_keep_within_what_the_firmware_takes() -> None:
    wide = [Sweep(pot, 1, 10.0, 1010.0, ()) for pot in range(8)]
    found = solve(wide, Pose(FIRST, np.full(8, 20.0)), None, np.radians(450.0))
    parameter = schema.PARAMETER_BY_NAME["joint0.limit_max"]
    assert found.changes()["joint0.limit_max"] <= parameter.maximum


def calibrated(seed: int) -> ParameterTable:
    """A table that reads these random potentiometers rightly."""
    arm = mounted_anyhow(seed)
    changes = {}
    for side, bank in (("leader", arm.leader_pots), ("follower", arm.follower_pots)):
        for joint, pot in enumerate(bank.joint):
            scale = pot.direction * pot.track / 16368
            changes[f"{side}{joint}.scale"] = round(scale * 2**25)
            changes[f"{side}{joint}.zero"] = round(8184 - pot.centre / scale)
    return ParameterTable.defaults().with_raw(changes)


@pytest.mark.parametrize("seed", [1, 2])
def test_the_boards_potentiometers_are_found_in_its_table(seed: int) -> None:
    true, table = mounted_anyhow(seed), calibrated(seed)
    with pytest.raises(UserError, match="correct the one that is wrong"):
        refuse_uncalibrated(default_arm(), table)
    found = with_board_pots(default_arm(), table)
    refuse_uncalibrated(found, table)
    for side in ("leader_pots", "follower_pots"):
        for one, other in zip(getattr(found, side).joint, getattr(true, side).joint, strict=True):
            assert one.track == pytest.approx(other.track, rel=1e-4)
            assert one.centre == pytest.approx(other.centre, abs=2 * ANGLE_LSB)
            assert one.direction == other.direction
            assert one.noise == other.noise
    assert found.joint == default_arm().joint


def test_an_arm_and_a_board_with_other_joints_do_not_match() -> None:
    table = calibrated(1).with_raw({"follower2.scale": 0, "leader2.scale": 0, "leader0.scale": 0})
    with pytest.raises(UserError, match="the arm file uses all four joints, but the board uses joints 0, 1 and 3"):
        with_board_pots(default_arm(), table)
    arm = with_joints((0, 1, 3))
    found = with_board_pots(arm, table)
    assert found.leader_pots.joint[0] == arm.leader_pots.joint[0], "a host leads that joint"
    assert found.follower_pots.joint[0] != arm.follower_pots.joint[0]
