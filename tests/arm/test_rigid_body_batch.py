"""The arm's equations for many states or arms at a time, against those for one, which golden values check."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

from greywhale.arm import Arm
from greywhale.arm.body import Body
from greywhale.arm.plants import plant_row
from greywhale.files.arm import arm_names, load_arm

HERE = Path(__file__).parent
ARM = HERE.parents[1] / "sim" / "arm"


@pytest.mark.parametrize("name", arm_names())
def test_gives_the_bits_of_one_state_at_a_time(name: str) -> None:
    arm, random = load_arm(name), np.random.default_rng(11)
    q, v, a = (size * random.uniform(-1.0, 1.0, (50, 4)) for size in (np.pi, 8.0, 50.0))
    one, many = Arm(arm).body, Body.of(plant_row(arm))
    masses, biases = [one.mass_matrix(row) for row in q], [one.bias(*rows) for rows in zip(q, v, strict=True)]
    np.testing.assert_array_equal(many.mass_matrix(q), masses)
    np.testing.assert_array_equal(many.bias(q, v), biases)
    np.testing.assert_allclose(
        many.torque(q, v, a), np.einsum("nij,nj->ni", masses, a) + biases, rtol=1e-10, atol=1e-12
    )


@pytest.mark.slow
def test_vector_of_arms_equals_single_arms(tmp_path: Path) -> None:
    program = tmp_path / "lanes"
    build = ["g++", "-std=gnu++17", "-O1", "-Wall", "-Wextra", "-Werror", "-Wno-psabi", "-ffp-contract=off", f"-I{ARM}"]
    subprocess.run([*build, str(HERE / "lanes.cpp"), "-o", str(program)], check=True)
    result = subprocess.run([str(program)], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout
