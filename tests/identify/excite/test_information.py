"""The information that the search maximises is, to first order, what the identification sees in a log."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greywhale.arm.parameters import with_usual_noise
from greywhale.files.arm import load_arm
from greywhale.files.trajectory import Trajectory
from greywhale.identify.data import prepare
from greywhale.identify.excite.information import information, natural_sizes, prior
from greywhale.identify.excite.limits import limits_of
from greywhale.identify.excite.multisine import Shape
from greywhale.identify.excite.trial import ROW_S, try_motion
from greywhale.identify.space import MOTOR, Space
from greywhale.identify.windows import WindowResidual
from greywhale.loop import human_reaches
from greywhale.protocol.firmware import POINT_S
from greywhale.protocol.table import ParameterTable
from tools.support.recordings import record

SECONDS = 12.0
POSE = np.array([0.0, 0.45, -0.1, 0.0])
ARM = load_arm("white_box")
TABLE = ParameterTable.defaults()
SPACE = Space.of(ARM, (*MOTOR, "coulomb"), range(4))
X = SPACE.start()


def seen_by_the_identification(points: np.ndarray, path: Path) -> np.ndarray:
    """Fisher information of the window residual by finite differences."""
    motion = Trajectory(np.arange(len(points), dtype=np.float64) * POINT_S, points)
    log = record(with_usual_noise(ARM), motion, path, TABLE)
    residual = WindowResidual([prepare(log, 1)], ARM, range(4))
    steps = SPACE.steps
    numbers = residual(SPACE, np.vstack([X[None], X + np.diag(steps), X - np.diag(steps)]))
    count = len(X)
    jacobian = ((numbers[1 : count + 1] - numbers[count + 1 :]) / (2.0 * steps[:, None])).T
    return np.asarray(jacobian.T @ jacobian)


def expected(points: np.ndarray) -> np.ndarray:
    plant = SPACE.plants(X[None])
    tried = try_motion(points, TABLE, plant)
    return information(plant[0], tried.angles[0], ROW_S, SPACE.parameters)


@pytest.fixture(scope="module")
def informations(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """What three motions tell beside what is known before: as the identification sees it, and as is expected."""
    before = np.diag(SPACE.doubts() ** -2.0)
    path = tmp_path_factory.mktemp("logs") / "log.csv"
    return {
        name: (seen_by_the_identification(points, path) + before, expected(points) + before)
        for name, points in motions().items()
    }


def motions() -> dict[str, np.ndarray]:
    shape = Shape(limits_of(ARM, TABLE, POSE, {}), SECONDS)
    random = np.random.default_rng(4)
    return {
        "human": human_reaches(2, SECONDS).at(np.arange(0.0, SECONDS, 0.016)),
        "slow": shape.angles(np.concatenate([np.tile(np.linspace(1, -1, 6), 4), random.uniform(-1, 1, 24)])),
        "quick": shape.angles(np.concatenate([np.tile(np.linspace(0, 1, 6), 4), random.uniform(-1, 1, 24)])),
    }


def test_expected_deviations_are_those_of_the_identification_within_a_factor(
    informations: dict[str, tuple[np.ndarray, np.ndarray]],
) -> None:
    for name, (found, ours) in informations.items():
        ratio = np.sqrt(np.diag(np.linalg.inv(ours)) / np.diag(np.linalg.inv(found)))
        assert 0.5 < np.exp(np.median(np.log(ratio))) < 2.0, name
        assert ratio.min() > 1 / 8, (name, SPACE.names[int(ratio.argmin())])
        assert ratio.max() < 8, (name, SPACE.names[int(ratio.argmax())])


def test_motions_are_ranked_as_the_identification_would(
    informations: dict[str, tuple[np.ndarray, np.ndarray]],
) -> None:
    found, ours = (
        {name: 0.5 * float(np.linalg.slogdet(pair[which])[1]) for name, pair in informations.items()}
        for which in (0, 1)
    )
    assert found["quick"] > max(found["human"], found["slow"]) + 5.0
    for other in ("human", "slow"):
        assert ours["quick"] - ours[other] == pytest.approx(found["quick"] - found[other], rel=0.5)


def test_a_joint_at_rest_tells_nothing_of_its_motor() -> None:
    points = np.tile(POSE, (400, 1))
    points[:, 2] += 0.5 * np.sin(np.arange(400) * 0.05)
    plant = SPACE.plants(X[None])[0]
    matrix = information(plant, points, 0.016, SPACE.parameters)
    size = dict(zip(SPACE.names, np.diag(matrix), strict=True))
    for kind in ("inertia", "damping", "coulomb"):
        assert size[f"joint0.{kind}"] == pytest.approx(0.0, abs=1e-9)
        assert size[f"joint2.{kind}"] > 100.0


def test_zero_angles_show_by_gravity_and_backlash_by_reversals() -> None:
    space = Space.of(ARM, ("offset", "gap"), (1, 3))
    plant = space.plants(space.start()[None])[0]
    points = np.tile(POSE, (800, 1)) + 0.8 * np.sin(np.arange(800) * 0.03)[:, None]
    deviations = np.diag(information(plant, points, 0.016, space.parameters)) ** -0.5
    assert dict(zip(space.names, deviations < 0.01, strict=True)) == {
        "joint1.offset": True,
        "joint1.gap": True,
        "joint3.gap": True,
    }


def test_what_is_known_before_is_a_models_covariance_joint_by_joint() -> None:
    parameters = Space.of(ARM, MOTOR, (0, 1)).parameters
    random = np.random.default_rng(2)
    root = random.normal(size=(6, 6))
    covariance = root @ root.T * 1e-4
    known = prior(parameters, covariance, np.ones(6))
    assert np.allclose(known[:3, :3], np.linalg.inv(covariance[:3, :3]) + np.eye(3), rtol=1e-5)
    assert not known[:3, 3:].any()
    assert np.array_equal(natural_sizes(parameters), np.ones(6))
