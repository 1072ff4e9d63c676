"""The figures of ISO 9283 on visits whose answers are known, and on an arm whose lost motion was put in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greywhale.arm.parameters import with_usual_noise
from greywhale.arm.plants import plant_row
from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.files.arm import load_arm
from greywhale.files.log import Log
from greywhale.loop import Experiment
from greywhale.loop.closed_loop import shown_angles
from greywhale.loop.leader_motions import human_reaches, poses
from greywhale.measure.limits import REPEATABILITY_LIMITS
from greywhale.measure.repeatability import hidden_play, repeatability
from greywhale.protocol.firmware import TICK_S
from tests.measure.test_measure import log_of

LOW, HIGH = np.array([-0.8, -0.2, -0.9, -1.0]), np.array([0.8, 1.0, 0.7, 1.0])
STEP_S = 0.01
ARM = load_arm("default")


def visits_log(deviations: Floats, joint: int = 0) -> Log:
    """A follower that is where it was led but for one joint, which is off by (from below, from above) in each round."""
    motion = poses(LOW, HIGH, len(deviations))
    time = np.arange(0.0, motion.duration_s, STEP_S)
    leader = motion.at(time)
    follower = leader.copy()
    rest = np.all(np.abs(np.diff(leader, axis=0, append=leader[-1:])) < 1e-9, axis=1)
    begins = np.flatnonzero(np.diff(rest.astype(int), prepend=0) == 1)
    longest = [begin for begin in begins if rest[begin : begin + round(0.8 / STEP_S)].all()]
    for number, begin in enumerate(longest):
        off = deviations[number // (len(longest) // len(deviations)), number % 2]
        follower[begin - 5 : begin + round(1.2 / STEP_S), joint] += off
    return log_of(time, leader, follower)


def test_the_figures_are_those_of_the_standard() -> None:
    """Deviations of 1, 2 and 3 mrad from below have S = 1 mrad, and distances from their mean of 1, 0 and 1 mrad."""
    found = repeatability(visits_log(1e-3 * np.array([[1.0, -5.0], [2.0, -5.0], [3.0, -5.0]])), ARM)
    assert len(found.poses) == 5
    assert found.unsettled == {}
    worst = found.worst()
    assert worst[0].visits == 3
    assert worst[0].repeatability == pytest.approx(3e-3, rel=1e-6)  # 3 S of an angle
    assert worst[0].accuracy == pytest.approx(5e-3, rel=1e-6)  # from above
    assert worst[0].variation == pytest.approx(7e-3, rel=1e-6)
    assert worst[1].variation == pytest.approx(0.0, abs=1e-12)
    middle = found.poses[0]
    assert middle.angles == pytest.approx(0.5 * (LOW + HIGH), abs=1e-4)
    links, q = [one.length for one in ARM.link], middle.angles
    out = links[1] * np.cos(q[1]) + (links[2] + links[3]) * np.cos(q[1] + q[2])
    assert middle.tip is not None
    below, above = middle.tip.approaches
    assert below.sides == (-1, -1, -1, -1)
    assert below.repeatability == pytest.approx(out * 1e-3 * (2.0 / 3.0 + 3.0 * np.sqrt(1.0 / 3.0)), rel=1e-3)
    assert above.repeatability == pytest.approx(0.0, abs=1e-9)
    assert middle.tip.variation == pytest.approx(out * 7e-3, rel=1e-3)


def test_a_load_shows_beside_the_log_without_it() -> None:
    plain = repeatability(visits_log(np.full((2, 2), 1e-3), joint=1))
    loaded = repeatability(visits_log(np.full((2, 2), -3e-3), joint=1))
    moved = loaded.moved_from(plain, REPEATABILITY_LIMITS)
    assert moved[1] == pytest.approx(4e-3, rel=1e-6)
    assert moved[0] == pytest.approx(0.0, abs=1e-12)


def test_play_between_joint_and_potentiometer_is_seen_at_the_joint_and_not_by_the_potentiometer() -> None:
    """The lost motion that was put in, 20 mrad, is what lies between both: an arm whose motors damp it well."""
    grey = with_usual_noise(load_arm("grey_box"))
    pots = tuple(
        pot.model_copy(update={"play": 0.01 * (joint == 0)}) for joint, pot in enumerate(grey.follower_pots.joint)
    )
    worn = grey.model_copy(update={"follower_pots": grey.follower_pots.model_copy(update={"joint": pots})})
    experiment = Experiment(poses(LOW, HIGH, 2), worn, resample=True)
    result = experiment.run(every=1)
    (shown,) = shown_angles(result.angles, plant_row(worn)[None], TICK_S)
    by_pot, by_joint = (
        repeatability(log_of(experiment.time_s, experiment.leader, follower.astype(np.float64)), worn)
        for follower in (shown, result.angles[0])
    )
    hidden = []
    for pot_pose, joint_pose in zip(by_pot.poses, by_joint.poses, strict=True):
        (below, above), (true_below, true_above) = (one.joints[0].approaches for one in (pot_pose, joint_pose))
        hidden.append((above.mean - below.mean) - (true_above.mean - true_below.mean))
    assert np.array(hidden) == pytest.approx(0.02, abs=2e-4)
    assert hidden_play(worn, [by_pot.poses[0].angles])[0] == {0: pytest.approx(0.02)}


def test_a_joint_that_hunts_is_left_out_alone() -> None:
    log = visits_log(np.zeros((2, 2)))
    hunting = log.follower + 0.03 * np.sin(40.0 * log.time)[:, None] * (np.arange(4) == 2)
    found = repeatability(replace(log, follower=hunting), ARM)
    assert found.unsettled == {2: 20}
    assert set(found.worst()) == {0, 1, 3}  # and no tip


def test_lost_samples_change_no_side_and_make_no_visits() -> None:
    log = visits_log(np.full((2, 2), 1e-3))
    kept = np.arange(len(log.time)) % 97 > 2
    parts = {name: getattr(log, name)[kept] for name in ("time", "leader", "follower", "voltage", "state")}
    assert repeatability(replace(log, **parts)).worst()[0].visits == 2


def test_a_log_without_such_visits_is_refused() -> None:
    motion = human_reaches(3, 8.0)
    with pytest.raises(UserError, match="no joint comes to rest in one pose 2 times .* record --poses 30"):
        repeatability(log_of(motion.time_s, motion.angles, motion.angles))


def test_poses_keep_to_the_room() -> None:
    motion = poses(LOW, HIGH, 2)
    assert np.all(motion.angles >= LOW)
    assert np.all(motion.angles <= HIGH)
    narrow = poses(LOW, LOW + 0.2, 2)  # the narrowest that `record` takes
    assert np.all(narrow.angles >= LOW - 1e-12)
    assert np.all(narrow.angles <= LOW + 0.2 + 1e-12)
    time = np.arange(0.0, narrow.duration_s, STEP_S)
    found = repeatability(log_of(time, narrow.at(time), narrow.at(time)))
    assert all(place.variation is not None for pose in found.poses for place in pose.joints.values())
    still = poses(np.array([-1.0, 0.0, -1.0, 0.0]), np.array([1.0, 0.0, 1.0, 0.0]), 2)  # two joints in use
    assert np.all(still.angles[:, [1, 3]] == 0.0)
