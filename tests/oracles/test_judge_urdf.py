"""Inertias that a body can have, by MuJoCo's compiler; weights of odd arms, by Pinocchio's reader of the file."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import numpy as np
import pinocchio
import pytest

from greywhale.arm.export import urdf
from greywhale.arm.from_urdf import import_urdf
from greywhale.arm.judge_urdf import why_no_body
from greywhale.arm.limits import DOUBTS
from greywhale.files.arm import default_arm

COUNT = 400


def mujoco_takes(inertia: np.ndarray) -> bool:
    order = [inertia[place] for place in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    numbers = " ".join(map(repr, map(float, order)))
    body = f'<inertial pos="0 0 0" mass="1" fullinertia="{numbers}"/><joint/>'
    try:
        mujoco.MjModel.from_xml_string(f"<mujoco><worldbody><body>{body}</body></worldbody></mujoco>")
    except ValueError:
        return False
    return True


def margin(inertia: np.ndarray) -> float:
    """The distance from the edge of what a body can have, as a share of its largest moment."""
    moments = np.linalg.eigvalsh(inertia)
    return float(min(abs(moments[0]), abs(moments[0] + moments[1] - moments[2])) / np.abs(moments).max())


def test_it_takes_the_inertias_that_mujoco_takes() -> None:
    random = np.random.default_rng(5)
    judged = []
    for _ in range(COUNT):
        turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
        inertia = turn @ np.diag(random.uniform(-0.2, 1.0, 3)) @ turn.T
        if margin(inertia) > 2.0 * DOUBTS.rounding_share:  # where digits are rounded greywhale takes a little more
            judged.append((why_no_body(inertia) == "", mujoco_takes(inertia)))
    assert all(ours == theirs for ours, theirs in judged)
    assert 50 < sum(ours for ours, _ in judged) < len(judged) - 50, "there are enough of both kinds"


@pytest.mark.parametrize(
    "changes",
    [
        [],
        [('effort=".*?"', 'effort="0"')],
        [('effort=".*?"', 'effort="0"'), ('velocity=".*?"', 'velocity="0"')],
        [('mass value="0.2148"', 'mass value="1.2"')],
        [('xyz="0.14 0.0 0.0"', 'xyz="0.31 0 0"')],
    ],
    ids=["as it is", "no effort", "no motor", "heavy", "long"],
)
def test_the_table_has_the_gravity_that_pinocchio_has(changes: list[tuple[str, str]], tmp_path: Path) -> None:
    text = urdf(default_arm())
    for old, new in changes:
        text, count = re.subn(old, new, text)
        assert count
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    found = import_urdf(path, 12.0).summary
    model = pinocchio.buildModelFromXML(text)
    gravity = pinocchio.computeGeneralizedGravity(model, model.createData(), np.zeros(4))
    assert [one.gravity for one in found.joints] == pytest.approx(np.abs(gravity), abs=1e-9)
    friction = np.array([joint.friction.coulomb for joint in default_arm().joint])
    efforts = np.array([one.stall for one in found.joints]) + friction  # which takes its part
    known = model.effortLimit > 0.0
    assert efforts[known] == pytest.approx(model.effortLimit[known])
    assert (efforts > np.abs(gravity)).all()
