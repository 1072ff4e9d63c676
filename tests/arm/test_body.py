"""The equations for many states at once are those of the arm."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale import _native
from greywhale.arm.body import Body
from greywhale.files.arm import arm_names, load_arm
from greywhale.simulate import plant_row


@pytest.mark.parametrize("name", sorted(arm_names()))
def test_mass_matrix_and_bias_are_the_native_arms(name: str) -> None:
    arm = load_arm(name)
    native, body = _native.Arm(arm.native()).body, Body.of(plant_row(arm))
    random = np.random.default_rng(1)
    q, v, a = random.uniform(-2.5, 2.5, (50, 4)), random.uniform(-6, 6, (50, 4)), random.uniform(-50, 50, (50, 4))
    masses, biases, torques = body.mass_matrix(q), body.bias(q, v), body.torque(q, v, a)
    for row in range(50):
        mass = np.array(native.mass_matrix(list(q[row])))
        bias = np.array(native.bias(list(q[row]), list(v[row])))
        assert np.allclose(masses[row], mass, rtol=1e-12, atol=1e-14)
        assert np.allclose(biases[row], bias, rtol=1e-10, atol=1e-12)
        assert np.allclose(torques[row], mass @ a[row] + bias, rtol=1e-10, atol=1e-12)
