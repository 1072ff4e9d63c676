"""The boards that the firmware is built for."""

from __future__ import annotations

import pytest

from greywhale_sim.board_with_image import BoardWithImage
from greywhale_sim.wiring import BOARDS


@pytest.fixture(params=BOARDS)
def bench(request: pytest.FixtureRequest) -> BoardWithImage:
    """The real image on a simulated chip, booted, motors off."""
    return BoardWithImage(request.param)
