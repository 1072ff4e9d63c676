"""The links' equations for many states at a time, against the formulas of docs/arm.md in numpy."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale import _native
from greywhale.arm import Arm
from greywhale.arm.plants import plant_row
from greywhale.base.types import Floats
from greywhale.files.arm import load_arm

BODY = 11
ARMS = ["default", "white_box", "grey_box"]


def states(count: int = 500) -> tuple[Floats, Floats]:
    random = np.random.default_rng(11)
    return random.uniform(-np.pi, np.pi, (count, 4)), random.uniform(-8.0, 8.0, (count, 4))


def body_of(arm: str) -> Floats:
    return plant_row(load_arm(arm))[:BODY].copy()


def mass_matrix_in_numpy(body: Floats, q: Floats) -> Floats:
    yaw, ixx1, iyy1, x, y, e, ixx3, izz1, h, _, _ = body
    q1, q2 = q[:, 1], q[:, 2]
    phi = q1 + q2
    m = np.zeros((len(q), 4, 4))
    m[:, 0, 0] = yaw + ixx1 * np.sin(q1) ** 2 + iyy1 * np.cos(q1) ** 2 + x * np.sin(phi) ** 2 + y * np.cos(phi) ** 2
    m[:, 0, 0] += 2 * h * np.cos(q1) * np.cos(phi)
    m[:, 0, 3] = m[:, 3, 0] = ixx3 * np.sin(phi)
    m[:, 3, 3] = ixx3
    m[:, 1, 1] = izz1 + e + 2 * h * np.cos(q2)
    m[:, 1, 2] = m[:, 2, 1] = e + h * np.cos(q2)
    m[:, 2, 2] = e
    return m


def bias_in_numpy(body: Floats, q: Floats, v: Floats) -> Floats:
    _, ixx1, iyy1, x, y, _, ixx3, _, h, gravity1, gravity2 = body
    q1, q2 = q[:, 1], q[:, 2]
    phi = q1 + q2
    v0, v1, v2, v3 = v.T
    w = v1 + v2
    d1 = (ixx1 - iyy1) * np.sin(2 * q1) + (x - y) * np.sin(2 * phi) - 2 * h * np.sin(q1 + phi)
    d2 = (x - y) * np.sin(2 * phi) - 2 * h * np.cos(q1) * np.sin(phi)
    roll = ixx3 * np.cos(phi)
    weight2 = gravity2 * np.cos(phi)
    return np.column_stack(
        [
            (d1 * v1 + d2 * v2) * v0 + roll * w * v3,
            -d1 / 2 * v0**2 - h * np.sin(q2) * v2 * (2 * v1 + v2) - roll * v0 * v3 + gravity1 * np.cos(q1) + weight2,
            -d2 / 2 * v0**2 + h * np.sin(q2) * v1**2 - roll * v0 * v3 + weight2,
            roll * v0 * w,
        ]
    )


@pytest.mark.parametrize("arm", ARMS)
def test_agrees_with_numpy(arm: str) -> None:
    body, (q, v) = body_of(arm), states()
    mass, bias = _native.rigid_body_mass_matrix(body, q), _native.rigid_body_bias(body, q, v)
    assert mass.shape == (500, 4, 4)
    assert bias.shape == (500, 4)
    np.testing.assert_allclose(mass, mass_matrix_in_numpy(body, q), rtol=0, atol=1e-14)
    np.testing.assert_allclose(bias, bias_in_numpy(body, q, v), rtol=0, atol=1e-14)


@pytest.mark.parametrize("arm", ARMS)
def test_gives_the_bits_of_one_state_at_a_time(arm: str) -> None:
    parameters = load_arm(arm)
    one, (q, v) = Arm(parameters).body, states(50)
    body = plant_row(parameters)[:BODY].copy()
    np.testing.assert_array_equal(_native.rigid_body_mass_matrix(body, q), [one.mass_matrix(row) for row in q])
    np.testing.assert_array_equal(
        _native.rigid_body_bias(body, q, v), [one.bias(*rows) for rows in zip(q, v, strict=True)]
    )


def test_takes_any_layout_and_no_states_at_all() -> None:
    body, (q, v) = body_of("default"), states(8)
    every_other = _native.rigid_body_bias(body, q[::2], v[::2])
    np.testing.assert_array_equal(every_other, _native.rigid_body_bias(body, q, v)[::2])
    assert _native.rigid_body_mass_matrix(body, q[:0]).shape == (0, 4, 4)


def test_wrong_lengths_are_refused() -> None:
    body, (q, v) = body_of("default"), states(8)
    with pytest.raises(ValueError, match="differ in length"):
        _native.rigid_body_bias(body, q, v[:7])
    with pytest.raises(TypeError):
        _native.rigid_body_bias(body[:10], q, v)
