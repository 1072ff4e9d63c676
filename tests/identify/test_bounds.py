"""An estimate at a bound of the search is a doubt with a cause and a remedy, where the bound is not simply "none"."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.files.arm import load_arm
from greywhale.identify.bounds import CAUSES, doubt_bounds
from greywhale.identify.default import estimates_of
from greywhale.identify.space import KINDS, Space


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        (
            "joint1.offset",
            0.3,
            "joint 1 (shoulder pitch): offset, the angle at which the potentiometer reads 0, is 0.3",
        ),
        ("joint1.offset", -0.2995, "rad, the least that is searched, as if it was not calibrated"),
        ("joint1.offset", 0.29, ""),
        ("joint1.play", 0.05, "the most that is searched, as if a coupling or a gear has come loose: tighten it"),
        ("joint1.play", 0.0, ""),
        ("arm.sag", 5.0, "the arm: sag"),
        ("joint1.breakaway", 0.5, ""),
    ],
)
def test_only_a_bound_that_hides_something_is_doubted(name: str, value: float, words: str) -> None:
    space = Space.of(load_arm("white_box"), ("offset", "play", "sag", "breakaway"), (1,))
    x = space.start()
    assert doubt_bounds(estimates_of(space, x, None)) == ()
    x[space.names.index(name)] = value
    found = doubt_bounds(estimates_of(space, x, None))
    assert [words in one for one in found] == [True] * bool(words)
    assert all(one.endswith("record and identify again.") for one in found)


def test_a_motor_that_no_arm_file_meant_is_doubted() -> None:
    space = Space.of(load_arm("white_box"), ("alpha",), (2,))
    (low,), _ = space.bounds()
    (found,) = doubt_bounds(estimates_of(space, np.array([low]), None))
    assert "as if the arm file has another motor" in found
    assert set(CAUSES) <= set(KINDS)
