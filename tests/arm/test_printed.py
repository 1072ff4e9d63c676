"""The paper's equations as printed: fully corrected they are ours; each erratum breaks something."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm import Arm, ArmParameters
from greywhale.arm.printed import BODY_ERRATA, ERRATA, PrintedBody, motor_equation
from greywhale.base.errors import UserError
from tests.support.arms import make_arm

KEEP_ENERGY = ("E2", "E8")


@pytest.fixture(scope="module")
def arm() -> ArmParameters:
    return make_arm("white_box", tip={"mass": 0.07})


def states(count: int = 200) -> zip[tuple[np.ndarray, np.ndarray]]:
    random = np.random.default_rng(1)
    return zip(random.uniform(-np.pi, np.pi, (count, 4)), random.uniform(-8, 8, (count, 4)), strict=True)


def test_with_all_corrections_it_is_the_simulated_arm(arm: ArmParameters) -> None:
    ours, corrected = Arm(arm).body, PrintedBody(arm, ERRATA)
    for q, v in states():
        np.testing.assert_allclose(corrected.mass_matrix(q), ours.mass_matrix(q), rtol=0, atol=1e-14)
        np.testing.assert_allclose(corrected.bias(q, v), ours.bias(q, v), rtol=0, atol=1e-12)


@pytest.mark.parametrize("erratum", KEEP_ENERGY)
def test_an_erratum_that_keeps_energy_changes_the_equations_by_itself(arm: ArmParameters, erratum: str) -> None:
    right = PrintedBody(arm, ERRATA)
    wrong = PrintedBody(arm, set(ERRATA) - {erratum})
    change = max(
        np.abs(wrong.mass_matrix(q) - right.mass_matrix(q)).max() + np.abs(wrong.bias(q, v) - right.bias(q, v)).max()
        for q, v in states()
    )
    assert change > 1e-5


@pytest.mark.parametrize("erratum", [name for name in BODY_ERRATA if name not in KEEP_ENERGY])
def test_each_of_six_errata_alone_makes_or_loses_energy(arm: ArmParameters, erratum: str) -> None:
    """Power of the bias torques must equal half the mass matrix's rate of change: v (1/2 dA/dt v - C) = 0."""
    wrong, right = PrintedBody(arm, set(ERRATA) - {erratum}), PrintedBody(arm, ERRATA)

    def power(body: PrintedBody, q: np.ndarray, v: np.ndarray) -> float:
        step = 1e-6
        rate = (body.mass_matrix(q + step * v) - body.mass_matrix(q - step * v)) / (2 * step)
        velocity_torques = body.bias(q, v) - body.bias(q, np.zeros(4))
        return float(v @ (0.5 * rate @ v - velocity_torques))

    assert max(abs(power(right, q, v)) for q, v in states()) < 1e-7
    assert max(abs(power(wrong, q, v)) for q, v in states()) > 1e-3


def test_the_corrected_motor_equation_is_the_paper_actuator(arm: ArmParameters) -> None:
    inertia, push, share, drag = motor_equation([joint.motor for joint in arm.joint], ["E14"])
    for joint in range(4):
        actuator = arm.actuator(joint)
        assert inertia[joint] == pytest.approx(actuator.inertia)
        assert push[joint] == pytest.approx(actuator.torque_per_volt)
        assert drag[joint] == pytest.approx(actuator.damping)
        assert share[joint] == 1.0


def test_an_unknown_erratum_is_refused(arm: ArmParameters) -> None:
    with pytest.raises(UserError, match="erratum E99 is not known; there are E1"):
        PrintedBody(arm, ["E99"])
