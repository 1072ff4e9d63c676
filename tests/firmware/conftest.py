"""The boards that the firmware is built for."""

from __future__ import annotations

import pytest

from tools.support.board_with_image import BOARDS, BoardWithImage


@pytest.fixture(params=BOARDS)
def bench(request: pytest.FixtureRequest) -> BoardWithImage:
    """The real image on a simulated chip, booted, motors off."""
    return BoardWithImage(request.param)
