"""The arm's equations for many states or arms at a time, against those for one, which golden values check."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

from greywhale import _native
from greywhale.arm import Arm
from greywhale.arm.body import Body
from greywhale.arm.plants import plant_row
from greywhale.base.types import Floats
from greywhale.files.arm import arm_names, load_arm

BODY = 11
ARMS = ["default", "white_box", "grey_box"]


def states(count: int = 500) -> tuple[Floats, Floats]:
    random = np.random.default_rng(11)
    return random.uniform(-np.pi, np.pi, (count, 4)), random.uniform(-8.0, 8.0, (count, 4))


@pytest.mark.parametrize("arm", ARMS)
def test_gives_the_bits_of_one_state_at_a_time(arm: str) -> None:
    parameters = load_arm(arm)
    one, (q, v) = Arm(parameters).body, states(50)
    body = plant_row(parameters)[:BODY].copy()
    np.testing.assert_array_equal(_native.rigid_body_mass_matrix(body, q), [one.mass_matrix(row) for row in q])
    np.testing.assert_array_equal(
        _native.rigid_body_bias(body, q, v), [one.bias(*rows) for rows in zip(q, v, strict=True)]
    )


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


HERE = Path(__file__).parent
ARM = HERE.parents[1] / "sim" / "arm"


@pytest.mark.slow
def test_vector_of_arms_equals_single_arms(tmp_path: Path) -> None:
    program = tmp_path / "lanes"
    build = ["g++", "-std=gnu++17", "-O1", "-Wall", "-Wextra", "-Werror", "-Wno-psabi", "-ffp-contract=off", f"-I{ARM}"]
    subprocess.run([*build, str(HERE / "lanes.cpp"), "-o", str(program)], check=True)
    result = subprocess.run([str(program)], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout
