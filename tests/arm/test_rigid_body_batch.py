"""The links' equations for many states at a time, against those for one, which golden values check."""

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
