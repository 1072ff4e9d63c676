"""Fits of a search beside each other are those that each would be alone, and all that they simulate is counted."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.base.types import show_no_progress
from greywhale.identify.candidate import Candidate
from greywhale.identify.data import prepare
from greywhale.identify.fits import Fits
from greywhale.identify.space import Space
from greywhale.identify.windows import WindowResidual
from tests.identify.conftest import first
from tools.support.recordings import Recorded


@pytest.mark.slow
def test_models_fitted_beside_each_other_are_those_fitted_alone(shoulder: Recorded, white_box: ArmParameters) -> None:
    space = Space.of(white_box, ("alpha", "inertia", "damping", "coulomb", "gap"), (1,))
    starts = [Candidate(space, space.start(), "").with_values({"gap": gap}) for gap in (0.0, 2e-3, 8e-3)]
    windows = WindowResidual([prepare(first(shoulder.fit, 5.0), 1)], white_box, (1,))
    before = windows(space, starts[1].x[None])
    told: list[float] = []
    together, alone = Fits((1,), lambda _, share: told.append(share)), Fits((1,), show_no_progress)
    together.begin_part("fitting", 0.0, 1.0, 9)
    found = together.settle_each(windows, starts)
    np.testing.assert_array_equal(windows(space, starts[1].x[None]), before)  # the starts of these windows stay
    for one, start in zip(found, starts, strict=True):
        np.testing.assert_array_equal(one.x, alone.settle(windows.copy(), start).x)
    assert len({one.x.tobytes() for one in found}) == len(starts)
    assert together.simulations == alone.simulations
    assert together.simulated == pytest.approx(alone.simulated)
    assert told == pytest.approx([0.0, 1 / 3, 2 / 3, 1.0])
