"""An arm simulated by another engine is identified too: a model that fits only its own simulator would prove little."""

from __future__ import annotations

import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))
from mujoco_recording import record

from greywhale.arm import ArmParameters
from greywhale.arm.plants import columns
from greywhale.files.arm import load_arm
from greywhale.identify import IdentificationResult, bootstrap, identify
from greywhale.loop import human_reaches, multi_steps
from tools.support.foreign_gears import Gears, inertia_of_joints
from tools.support.recordings import random_arm, table_of

SECONDS = 15.0
NAMES = ("before_tuning", "table_10")


@pytest.fixture(scope="module")
def arm() -> ArmParameters:
    """Motors and friction of a random arm; MuJoCo's joints have no gap and no Stribeck friction."""
    return random_arm(21)


@pytest.fixture(scope="module")
def outcome(arm: ArmParameters, tmp_path_factory: pytest.TempPathFactory) -> IdentificationResult:
    folder = tmp_path_factory.mktemp("mujoco")
    tables = [table_of(name) for name in NAMES]
    logs = [
        record(arm, human_reaches(seed, SECONDS), folder / f"{seed}.csv", table, 0.0024, seed)
        for seed, table in ((31, tables[0]), (32, tables[0]), (33, tables[1]))
    ]
    return identify(logs[:1], load_arm("white_box"), validate=logs[1:], tables=tables)


def test_it_is_predicted_far_better_than_by_the_white_box(outcome: IdentificationResult) -> None:
    """MuJoCo's soft friction lets joints creep that hold in greywhale's plant: that is what is left."""
    assert outcome.verdicts[1].improvement > 0.95
    assert outcome.verdicts[2].improvement > 0.95
    assert outcome.warnings == ()


def test_armature_damping_and_friction_loss_come_out(outcome: IdentificationResult, arm: ArmParameters) -> None:
    found = {one.name: one.value for one in outcome.estimates}
    for joint in range(4):
        true = arm.actuator(joint)
        volts = 1.0 / true.torque_per_volt
        assert found[f"joint{joint}.damping"] == pytest.approx(true.damping * volts, rel=0.02)
        assert found[f"joint{joint}.inertia"] == pytest.approx(true.inertia * volts, rel=0.03)
        assert found[f"joint{joint}.coulomb"] == pytest.approx(arm.joint[joint].friction.coulomb * volts, rel=0.05)
        # Roll moves next to nothing against gravity or other links: volts, not torques, are what it shows.
        assert found[f"joint{joint}.alpha"] == pytest.approx(volts, rel=0.03 if joint < 3 else 0.6)


PLAY_RAD = 0.008  # to either side


@pytest.fixture(scope="module")
def with_play(arm: ArmParameters, tmp_path_factory: pytest.TempPathFactory) -> IdentificationResult:
    folder = tmp_path_factory.mktemp("mujoco")
    table = table_of(NAMES[0])
    logs = [
        record(arm, human_reaches(seed, SECONDS), folder / f"{seed}.csv", table, 0.0024, seed, PLAY_RAD)
        for seed in (34, 35)
    ]
    return identify(logs[:1], load_arm("white_box"), validate=logs[1:], tables=[table])


def test_play_at_the_potentiometers_is_found_and_explained(with_play: IdentificationResult) -> None:
    assert "play at the potentiometers" in with_play.found.order
    assert with_play.verdicts[1].improvement > 0.95
    found = {one.name: one.value for one in with_play.estimates}
    gaps = [found.get(f"joint{joint}.gap", 0.0) for joint in range(4)]
    assert max(gaps) < 1e-4, "MuJoCo's gears are rigid, so no gap may be found, even where teeth that bend help"
    plays = [found[f"joint{joint}.play"] for joint in range(4)]
    assert np.median(plays) == pytest.approx(PLAY_RAD, rel=0.15)
    assert plays == pytest.approx([PLAY_RAD] * 4, rel=0.35)


SWINGS_HZ = np.array([60.0, 12.0, 10.0, 60.0])  # of each joint on its teeth, its motor held


def test_teeth_that_bend_are_found(arm: ArmParameters, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The pitch joints swing on their teeth; a fit from stiff ones would end at stiff ones."""
    monkeypatch.setattr(bootstrap, "LOGS", 0)  # no interval is looked at
    carried = inertia_of_joints(mujoco, arm, np.array([0.0, 0.4, 0.0, 0.0]))
    turning = 2.0 * np.pi * SWINGS_HZ
    gears = Gears(np.zeros(4), carried * turning**2, 2.0 * 0.05 * carried * turning)
    table = table_of(NAMES[0])
    logs = [
        record(arm, motion, tmp_path / f"{seed}.csv", table, 0.0024, seed, 0.0, gears)
        for seed, motion in ((36, multi_steps()), (37, human_reaches(37, 8.0)))
    ]
    outcome = identify(logs[:1], load_arm("white_box"), validate=logs[1:], tables=[table])
    assert "backlash" in outcome.found.order
    assert outcome.verdicts[1].improvement > 0.95
    found = outcome.plant[columns("stiffness")]
    assert found[[1, 2]] == pytest.approx(gears.stiffness[[1, 2]], rel=0.3)


def test_standard_deviations_are_honest_here_too(outcome: IdentificationResult, arm: ArmParameters) -> None:
    """Errors in standard deviations; the two engines' friction is not quite the same, which no formula can know."""
    errors = []
    for one in outcome.estimates:
        joint, _, kind = one.name.partition(".")
        if kind not in ("alpha", "inertia", "damping", "coulomb"):
            continue
        true = arm.actuator(int(joint[5:]))
        torque = {"alpha": 1.0, "inertia": true.inertia, "damping": true.damping}
        torque["coulomb"] = arm.joint[int(joint[5:])].friction.coulomb
        assert one.deviation is not None
        errors.append((one.value - torque[kind] / true.torque_per_volt) / one.deviation)
    assert np.sqrt(np.mean(np.square(errors))) < 3.0
