"""BAM's recordings are read as they are, and its first model is our plant: two simulations of one motor agree."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from studies.real_data.bam_models import STEP_S, errors
from studies.real_data.bam_rig import GAIN_OF_KP, closed_loop, read_folder
from studies.real_data.rigs import SERVO_RIG

M1 = {"kt": 0.4, "R": 4.0, "armature": 2e-3, "q_offset": 0.0, "friction_base": 0.02, "friction_viscous": 0.005}


SWING = np.sin(1.5 * STEP_S * np.arange(1000))
STEPS = np.repeat([0.5, -0.5, 0.3, 0.0], 250)  # rad


def write(folder: Path, positions: list[float], goals: Floats = SWING, **changed: object) -> None:
    """A recording under a gain of 400; the motor is let go for the last fifth."""
    rows = len(positions)
    goals = goals[:rows]
    duty = np.clip(400 * GAIN_OF_KP * (goals - positions), -1.0, 1.0)
    entries = [
        {"position": q, "load": round(885 * u) % 65536, "input_volts": 7.0, "goal_position": goal}
        | {"timestamp": STEP_S * row, "torque_enable": row < 0.8 * rows}
        for row, (q, u, goal) in enumerate(zip(positions, duty.tolist(), goals.tolist(), strict=True))
    ]
    head = {"mass": 0.49, "length": 0.1, "kp": 400, "vin": 7.4, "motor": "xl330", "trajectory": "sin_sin"} | changed
    (folder / f"{len(list(folder.iterdir()))}.json").write_text(json.dumps(head | {"entries": entries}))


def test_a_folder_holds_recordings_and_models(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="holds no raw recording of an XL330 by BAM"):
        read_folder(tmp_path)
    write(tmp_path, [0.001 * row for row in range(1000)])
    write(tmp_path, [0.0] * 10, dt=0.005)
    write(tmp_path, [0.0] * 10, motor="sts3250")
    (tmp_path / "m1.json").write_text(json.dumps(M1 | {"model": "m1", "actuator": "xl330"}))
    (swing,), models = read_folder(tmp_path)
    assert list(models) == ["m1"]
    assert (swing.name, len(swing.time)) == ("kp400_sin_sin", 800)
    law = np.clip(swing.gain * (swing.goal - swing.angle), -1.0, 1.0)
    np.testing.assert_allclose(swing.duty, law, atol=0.6 / 885)
    assert swing.duty.min() < -0.9 < 0.1 < swing.duty.max()


@pytest.mark.parametrize("goals", [SWING, STEPS], ids=["a swing", "steps"])
def test_the_first_model_is_our_plant(tmp_path: Path, goals: Floats) -> None:
    """On a recording that stays at 0, an error is the mean size of the model's own motion."""
    write(tmp_path, [0.0] * 1000, goals)
    (swing,), _ = read_folder(tmp_path)
    rig = SERVO_RIG.arm()
    motor = {
        "inertia": M1["armature"],
        "resistance": M1["R"],
        "torque_constant": M1["kt"],
        "viscous": M1["friction_viscous"],
        "gear_ratio": 1.0,
    }
    friction = {"coulomb": M1["friction_base"], "breakaway": M1["friction_base"]}
    content = rig.model_dump()
    content["joint"][SERVO_RIG.joint]["motor"] = motor
    content["joint"][SERVO_RIG.joint]["friction"] |= friction
    arm = type(rig).model_validate(content)
    theirs, ours = 1e3 * float(errors(M1, [swing])[0]), closed_loop(arm, 0.0, swing)
    assert theirs > 250.0
    assert ours == pytest.approx(theirs, rel=0.01)
