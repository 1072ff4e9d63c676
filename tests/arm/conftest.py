"""Arms for the tests, and parts of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from greywhale.arm import ArmParameters
from tests.support import arms


@pytest.fixture
def make_arm() -> Callable[..., ArmParameters]:
    return arms.make_arm


@pytest.fixture
def no_friction() -> dict[str, Any]:
    return {"friction": {"coulomb": 0.0, "breakaway": 0.0}}


@pytest.fixture
def rigid() -> dict[str, Any]:
    return {"gear": {"half_gap": 0.0, "stiffness": 0.0, "damping": 0.0, "drag": 0.0}}
