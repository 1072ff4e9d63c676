"""From searched numbers to plants and back to motors that a data sheet could hold."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm.from_plant import arm_of
from greywhale.arm.plants import column, columns
from greywhale.files.arm import default_arm, load_arm
from greywhale.files.model import to_toml
from greywhale.identify.space import KINDS, MOTOR, WHOLE_ARM, Space
from greywhale.loop import plant_row
from greywhale.protocol.firmware import JOINTS
from tests.support.arms import make_arm

ALL = tuple(KINDS)
BODY = set(range(column("torque_per_volt", 0)))  # what depends on the links alone


@pytest.mark.parametrize(("name", "kinds"), [("white_box", MOTOR), ("worn", ALL)])
def test_motors_friction_and_gears_start_as_the_users_arm(name: str, kinds: tuple[str, ...]) -> None:
    arm = make_arm(name, every_joint={"driver": {"lost_up": 0.4, "lost_down": 0.1}})
    space = Space.of(arm, kinds, range(JOINTS))
    np.testing.assert_allclose(space.plants(space.start()[None])[0], plant_row(arm), rtol=1e-12)


def test_each_number_moves_its_own_joint_only() -> None:
    space = Space.of(default_arm(), ALL, range(JOINTS))
    start = space.start()
    low, high = space.bounds()
    assert np.all((low < start) & (start < high))
    rows = space.plants(start + 0.05 * np.eye(len(space)))
    base = space.plants(start[None])[0]
    for index, parameter in enumerate(space.parameters):
        changed = np.flatnonzero(~np.isclose(rows[index], base, rtol=1e-9, atol=0))
        if parameter.joint == WHOLE_ARM:
            assert set(changed) <= (BODY if parameter.kind == "tip" else {column("supply_resistance")})
            continue
        first = column("torque_per_volt", parameter.joint)
        assert np.all((changed >= first) & (changed <= column("lost_down", parameter.joint)))
        assert bool(len(changed)) is (parameter.kind != "offset")


def test_more_torque_per_volt_alone_leaves_speed_and_friction_per_volt() -> None:
    """Searched are volts: changing alpha must not change what a volt does to a free joint."""
    space = Space.of(default_arm(), (*MOTOR, "coulomb"), (0,))
    start = space.start()
    moved = start.copy()
    moved[space.names.index("joint0.alpha")] += 0.7
    before, after = (space.plants(x[None])[0] for x in (start, moved))
    torque = column("torque_per_volt", 0)
    assert after[torque] == pytest.approx(before[torque] * np.exp(-0.7))
    for name in ("inertia", "damping", "coulomb", "breakaway"):
        here = column(name, 0)
        assert after[here] / after[torque] == pytest.approx(before[here] / before[torque])


def test_a_vector_moves_to_a_larger_space() -> None:
    arm = load_arm("white_box")
    small, large = Space.of(arm, MOTOR, (0, 1)), Space.of(arm, (*MOTOR, "coulomb"), (0, 1))
    x = small.start() + np.arange(6) / 10
    y = large.translate(x, small)
    known = dict(zip(large.names, y, strict=True))
    assert all(known[name] == value for name, value in zip(small.names, x, strict=True))
    assert np.exp(known["joint0.coulomb"]) == pytest.approx(KINDS["coulomb"].start)


@pytest.mark.parametrize("name", ["white_box", "default"])
@pytest.mark.parametrize("damping", [0.3, 4.0])
def test_identified_plants_become_motors(name: str, damping: float) -> None:
    """Also where there is less damping than the user's Kt would brake: then Kt gives way, not the damping."""
    arm = load_arm(name)
    plant = plant_row(arm)
    for joint in range(JOINTS):
        plant[column("damping", joint)] *= damping
        plant[column("torque_per_volt", joint)] *= 1.3
        plant[column("coulomb", joint)] = plant[column("breakaway", joint)] = 0.1
    model = arm_of(arm, plant, np.array([0.0, 0.1, -0.2, 0.0]), "model", "test")
    told = np.isin(np.arange(len(plant)), columns("resistance"), invert=True)
    np.testing.assert_allclose(plant_row(model)[told], plant[told], rtol=1e-12)
    assert model.follower_pots.joint[1].centre == pytest.approx(arm.follower_pots.joint[1].centre + 0.1)
    assert all(joint.motor.viscous > 0.0 for joint in model.joint)


def test_text_keeps_every_value(tmp_path_factory: pytest.TempPathFactory) -> None:
    arm = default_arm().model_copy(update={"name": 'a "quoted" name \\ with é'})
    path = tmp_path_factory.mktemp("model") / "model.toml"
    path.write_text(
        to_toml(arm, {"status": "complete", "log": [{"name": "a", "numbers": [1.0, 2.5]}]}), encoding="utf-8"
    )
    read = load_arm(path)
    assert read.identification == {"status": "complete", "log": [{"name": "a", "numbers": [1.0, 2.5]}]}
    assert read.model_copy(update={"identification": None}) == arm
